//! Numbers, measures and words of nodes as the document has them.

use d3dgen_model::brief::{AskedCount, Bound, PlaceKind, RelationKind};
use serde::de::DeserializeOwned;

use crate::node::Node;

/// Returns what places are counted.
pub(super) fn places_of(held: &Node) -> Option<PlaceKind> {
    held.values("capacity")
        .chain(held.field("what").into_iter().flat_map(|w| w.values("capacity")))
        .find_map(place_kind)
}

/// Returns the number that a node has, as it binds.
pub(super) fn count(node: &Node) -> Option<AskedCount> {
    let count = node.field("count")?;
    number(count)
}

/// Returns how many rooms are asked for that men and women have their own of: `told` where the prompt says a number.
pub(super) fn by_sex(sex: &Node, told: Option<AskedCount>, count: AskedCount) -> AskedCount {
    let n = told.map_or(1, |c| c.n.max(1));
    match sex.values("sex").next() {
        // "one bathroom for each sex"
        Some("per") => AskedCount { n: 2 * n, ..count },
        // "two toilets for men and women"
        Some("each") => AskedCount { n: n.max(2), ..count },
        _ => count,
    }
}

/// Returns the whole of a number that ends in a half.
pub(super) fn half(node: &Node) -> Option<u32> {
    let count = node.field("count")?;
    let n = count.number.or_else(|| count.field("n").and_then(|n| n.number))?;
    (n.fract() == 0.5 && n < 100.0).then_some(n as u32)
}

/// Returns the number of a plural without one.
pub(super) fn several(node: &Node, fields: &[&str]) -> Option<AskedCount> {
    let noun = fields.iter().find_map(|f| if node.head_last { node.all(f).last() } else { node.field(f) })?;
    noun.plural.then_some(AskedCount::at_least(2))
}

pub(super) fn number(count: &Node) -> Option<AskedCount> {
    if count.is("quantity", Some("several")) || count.field("several").is_some() {
        return Some(AskedCount::at_least(2));
    }
    // "4 Stellplätze für Löschfahrzeuge": the number of the places is that of the vehicles
    if let Some(inner) = count.field("count") {
        return number(inner);
    }
    let n = count.number.or_else(|| count.field("n").and_then(|n| n.number));
    let n = n.or_else(|| count.values("quantity").find_map(|v| v.parse().ok()))?;
    // "ein", "une": an article, or one
    if count.rule.is_none() && n == 1.0 && count.is("particle", Some("article")) {
        return None;
    }
    if !(0.0..=f64::from(u32::MAX)).contains(&n) {
        return None;
    }
    let most = count.field("most").and_then(|m| m.number);
    let (n, bound) = most.map_or((n, bound(count)), |_| (n, Bound::AtLeast));
    Some(AskedCount { n: n.ceil() as u32, bound })
}

pub(super) fn household(node: &Node) -> Option<AskedCount> {
    let who = node.field("who").map_or(node, |w| w);
    who.values("household").find_map(|v| v.parse().ok()).map(AskedCount::exactly)
}

pub(super) fn bound(node: &Node) -> Bound {
    let inner = node.field("count").map(|n| &**n);
    let of = |n: &Node| {
        [("at_least", Bound::AtLeast), ("at_most", Bound::AtMost), ("about", Bound::About)]
            .into_iter()
            .find(|(name, _)| n.field(name).is_some())
            .map(|b| b.1)
    };
    of(node).or_else(|| inner.and_then(of)).unwrap_or(Bound::Exactly)
}

/// Steps that measures are told in, for each m or m2.
const PER_UNIT: f64 = 1e4;

/// Returns a measure in m or m2.
pub(super) fn measure(node: &Node, class: &str) -> Option<f64> {
    if let Some(inner) = node.field(class).filter(|_| node.field("unit").is_none()) {
        return measure(inner, class);
    }
    let n = node.field("n")?;
    let n = n.number.or_else(|| n.field("n").and_then(|n| n.number))?;
    let unit = node.field("unit").and_then(|u| u.values(class).find_map(|v| v.parse::<f64>().ok())).unwrap_or(1.0);
    let value = n * unit;
    let (least, most) = if class == "area" { (0.5, 1e6) } else { (0.05, 500.0) };
    (least..=most).contains(&value).then_some((value * PER_UNIT).round() / PER_UNIT)
}

pub(super) fn sides(node: &Node) -> Option<[f64; 2]> {
    let sides = node.field("sides")?;
    let unit = sides.field("unit").and_then(|u| u.values("length").find_map(|v| v.parse::<f64>().ok())).unwrap_or(1.0);
    let side = |name: &str| {
        let node = sides.field(name)?;
        node.number.map(|n| n * unit).or_else(|| measure(node, "length")).filter(|s| (0.5..=500.0).contains(s))
    };
    Some([side("first")?, side("second")?])
}

pub(super) fn attributes(node: &Node) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for attribute in node.all("attribute") {
        // "a freestanding bathtub" stands like a house
        let value = attribute.values("attribute").chain(attribute.values("site")).next().map(str::to_owned);
        found.extend(value.into_iter().filter(|v| !found.contains(v)).collect::<Vec<_>>());
    }
    found
}

/// Work of robots, and the kind of robot that does it.
const WORK: &[(&str, &str)] = &[
    ("bring", "delivery"),
    ("clean", "cleaning"),
    ("disinfect", "disinfection"),
    ("serve", "service"),
    ("inspect", "inspection"),
    ("feed", "feeding"),
];

pub(super) fn kind_of_work(verb: &str) -> &str {
    WORK.iter().find(|w| w.0 == verb).map_or(verb, |w| w.1)
}

pub(super) fn work_of(kind: &str) -> Option<&'static str> {
    WORK.iter().find(|w| w.1 == kind).map(|w| w.0)
}

pub(super) fn place_kind(value: &str) -> Option<PlaceKind> {
    from_name(match value {
        "seat" => "seats",
        "bed" => "beds",
        "desk" => "desks",
        "car" => "cars",
        "bike" => "bicycles",
        "animal" => "animals",
        "pallet" => "pallets",
        "place" => "treatment",
        other => other,
    })
}

pub(super) fn relation_kind(node: &Node) -> Option<RelationKind> {
    let name = if node.senses.is_empty() { node.text.to_string() } else { node.values("relation").next()?.to_owned() };
    from_name(match name.as_str() {
        "near" | "around" | "together" => "next_to",
        "open" => "open_to",
        "apart" => "away_from",
        "sight" | "seen" => "sees",
        "from_only" | "only_from_there" => "only_from",
        "near_there" => "next_to",
        other => other,
    })
}

/// Returns the value of an enum of the documents by its name there.
fn from_name<T: DeserializeOwned>(name: &str) -> Option<T> {
    serde_json::from_value(serde_json::Value::String(name.to_owned())).ok()
}
