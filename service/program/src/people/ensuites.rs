//! Bathrooms of rooms where nobody lives: guest rooms and patient rooms have their own.

use d3dgen_model::domain::{Access, Domain};

use crate::tokens::words::words;
use crate::wished::wishes::Wishes;

/// Turns "habitaciones con baño" into guest rooms with bathrooms where the word alone means a public toilet, and "patient
/// rooms with a bathroom each" into rooms with en suites where the word alone means one that several share.
pub(crate) fn name_private_bathrooms(wishes: &mut Wishes, domain: &Domain, lives: bool) {
    // of a type that the domain has not it is one of its own too: "chambres avec douche"
    let shared = |id: &String| domain.room_type(id).is_none_or(|t| t.wet && t.access != Access::Host);
    let washes = |id: &String| [&words().dwelling.bathroom, &words().dwelling.shower].contains(&id);
    for pair in wishes.pairs.iter_mut().filter(|p| p.belongs && !lives && washes(&p.a)) {
        let mut own =
            domain.room_types.iter().filter(|t| t.wet && t.access == Access::Host && t.hosts.contains(&pair.b));
        let Some(own) = own.next().filter(|_| shared(&pair.a)) else { continue };
        let named = wishes.wishes.iter().any(|w| w.room_type == own.id);
        match wishes.wishes.iter().position(|w| w.room_type == pair.a) {
            Some(same) if named => {
                wishes.wishes.remove(same);
            }
            Some(wish) => wishes.wishes[wish].room_type.clone_from(&own.id),
            None => {}
        }
        pair.a.clone_from(&own.id);
    }
    let Some(bathroom) = domain.room_type(&words().dwelling.bathroom).filter(|t| t.access == Access::Host) else {
        return;
    };
    let public = |id: &str| domain.room_type(id).is_some_and(|t| t.access != Access::Host && t.zone == bathroom.zone);
    for pair in wishes.pairs.iter_mut().filter(|p| p.belongs && bathroom.hosts.contains(&p.b)) {
        let toilet = words().dwelling.toilets.contains(&pair.a);
        if !(toilet && public(&pair.a)) || wishes.wishes.iter().any(|w| w.room_type == bathroom.id) {
            continue;
        }
        if let Some(wish) = wishes.wishes.iter_mut().find(|w| w.room_type == pair.a) {
            wish.room_type.clone_from(&bathroom.id);
        }
        pair.a.clone_from(&bathroom.id);
    }
}
