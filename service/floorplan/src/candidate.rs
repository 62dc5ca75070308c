//! A finished layout of the search, with its scheme and what it costs.

use d3dgen_model::domain::Scheme;
use d3dgen_model::style::Form;

use super::cost::Score;
use super::outline::Mosaic;
use super::realize::Layout;

/// A finished candidate.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub scheme: Scheme,
    pub layout: Layout,
    pub score: Score,
}

impl Candidate {
    /// Returns true for a building of a form, not only one whose corridors run so: an L has one corner that turns inwards, and
    /// wings lie side by side.
    pub(crate) fn has_form(&self, form: Form) -> bool {
        let slots = &self.layout.comb.slots;
        self.scheme == Scheme::of(form).0
            && match form {
                Form::LShaped => Mosaic::new(&self.layout.boxes).reflex_corners() == 1,
                Form::Wings => [0, 1].iter().any(|side| slots.iter().filter(|s| s.side == *side).count() > 1),
                Form::Linear | Form::Racetrack | Form::Courtyard => true,
            }
    }
}
