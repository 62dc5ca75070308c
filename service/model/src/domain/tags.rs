//! What rooms are, in words that roles of people use: from what their types say, and from the tags that they are given.

use std::collections::BTreeSet;

use super::{Domain, Goods, Privacy, RobotUse, RoomType, Shape, Zone};
use crate::offer;

/// Corridors, halls and stairs: what joins the others.
pub const WAY: &str = "way";
/// Where anybody may be.
pub const PUBLIC: &str = "public";
/// For those who work there.
pub const STAFF: &str = "staff";
/// Stores, technical rooms and kitchens: no business of those who do not work there.
pub const SERVICE: &str = "service";
/// Soils what comes after: waste, used linen, cleaners' rooms.
pub const DIRTY: &str = "dirty";
/// Clean goods: medicine, linen, sterile supplies.
pub const CLEAN: &str = "clean";
/// Closed to all but those whose work it is: operating rooms, laboratories with protection, server rooms.
pub const RESTRICTED: &str = "restricted";
/// Toilets and washrooms.
pub const WASH: &str = "wash";
/// Where people lie who are cared for.
pub const CARE: &str = "care";
/// Where people sleep.
pub const SLEEP: &str = "sleep";
/// Where people who wait or rest sit.
pub const SEATS: &str = "seats";
/// Where somebody serves at a counter.
pub const COUNTER: &str = "counter";
/// Where people work at desks.
pub const DESKS: &str = "desks";
/// There for nothing but to be passed on the way to the room behind it.
pub const LOCK: &str = "lock";

/// Tags that are only ever given: `tags = ["eat"]` of a room type.
///
/// `treatment`: examined and treated. `operating`: operated on. `imaging`: pictures are taken. `station`: from where a ward is
/// looked after. `medicine`: medicine is made ready. `wait`: people wait. `reception`: who comes reports there. `eat`: meals are
/// eaten. `cook`: meals are made. `meet`: people meet. `teach`: people are taught. `lead`: from where work is led. `sell`: things
/// are bought. `pay`: things are paid for. `travel`: travellers go through. `stay`: guests have a room. `show`: things are shown
/// and performed. `pray`: people pray. `exercise`: people move their bodies. `change`: people change clothes. `rest`: those who
/// work there have their break. `guard`: from where a building is watched. `goods`: goods come, go and are kept. `make`: things
/// are made and repaired. `study`: people read and learn by themselves. `play`: children play. `live`: a household spends its
/// days. `vehicle`: vehicles stand. `research`: things are examined scientifically. `lock`: it is there for nothing but to be passed
/// on the way to the room behind it.
pub const GIVEN: [&str; 30] = [
    "treatment",
    "operating",
    "imaging",
    "station",
    "medicine",
    "wait",
    "reception",
    "eat",
    "cook",
    "meet",
    "teach",
    "lead",
    "sell",
    "pay",
    "travel",
    "stay",
    "show",
    "pray",
    "exercise",
    "change",
    "rest",
    "guard",
    "goods",
    "make",
    "study",
    "play",
    "live",
    "vehicle",
    "research",
    LOCK,
];

const DERIVED: [&str; 13] =
    [WAY, PUBLIC, STAFF, SERVICE, DIRTY, CLEAN, RESTRICTED, WASH, CARE, SLEEP, SEATS, COUNTER, DESKS];

/// Returns true for a tag that rooms have or may be given.
pub fn is_known(tag: &str) -> bool {
    DERIVED.contains(&tag) || GIVEN.contains(&tag)
}

impl Domain {
    /// Returns what rooms of a type are: the tags it is given and those that follow from its zone, its goods, who may pass, and
    /// what it is furnished with.
    pub fn tags_of<'a>(&'a self, kind: &'a RoomType) -> BTreeSet<&'a str> {
        let has = |shapes: &[Shape]| offer::has_shape(self, kind, shapes);
        let way = kind.zone == Zone::Circulation || self.is_way(&kind.id);
        let wash = has(&[Shape::Toilet, Shape::Cubicle, Shape::Shower, Shape::Bathtub]);
        let closed = kind.robot.contains(&RobotUse::KeepOut) && kind.zone != Zone::Circulation && !wash;
        let given = |tag: &str| kind.tags.iter().any(|t| t == tag);
        let asleep = kind.zone == Zone::Night;
        let derived = [
            (WAY, way),
            (PUBLIC, kind.zone == Zone::Public && !closed || way && kind.privacy == Privacy::Public),
            (STAFF, kind.zone == Zone::Staff),
            (SERVICE, kind.zone == Zone::Service && !wash && !given(PUBLIC)),
            (WASH, wash),
            (DIRTY, kind.goods == Goods::Soiled && !wash),
            (CLEAN, kind.goods == Goods::Clean),
            (RESTRICTED, closed || given("operating")),
            (CARE, asleep && has(&[Shape::HospitalBed])),
            (SLEEP, asleep && has(&[Shape::HospitalBed, Shape::Bed])),
            (SEATS, has(&[Shape::Chair, Shape::Bench, Shape::Sofa, Shape::Stool])),
            (COUNTER, has(&[Shape::Counter])),
            (DESKS, has(&[Shape::Desk])),
        ];
        let derived = derived.into_iter().filter(|(_, holds)| *holds).map(|(tag, _)| tag);
        derived.chain(kind.tags.iter().map(String::as_str)).collect()
    }
}
