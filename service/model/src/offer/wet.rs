//! Toilets and bathrooms of a domain.

use std::collections::BTreeSet;

use super::has_shape;
use crate::domain::{Domain, RoomType, Shape, Zone};

/// Ids of a domain's room types with a toilet, and of those that one can bathe in too.
#[derive(Debug, Default)]
pub struct Wet {
    toilets: BTreeSet<String>,
    bathrooms: BTreeSet<String>,
}

impl Wet {
    /// Finds them by what the rooms are furnished with.
    pub fn of(domain: &Domain) -> Self {
        let mut wet = Self::default();
        for kind in domain.room_types.iter().chain(domain.lent.room_types()).filter(|k| k.zone != Zone::Night) {
            if has_shape(domain, kind, &[Shape::Toilet, Shape::Cubicle]) {
                wet.toilets.insert(kind.id.clone());
                if has_shape(domain, kind, &[Shape::Shower, Shape::Bathtub]) {
                    wet.bathrooms.insert(kind.id.clone());
                }
            }
        }
        wet
    }

    /// Returns true for rooms to go to the toilet in.
    pub fn has_toilet(&self, kind: &RoomType) -> bool {
        self.toilets.contains(&kind.id)
    }

    /// Returns true for rooms with a toilet and a shower or bathtub.
    pub fn is_bathroom(&self, kind: &RoomType) -> bool {
        self.bathrooms.contains(&kind.id)
    }
}
