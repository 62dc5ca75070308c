//! Drafts of a room: the best choice for each unit in turn, or another one for one of the first (limited discrepancy
//! search).

use d3dgen_model::domain::{Mount, Shape};

use super::geom::Box2;
use super::neighbors::{AT_SOFA, beside_sofas};
use super::search::Outcome;
use super::state::{Placed, State};
use super::unit::Part;

/// What a draft loses for each dock with something on its free floor, beyond what the place of the dock loses, and how far
/// into that floor something reaches that only touches it, mm.
const DOCK_TAKEN: f64 = 8.0;
const GRAZE: i32 = 10;
/// What a draft loses without the circle that wheelchairs are to turn on.
const NO_CIRCLE: f64 = 6.0;

/// Departures tried in turn, one at a time.
pub(crate) const DEPARTURES: [Departure; 3] = [Departure::of(0, 1), Departure::of(1, 1), Departure::of(0, 2)];
/// Further departures while something required has no place.
pub(crate) const RESCUES: [Departure; 8] = [
    Departure::of(2, 1),
    Departure::of(1, 2),
    Departure::of(0, 3),
    Departure::of(2, 2),
    Departure::of(3, 1),
    Departure::of(0, 4),
    Departure::of(1, 3),
    Departure::of(3, 2),
];
/// Departures where a bed in the middle of its wall leaves none for a wardrobe as wide as they are.
pub(crate) const ASIDE: [Departure; 2] = [Departure::aside(1), Departure::aside(-1)];
/// Departures where a sofa in the middle of its wall, or in the room, leaves no floor for the table.
pub(crate) const AT_WALL: [Departure; 6] = [
    Departure::at_wall(0, 1),
    Departure::at_wall(0, -1),
    Departure::at_wall(1, 1),
    Departure::at_wall(1, -1),
    Departure::at_wall(0, 0),
    Departure::at_wall(1, 0),
];
/// The last step at which one of them departs.
pub(crate) const DEEPEST: usize = 3;

/// Where a draft leaves the best choices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Departure {
    /// The unit counted so, 0 the first, takes another choice.
    pub step: usize,
    /// Which one: 0 is the best.
    pub rank: usize,
    /// Toward which end of its wall it stands rather than in the middle: the lower, -1, or the higher, 1.
    pub aside: i8,
    /// True to leave a sofa at its wall, however far what it looks at is.
    pub at_wall: bool,
}

impl Departure {
    const fn of(step: usize, rank: usize) -> Self {
        Self { step, rank, aside: 0, at_wall: false }
    }

    const fn aside(aside: i8) -> Self {
        Self { step: 0, rank: 0, aside, at_wall: false }
    }

    const fn at_wall(rank: usize, aside: i8) -> Self {
        Self { step: 0, rank, aside, at_wall: true }
    }
}

/// A room half furnished: the state and what is missing so far.
#[derive(Clone)]
pub(crate) struct Draft<'a, 's> {
    pub state: State<'a, 's>,
    pub outcome: Outcome<'a>,
    /// How many units there were before each choice so far.
    pub steps: Vec<usize>,
}

impl<'a> Draft<'a, '_> {
    /// Returns what the choice at a step put there.
    pub fn chosen(&self, step: usize) -> Option<&[Placed<'a>]> {
        let start = *self.steps.get(step)?;
        let end = self.steps.get(step + 1).copied().unwrap_or(self.state.placed.len());
        Some(&self.state.placed[start..end])
    }

    /// Returns how good the draft is, lower is better: what is missing, then looks and free floor.
    pub fn cost(&self, empty: usize) -> (u32, f64) {
        let free = 3.0 * self.state.free_area as f64 / empty.max(1) as f64;
        let taken =
            DOCK_TAKEN * f64::from(self.docks_taken()) + if self.state.lacks_circle() { NO_CIRCLE } else { 0.0 };
        (self.outcome.required_missing, taken - self.outcome.score - free)
    }

    /// Returns true where people eat right beside a sofa.
    pub fn eats_at_sofa(&self) -> bool {
        self.state.placed.iter().any(|p| beside_sofas(&self.state, p) >= AT_SOFA)
    }

    /// Returns how many docks of robots have something on their free floor.
    pub fn docks_taken(&self) -> u32 {
        let state = &self.state;
        let stands = |p: &Placed, part: &Part, floor: &Box2| {
            let solid = p.solid(part);
            let own = part.object.shape == Shape::Dock || part.mount != Mount::Floor || solid.is_flat();
            !own && solid.rect.overlaps(&floor.grown(-GRAZE))
        };
        let taken = |floor: &&Box2| state.placed.iter().any(|p| p.unit.parts.iter().any(|part| stands(p, part, floor)));
        if state.has_robots { state.docks.iter().filter(taken).count() as u32 } else { 0 }
    }
}

/// What drafts chose where they departed, to tell a departure that has no other choice left.
#[derive(Default)]
pub(crate) struct Seen<'a>(Vec<(usize, Vec<Placed<'a>>)>);

impl<'a> Seen<'a> {
    /// Takes down what a draft chose: at its departure, or everywhere where it has none.
    pub fn note(&mut self, draft: &Draft<'a, '_>, departure: Option<Departure>) {
        let steps = departure.map_or(0..draft.steps.len(), |d| d.step..d.step + 1);
        let chosen = steps.filter_map(|step| Some((step, draft.chosen(step)?.to_vec())));
        self.0.extend(chosen);
    }

    /// Returns true when a draft chose the same at this step; all before and after it follows from that.
    pub fn has(&self, step: usize, chosen: &[Placed]) -> bool {
        self.0.iter().any(|(s, units)| {
            *s == step && units.len() == chosen.len() && units.iter().zip(chosen).all(|(a, b)| a.is_as(b))
        })
    }
}
