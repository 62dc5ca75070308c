//! What kinds of object and room mean to the measures, from `data/kinds.toml`: sides of use, window coverings, privacy.

use std::sync::OnceLock;

use d3dgen_model::domain::Mount;
use d3dgen_model::placements::Placement;
use serde::Deserialize;

use crate::Error;

/// A side of an object in its own frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Own +x.
    Front,
    /// Own -x.
    Back,
    /// Own +y.
    Left,
    /// Own -y.
    Right,
}

/// The whole list.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kinds {
    sides: Vec<Sides>,
    default_front: DefaultFront,
    windows: Windows,
    rooms: Rooms,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sides {
    words: Vec<String>,
    sides: Vec<Side>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DefaultFront {
    min_height_m: f64,
    min_footprint_m2: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Windows {
    coverings: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rooms {
    private: Vec<String>,
    may_lie_behind: Vec<String>,
}

impl Kinds {
    /// Returns the list that comes with this crate.
    pub fn builtin() -> &'static Self {
        static KINDS: OnceLock<Kinds> = OnceLock::new();
        KINDS.get_or_init(|| Self::parse(include_str!("../data/kinds.toml")).expect("a test reads the file"))
    }

    /// Reads a list.
    ///
    /// # Errors
    /// `Data` with what is wrong.
    pub fn parse(text: &str) -> Result<Self, Error> {
        toml::from_str(text).map_err(|e| Error::Data { file: "kinds.toml", reason: e.to_string() })
    }

    /// Returns the sides from which an object is used; none for small things and for what does not stand on the floor.
    pub fn sides(&self, p: &Placement) -> Vec<Side> {
        if p.mount != Mount::Floor {
            return Vec::new();
        }
        if let Some(listed) = self.sides.iter().find(|s| has_part(&p.object, &s.words)) {
            return listed.sides.clone();
        }
        let d = &self.default_front;
        let large = p.size_m[2] >= d.min_height_m && p.size_m[0] * p.size_m[1] >= d.min_footprint_m2;
        if large { vec![Side::Front] } else { Vec::new() }
    }

    /// Returns true for curtains and blinds.
    pub fn covers_windows(&self, object: &str) -> bool {
        has_part(object, &self.windows.coverings)
    }

    /// Returns true for rooms that nobody should have to walk through.
    pub fn is_private(&self, room_type: &str) -> bool {
        has_part(room_type, &self.rooms.private)
    }

    /// Returns true for rooms that may be reached through a private one.
    pub fn may_lie_behind(&self, room_type: &str) -> bool {
        has_part(room_type, &self.rooms.may_lie_behind)
    }
}

/// Returns true when a part of a snake-case id is one of the words.
fn has_part(id: &str, words: &[String]) -> bool {
    id.split('_').any(|part| words.iter().any(|w| w == part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn sides_follow_the_list_then_the_size() {
        let kinds = Kinds::builtin();
        let sides = |object: &str, size| kinds.sides(&sample::thing(object, (1.0, 1.0), size));
        assert_eq!(sides("hospital_bed", [1.0, 2.0, 0.8]), [Side::Front, Side::Left, Side::Right]);
        assert_eq!(sides("office_chair", [0.5, 0.5, 0.9]).len(), 4);
        assert_eq!(sides("wardrobe", [1.0, 0.6, 2.0]), [Side::Front]);
        assert_eq!(sides("bedside_locker", [0.3, 0.3, 0.6]), [], "small");
        assert_eq!(sides("rug", [2.0, 2.0, 0.01]), []);
        assert!(kinds.is_private("master_bedroom") && !kinds.is_private("living_room"));
        assert!(kinds.covers_windows("long_curtain") && !kinds.covers_windows("wardrobe"));
    }

    #[test]
    fn a_broken_list_is_named() {
        let error = Kinds::parse("sides = 3").unwrap_err().to_string();
        assert!(error.starts_with("service/eval/data/kinds.toml: "), "{error}");
    }
}
