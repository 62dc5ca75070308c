//! Storeys that are named by others: the top one, every one, and the one on which a flat lies in its house.

use d3dgen_model::brief::{AskedBuilding, Fact, SiteAsk, SiteKind};

use crate::facts::{Stated, Storey};
use crate::subjects::facts_data;

/// Puts each fact on the storey that its words name, now that all facts are known.
pub(crate) fn settled(facts: Vec<Stated>, building: Option<&AskedBuilding>) -> Vec<Stated> {
    if is_one_storey_of_many(&facts, building) {
        return on_its_storey(facts);
    }
    let top = highest(&facts);
    facts.into_iter().flat_map(|stated| on_storeys(stated, top)).collect()
}

/// Returns the highest storey that the facts tell of.
fn highest(facts: &[Stated]) -> i32 {
    let counted =
        facts.iter().filter_map(|f| if let Fact::Storeys(s) = &f.fact { Some(s.count.n as i32 - 1) } else { None });
    let named = facts.iter().filter_map(|f| if let Some(Storey::At(level)) = f.storey { Some(level) } else { None });
    let above = facts.iter().any(|f| f.storey == Some(Storey::Top));
    counted.chain(named).max().unwrap_or(0).max(i32::from(above))
}

/// Returns a fact once for each storey that it is said of.
fn on_storeys(stated: Stated, top: i32) -> Vec<Stated> {
    let at = |level: i32| {
        let mut stated = stated.clone();
        if let Fact::Rooms(rooms) = &mut stated.fact {
            rooms.level = Some(level);
        }
        stated
    };
    match (&stated.fact, stated.storey) {
        (Fact::Rooms(_), Some(Storey::Top)) => vec![at(top)],
        (Fact::Rooms(_), Some(Storey::Each)) if top > 0 => (0..=top).map(at).collect(),
        _ => vec![stated],
    }
}

/// Returns true for a home within one storey of which one storey is told, and no number of storeys: that is where it lies.
fn is_one_storey_of_many(facts: &[Stated], building: Option<&AskedBuilding>) -> bool {
    let kind = building.and_then(|b| b.building_type.as_deref());
    let within = kind.is_some_and(|k| facts_data().within_a_storey.iter().any(|w| w == k));
    let several = facts.iter().any(|f| f.storey.is_none() && matches!(&f.fact, Fact::Storeys(s) if s.count.n > 1));
    let mut named = facts.iter().filter_map(|f| f.storey);
    let first = named.next();
    let below = first.is_some_and(|s| matches!(s, Storey::At(level) if level < 0) || s == Storey::Each);
    within && !several && !below && first.is_some() && named.all(|s| Some(s) == first)
}

/// Takes the storey from all rooms, and states it of the site.
fn on_its_storey(facts: Vec<Stated>) -> Vec<Stated> {
    let mut out: Vec<Stated> = Vec::with_capacity(facts.len());
    for mut stated in facts {
        if stated.storey.take().is_some() {
            let alone = matches!(stated.fact, Fact::Other(_) | Fact::Storeys(_));
            let words = stated.also.take().unwrap_or(stated.tokens.clone());
            if !out.iter().any(|o| matches!(o.fact, Fact::Site(_)) && o.tokens == words) {
                let site = Fact::Site(SiteAsk { kind: SiteKind::Inside });
                out.push(Stated {
                    tokens: words,
                    also: None,
                    storey: None,
                    fact: site,
                    mention: false,
                    own: false,
                    counted: false,
                });
            }
            if alone {
                continue;
            }
        }
        if let Fact::Rooms(rooms) = &mut stated.fact {
            rooms.level = None;
        }
        out.push(stated);
    }
    out
}
