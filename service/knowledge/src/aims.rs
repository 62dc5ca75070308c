//! What constraints ask of single objects: figures to choose and place them by.
//!
//! Nothing here is hard. Who furnishes a room takes, of the sizes an object comes in, one that breaks least, and leaves
//! the free floor that is advised where the room has it; what comes of it is judged by `compliance`.

use std::collections::BTreeMap;

use d3dgen_model::domain::{Domain, Mount, ObjectType};

use crate::compliance::reading::SLACK;
use crate::compliance::sizes;
use crate::conditions::Guard;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// Weight of a rule of law against one of advice.
const LAW: u32 = 100;

/// The constraints about objects that can be aimed at.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectAims(Vec<Applicable>);

/// What to aim at with one type of object in one type of room.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Aim {
    /// How much each of the object's sizes breaks, in the order of its type; 0 keeps everything.
    pub breaches: Vec<u32>,
    /// True for what should not be there at all.
    pub unwanted: bool,
    /// Free floor beside it, m.
    pub clear: Clear,
    /// What laws ask of that, m.
    pub by_law: Clear,
}

/// Free floor beside an object, m; 0 where nothing is asked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Clear {
    /// Before its front.
    pub front: f64,
    /// At its sides.
    pub sides: f64,
    /// True when one side of the two is enough.
    pub one_side: bool,
    /// At one side, whichever.
    pub wide_side: f64,
    /// On all sides.
    pub around: f64,
}

impl ObjectAims {
    /// Keeps of the constraints those about extents and free floor of objects.
    pub(crate) fn draw(constraints: &[Applicable]) -> Self {
        let planned = |a: &&Applicable| {
            let open = a.guards.iter().all(Guard::is_planned) && a.unsure.is_none() && a.superseded_by.is_none();
            let aimed = |m: Measure| is_extent(m) || is_floor(m) || m == Measure::NoGlassOrMirrors;
            open && a.decision.as_ref().is_ok_and(|r| aimed(r.quantity.measure))
        };
        Self(constraints.iter().filter(planned).cloned().collect())
    }

    /// Returns what to aim at with the objects of a domain in a room, by id; nothing for those that no constraint is about.
    pub fn in_room<'d>(&self, domain: &'d Domain, room_type: &str, circulation: bool) -> BTreeMap<&'d str, Aim> {
        let here = self.0.iter().filter(|a| in_scope(a, room_type, circulation));
        let here: Vec<(&Applicable, &Rule)> = here.filter_map(|a| Some((a, a.decision.as_ref().ok()?))).collect();
        let aim = |object: &'d ObjectType| {
            let mut own = here.iter().filter(|(a, rule)| concerns(a, rule, object)).peekable();
            own.peek()?;
            Some((object.id.as_str(), Aim::of(object, own.copied())))
        };
        domain.objects.iter().filter_map(aim).collect()
    }
}

impl Aim {
    /// Returns what constraints about an object come to.
    fn of<'c>(object: &ObjectType, constraints: impl Iterator<Item = (&'c Applicable, &'c Rule)>) -> Self {
        let mut aim = Self { breaches: vec![0; object.sizes_m.len()], ..Self::default() };
        for (a, rule) in constraints {
            let measure = rule.quantity.measure;
            if measure == Measure::NoGlassOrMirrors {
                aim.unwanted = true;
            } else if is_extent(measure) {
                for (breach, size) in aim.breaches.iter_mut().zip(&object.sizes_m) {
                    let off = extents(object, *size).and_then(|e| sizes::of_extents(e, a, rule));
                    let weight = if a.mandatory { LAW } else { 1 };
                    *breach += off.filter(|v| breaks(*v, rule)).map_or(0, |_| weight);
                }
            } else if let Some(least) = rule.bounds.min {
                let width = object.sizes_m.iter().map(|s| s[0]).reduce(f64::min).unwrap_or(0.0);
                let least = if measure == Measure::CentreToSide { (least - width / 2.0).max(0.0) } else { least };
                let one_side = a.is_one_sided();
                aim.clear.raise(measure, least, one_side);
                if a.mandatory {
                    aim.by_law.raise(measure, least, one_side);
                }
            }
        }
        aim
    }
}

impl Clear {
    fn raise(&mut self, measure: Measure, least: f64, one_side: bool) {
        let up = |v: &mut f64| *v = v.max(least);
        match measure {
            Measure::ObjectFront | Measure::FreeHalfCircle => up(&mut self.front),
            Measure::ObjectSides | Measure::CentreToSide => {
                self.one_side = one_side && (self.one_side || self.sides == 0.0);
                up(&mut self.sides);
            }
            Measure::ObjectThreeSides => {
                self.one_side = false;
                up(&mut self.front);
                up(&mut self.sides);
            }
            _ => up(&mut self.around),
        }
    }
}

fn is_extent(measure: Measure) -> bool {
    use Measure as M;
    matches!(measure, M::ObjectWidth | M::ObjectDepth | M::ObjectHeight | M::ObjectSize | M::ObjectExtents)
}

fn is_floor(measure: Measure) -> bool {
    use Measure as M;
    matches!(measure, M::ObjectFront | M::ObjectSides | M::ObjectThreeSides | M::ObjectAround | M::ObjectToWall)
        || matches!(measure, M::CentreToSide | M::FreeHalfCircle)
}

/// Tag of what robots that see with light mistake for an opening.
const MIRROR: &str = "mirror";

/// Returns true for what robots that see with light mistake for an opening.
pub(crate) fn is_mirror(kind: &ObjectType) -> bool {
    kind.tags.iter().any(|t| t == MIRROR)
}

fn in_scope(a: &Applicable, room_type: &str, circulation: bool) -> bool {
    match &a.scope {
        Scope::Rooms(types) => types.contains(room_type),
        Scope::Circulation => circulation,
        Scope::Objects(_) => true,
        Scope::Building | Scope::Doors | Scope::Entrance => false,
    }
}

fn concerns(a: &Applicable, rule: &Rule, object: &ObjectType) -> bool {
    match &a.scope {
        _ if rule.quantity.measure == Measure::NoGlassOrMirrors => is_mirror(object),
        Scope::Objects(shapes) if !rule.quantity.names_objects() => shapes.contains(&object.shape),
        _ => rule.quantity.picks(object),
    }
}

/// Returns width, depth and top of an object of a size, m; `None` where its height depends on what carries it.
fn extents(object: &ObjectType, [width, depth, height]: [f64; 3]) -> Option<[f64; 3]> {
    let below = match object.mount {
        Mount::Floor => 0.0,
        Mount::Wall => object.mount_height_m?,
        Mount::Ceiling | Mount::Surface => return None,
    };
    Some([width, depth, below + height])
}

fn breaks(value: f64, rule: &Rule) -> bool {
    rule.bounds.min.is_some_and(|m| value < m - SLACK) || rule.bounds.max.is_some_and(|m| value > m + SLACK)
}
