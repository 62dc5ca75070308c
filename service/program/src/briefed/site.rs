//! How a building stands among others.

use d3dgen_model::brief::{Brief, Fact, SiteKind};
use d3dgen_model::domain::{Attached, BuildingType, Domain};

/// Returns the kind of building with the same rooms that stands wall to wall with others, where the brief asks for that and its kind
/// stands free.
pub(super) fn in_a_row(brief: &Brief, domain: &Domain, building_type: Option<&str>) -> Option<String> {
    let row = |fact: &Fact| matches!(fact, Fact::Site(site) if site.kind == SiteKind::Terraced);
    if !brief.asks.iter().any(|ask| row(&ask.fact)) {
        return None;
    }
    let own = domain.building_type(building_type?)?;
    let same = |b: &&BuildingType| b.attached == Some(Attached::Row) && b.program == own.program;
    domain.building_types.iter().filter(|_| own.attached.is_none()).find(same).map(|b| b.id.clone())
}
