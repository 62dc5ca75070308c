//! A group or a single object as one rigid unit around its anchor, in the anchor's frame: x forward, y left, origin
//! at the middle of the anchor's back edge.

use std::collections::BTreeMap;

use d3dgen_knowledge::clearance::PROJECTION_M;
use d3dgen_knowledge::{Aim, Clear};
use d3dgen_model::TOLERANCE_M;
use d3dgen_model::domain::{Domain, FacingRule, Group, Member, Mount, ObjectType, Relation, Shape};
use d3dgen_model::measures::sleepers_in;

use super::geom::{Box2, ROBOT_HEIGHT, Solid, mm};
use super::seats::{is_seat, seats_around, seats_behind};

/// Floor at one side of a bed that somebody gets into from a wheelchair, m (ISO 21542, ADA 806.2.3: 36 in).
pub(crate) const BESIDE_BED_M: f64 = 0.92;
/// Largest number of members kept around one anchor, whatever a domain says.
const MAX_MEMBERS: u32 = 40;

/// One object of a unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part<'a> {
    pub object: &'a ObjectType,
    /// Quarter turns of its front against the anchor's.
    pub quarter: u8,
    pub solid: Solid,
    /// As placed: a thing on another one is a surface mount whatever its type says.
    pub mount: Mount,
    /// The part it stands on.
    pub support: Option<usize>,
    /// True for what the group can do without.
    pub optional: bool,
}

impl Part<'_> {
    /// Returns the stretches of its top that a bowl or rings take, in the unit's frame.
    pub fn taken(&self) -> impl Iterator<Item = Box2> + '_ {
        let own = self.solid.rect.turned((4 - self.quarter) % 4);
        let at = move |share: f64| own.y0 + (f64::from(own.height()) * share).round() as i32;
        let stretches = self.object.top_taken.iter();
        stretches.map(move |[from, to]| Box2 { y0: at(*from), y1: at(*to), ..own }.turned(self.quarter))
    }

    /// Returns true for what hangs on another wall than the one behind its unit: the rail at the side of a toilet.
    pub fn hangs_aside(&self) -> bool {
        self.mount == Mount::Wall && self.support.is_none() && !self.quarter.is_multiple_of(4)
    }

    /// Returns true for the leg of a kitchen that turns the corner: its back belongs to the wall beside that of its unit.
    pub fn stands_aside(&self) -> bool {
        let built_in = matches!(self.object.shape, Shape::Sink | Shape::Counter | Shape::Stove);
        built_in && self.mount == Mount::Floor && !self.quarter.is_multiple_of(2)
    }

    /// Returns true for what its unit can do without where it is in the way: on a top, overhead, flat on the floor or on a
    /// wall.
    pub fn may_go(&self) -> bool {
        let hangs = self.mount == Mount::Wall && self.support.is_none();
        let loose = matches!(self.mount, Mount::Surface | Mount::Ceiling) || self.solid.is_flat() || hangs;
        self.optional && loose
    }

    /// Returns true for what hangs flat on a wall, which narrows no passage.
    pub fn is_shallow(&self) -> bool {
        let r = self.solid.rect;
        let depth = if self.quarter.is_multiple_of(2) { r.width() } else { r.height() };
        self.mount == Mount::Wall && depth <= mm(PROJECTION_M)
    }
}

/// Objects placed as one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit<'a> {
    /// Group or object id.
    pub item: &'a str,
    /// True when it is a group of the domain.
    pub group: bool,
    /// The anchor first.
    pub parts: Vec<Part<'a>>,
    /// Floor to keep free of other things.
    pub clears: Vec<Box2>,
    /// Around everything that is not flat and not on the ceiling.
    pub bbox: Box2,
    /// Around `bbox` and `clears`.
    pub reach: Box2,
    /// Around all parts, whatever they are.
    pub extent: Box2,
    /// True when a part hangs on the wall behind, so the unit cannot stand free.
    pub needs_wall: bool,
    /// Floor that robots take while they charge at its docks.
    pub parked: Vec<Box2>,
}

/// Which size each object has in this room: index into `sizes_m` by object id.
pub(crate) type Sizes<'a> = dyn Fn(&ObjectType) -> usize + 'a;

/// What units of a room have in common.
#[derive(Clone, Copy)]
pub(crate) struct Forms<'s> {
    /// Size of each object type.
    pub sizes: &'s Sizes<'s>,
    /// What rules ask of the object types, by id.
    pub aims: &'s BTreeMap<&'s str, Aim>,
    /// Scale of the clearances; 1 is as the domain says.
    pub tightness: f64,
    /// True to begin with forms that have the free floor that is advised.
    pub advised: bool,
    /// True for what the room can do without: it comes with the free floor of the laws or not at all.
    pub lawful: bool,
    /// Things that hang stay below it, mm.
    pub ceiling: i32,
    /// Diameter of the robots that charge, mm; 0 where none is asked after.
    pub robot: i32,
}

impl Forms<'static> {
    /// The first size of everything, under no rules.
    pub fn plain(ceiling: i32) -> Self {
        static NONE: BTreeMap<&str, Aim> = BTreeMap::new();
        Self { sizes: &|_| 0, aims: &NONE, tightness: 1.0, advised: false, lawful: false, ceiling, robot: 0 }
    }
}

impl<'a> Unit<'a> {
    pub fn anchor(&self) -> &Part<'a> {
        &self.parts[0]
    }

    /// Returns the unit mirrored left to right, or `None` when that changes nothing.
    pub fn mirrored(&self) -> Option<Self> {
        let mut out = self.clone();
        let fixed = !self.anchor().object.top_taken.is_empty();
        // a sink is not made mirrored, so what stands on it stays beside its bowl
        for part in out.parts.iter_mut().filter(|p| !(fixed && p.support == Some(0))) {
            part.solid.rect = part.solid.rect.mirrored();
            part.quarter = (4 - part.quarter) % 4;
        }
        out.clears.iter_mut().chain(&mut out.parked).for_each(|c| *c = c.mirrored());
        out.bbox = out.bbox.mirrored();
        out.reach = out.reach.mirrored();
        out.extent = extent_of(&out.parts);
        let key = |u: &Self| {
            let mut parts: Vec<(Box2, i32)> = u.parts.iter().map(|p| (p.solid.rect, p.solid.z0)).collect();
            let mut clears = u.clears.clone();
            parts.sort_unstable();
            clears.sort_unstable();
            (parts, clears)
        };
        (key(&out) != key(self)).then_some(out)
    }

    /// Returns the unit without what hangs on the wall behind it.
    pub fn free_standing(self) -> Self {
        if !self.needs_wall || self.anchor().mount == Mount::Wall {
            return self;
        }
        let parts = self.parts.into_iter().filter(|p| p.mount != Mount::Wall).collect();
        finish_with(self.item, self.group, parts, self.clears, self.parked)
    }

    /// Returns where its users look, in quarter turns against the anchor's front: pupils at their tables look over the
    /// table, someone on a sofa looks ahead with it.
    pub fn look(&self) -> u8 {
        if !matches!(self.anchor().object.shape, Shape::Desk | Shape::Table) {
            return 0;
        }
        // whoever works there turns on a chair; those across the desk visit
        let works = |p: &&Part| p.object.shape == Shape::SwivelChair;
        let at_work = self.parts.iter().any(|p| works(&p));
        let seats = self.parts.iter().filter(|p| if at_work { works(p) } else { is_seat(p.object.shape) });
        let mut seats = seats.map(|p| p.quarter);
        let Some(first) = seats.next() else { return 0 };
        if seats.all(|q| q == first) { first } else { 0 }
    }

    /// Returns a rectangle of the unit in the frame in which its users look along x.
    pub fn as_looking(&self, local: &Box2) -> Box2 {
        local.turned((4 - self.look()) % 4)
    }

    /// Returns the unit without the optional things on its top, over it, on the wall beside it and flat on the floor that are
    /// in the way; `None` when none is.
    pub fn cleared(&self, in_the_way: impl Fn(&Part) -> bool) -> Option<Self> {
        let gone = |p: &Part| p.may_go() && in_the_way(p);
        if !self.parts.iter().any(gone) {
            return None;
        }
        let parts: Vec<Part> = self.parts.iter().filter(|p| !gone(p)).cloned().collect();
        Some(finish_with(self.item, self.group, parts, self.clears.clone(), self.parked.clone()))
    }

    /// Returns how many people can lie on the unit's beds: two on a wide one, two in a bunk bed.
    pub fn beds(&self) -> u32 {
        let bed = |p: &&Part| matches!(p.object.shape, Shape::Bed | Shape::HospitalBed);
        self.parts.iter().filter(bed).map(|p| sleepers_in(size_of(p))).sum()
    }

    /// Returns how many desks the unit has.
    pub fn desks(&self) -> u32 {
        self.parts.iter().filter(|p| p.object.shape == Shape::Desk).count() as u32
    }

    /// Returns how many people work or learn at the unit's desks: two at a table for two.
    pub fn work_places(&self) -> u32 {
        let works = self.parts.iter().any(|p| p.object.shape == Shape::SwivelChair);
        match self.desks() {
            0 => 0,
            desks if works => desks,
            desks => self.seats().max(desks),
        }
    }

    /// Returns how many people sit on the unit's chairs and benches at their ease.
    pub fn places(&self) -> u32 {
        let seats = self.parts.iter().filter(|p| is_seat(p.object.shape));
        seats.map(|p| if p.object.shape == Shape::Bench { (width_of(p) as u32 / 550).max(1) } else { 1 }).sum()
    }

    /// Returns the unit with so many seats at most.
    pub fn with_seats(self, most: u32) -> Self {
        if self.seats() <= most {
            return self;
        }
        let mut seen = 0;
        let stays = |p: &Part| {
            seen += u32::from(is_seat(p.object.shape));
            !is_seat(p.object.shape) || seen <= most
        };
        let mut parts = self.parts;
        parts.retain(stays);
        finish_with(self.item, self.group, parts, self.clears, self.parked)
    }

    /// Returns how many people can sit on the unit's chairs.
    pub fn seats(&self) -> u32 {
        self.parts.iter().filter(|p| is_seat(p.object.shape)).map(|p| (width_of(p) as u32 / 450).max(1)).sum()
    }
}

fn width_of(part: &Part) -> i32 {
    if part.quarter.is_multiple_of(2) { part.solid.rect.height() } else { part.solid.rect.width() }
}

/// Returns width, depth and height of a part, m.
fn size_of(part: &Part) -> [f64; 3] {
    let turned = part.quarter.is_multiple_of(2);
    let depth = if turned { part.solid.rect.width() } else { part.solid.rect.height() };
    [width_of(part), depth, part.solid.z1 - part.solid.z0].map(|mm| f64::from(mm) / 1000.0)
}

/// Returns the forms of a unit to try in turn: the picked sizes first, then the other sizes, those that keep most rules
/// and are largest first, then with fewer members on the floor, last of all the smallest with required members only.
/// Before a size that keeps fewer rules than the picked one, members that one can do without go.
///
/// Where advice asks for more free floor than the domain, whole forms with that come before all others that keep as many rules.
pub(crate) fn variants<'a>(domain: &'a Domain, item: &'a str, forms: &Forms) -> Vec<Unit<'a>> {
    let group = domain.group(item);
    let Some(anchor) = domain.anchor(item) else {
        return Vec::new();
    };
    let plan = Plan { domain, item, group, anchor, forms };
    let sizes = forms.sizes;
    let picked = sizes(anchor);
    let mut order: Vec<usize> = (0..anchor.sizes_m.len()).filter(|i| *i != picked).collect();
    let area = |i: usize| anchor.sizes_m[i][0] * anchor.sizes_m[i][1];
    let breach = |i: usize| forms.aims.get(anchor.id.as_str()).and_then(|a| a.breaches.get(i)).copied().unwrap_or(0);
    order.sort_by(|a, b| breach(*a).cmp(&breach(*b)).then(area(*b).total_cmp(&area(*a))));
    let smallest = order.iter().copied().chain([picked]).min_by(|a, b| area(*a).total_cmp(&area(*b))).unwrap_or(picked);
    let mut out: Vec<Unit> = Vec::new();
    let mut add = |unit: Unit<'a>| {
        if !out.contains(&unit) {
            out.push(unit);
        }
    };
    let members = group.map_or(&[][..], |g| &g.members);
    let optional = members.iter().filter(|m| !m.required && takes_floor(domain, m)).count();
    let (lawful, lesser): (Vec<usize>, Vec<usize>) =
        [picked].into_iter().chain(order).partition(|size| breach(*size) <= breach(picked));
    let full = |size: usize| plan.build(size, sizes, usize::MAX);
    let fewer = (0..optional).rev().filter(|_| !lesser.is_empty());
    let fewer: Vec<Unit> = fewer.map(|keep| plan.build(picked, sizes, keep)).collect();
    let whole: Vec<Unit> = lawful.into_iter().map(full).chain(fewer).collect();
    for whole in [whole, lesser.into_iter().map(full).collect()] {
        if forms.advised {
            // the room for a wheelchair to turn at one side goes before that to get there, and this before the rest
            for wide in [f64::MAX, BESIDE_BED_M, 0.0] {
                whole.iter().filter_map(|unit| advised(unit, forms, wide)).for_each(&mut add);
            }
        }
        whole.iter().filter_map(with_elbow_room).for_each(&mut add);
        whole.into_iter().for_each(&mut add);
    }
    if group.is_some() {
        let smallest_size = |o: &ObjectType| {
            let area = |i: &usize| o.sizes_m[*i][0] * o.sizes_m[*i][1];
            (0..o.sizes_m.len()).min_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(0)
        };
        for keep in (0..optional).rev() {
            add(plan.build(picked, sizes, keep));
            add(plan.build(smallest, &smallest_size, keep));
        }
        add(plan.build(smallest, &smallest_size, 0));
        add(plan.build_bare(smallest, &smallest_size));
    }
    out
}

/// Returns a unit with the free floor that is advised for its parts, at a wide side up to so much; `None` where that is no more
/// than it has.
fn advised<'a>(unit: &Unit<'a>, forms: &Forms, wide_m: f64) -> Option<Unit<'a>> {
    let mut clears = unit.clears.clone();
    let clear = |aim: &Aim| Clear { wide_side: aim.clear.wide_side.min(wide_m), ..aim.clear };
    asked_floor(&unit.parts, forms, clear, &mut clears);
    let more = clears.len() > unit.clears.len();
    more.then(|| finish_with(unit.item, unit.group, unit.parts.clone(), clears, unit.parked.clone()))
}

/// Returns a unit with room for the elbows of who uses it; `None` where its parts need none.
fn with_elbow_room<'a>(unit: &Unit<'a>) -> Option<Unit<'a>> {
    let mut clears = unit.clears.clone();
    for part in unit.parts.iter().filter(|p| p.object.elbow_room_m > 0.0) {
        let (own, room) = (part.solid.rect.turned((4 - part.quarter) % 4), mm(part.object.elbow_room_m));
        clears.push(Box2 { y0: own.y0 - room, y1: own.y1 + room, ..own }.turned(part.quarter));
    }
    let more = clears.len() > unit.clears.len();
    more.then(|| finish_with(unit.item, unit.group, unit.parts.clone(), clears, unit.parked.clone()))
}

/// Adds the free floor that rules ask for beside the parts that stand on it.
fn asked_floor(parts: &[Part], forms: &Forms, clear: impl Fn(&Aim) -> Clear, out: &mut Vec<Box2>) {
    for part in parts.iter().filter(|p| p.mount == Mount::Floor) {
        if let Some(aim) = forms.aims.get(part.object.id.as_str()) {
            advised_floor(part, &clear(aim), out);
        }
    }
}

/// Adds the free floor that is advised for a part where it is more than its type asks for.
fn advised_floor(part: &Part, clear: &Clear, out: &mut Vec<Box2>) {
    let own = part.solid.rect.turned((4 - part.quarter) % 4);
    let usual = [part.object.clearance_front_m, part.object.clearance_side_m];
    let mut add = |depth: f64, has: f64, b: fn(Box2, i32) -> Box2| {
        if depth > has + TOLERANCE_M {
            out.push(b(own, mm(depth)).turned(part.quarter));
        }
    };
    let side = |sides: u8| if part.object.clear_sides >= sides { usual[1] } else { 0.0 };
    let (front, left) = (clear.front.max(clear.around), clear.sides.max(clear.around).max(clear.wide_side));
    let right = if clear.one_side { clear.around } else { clear.sides.max(clear.around) };
    add(front, usual[0], |o, d| Box2 { x0: o.x1, x1: o.x1 + d, ..o });
    add(left, side(1), |o, d| Box2 { y0: o.y1, y1: o.y1 + d, ..o });
    add(right, side(2), |o, d| Box2 { y0: o.y0 - d, y1: o.y0, ..o });
    add(clear.around, 0.0, |o, d| Box2 { x0: o.x0 - d, x1: o.x0, ..o });
}

fn takes_floor(domain: &Domain, member: &Member) -> bool {
    let on_floor = domain.object(&member.object).is_some_and(|o| o.mount == Mount::Floor);
    on_floor && !matches!(member.relation, Relation::On | Relation::Above | Relation::Over | Relation::Under)
}

/// What all forms of a unit share.
struct Plan<'a, 'f> {
    domain: &'a Domain,
    item: &'a str,
    group: Option<&'a Group>,
    anchor: &'a ObjectType,
    forms: &'f Forms<'f>,
}

impl<'a> Plan<'a, '_> {
    /// Builds the unit with one size of the anchor and the first so many optional members on the floor.
    fn build(&self, size: usize, sizes: &Sizes, keep_optional: usize) -> Unit<'a> {
        let mut kept = 0;
        self.build_with(size, sizes, |member| {
            let counts = !member.required && takes_floor(self.domain, member);
            kept += usize::from(counts);
            !counts || kept <= keep_optional
        })
    }

    /// Builds the unit with required members only.
    fn build_bare(&self, size: usize, sizes: &Sizes) -> Unit<'a> {
        self.build_with(size, sizes, |member| member.required)
    }

    fn build_with(&self, size: usize, sizes: &Sizes, mut keep: impl FnMut(&Member) -> bool) -> Unit<'a> {
        let [w, d, h] = size_mm(self.anchor, size);
        let z = hung(self.anchor, h, self.forms.ceiling);
        let rect = Box2 { x0: 0, y0: -(w / 2), x1: d, y1: w - w / 2 };
        let solid = Solid { rect, z0: z, z1: z + h };
        let mount = if self.anchor.mount == Mount::Surface { Mount::Floor } else { self.anchor.mount };
        let mut parts = vec![Part { object: self.anchor, quarter: 0, solid, mount, support: None, optional: false }];
        let aims = self.forms.aims;
        let by_law_m = aims.get(self.anchor.id.as_str()).map_or(0.0, |a| a.by_law.front);
        for member in self.group.map_or(&[][..], |g| &g.members).iter().filter(|m| keep(m)) {
            let unwanted = || aims.get(member.object.as_str()).is_some_and(|a| a.unwanted);
            if let Some(object) = self.domain.object(&member.object)
                && (member.required || !unwanted())
            {
                // a chair is pulled away, a table stays
                let stays =
                    member.relation == Relation::Front && !is_seat(object.shape) && takes_floor(self.domain, member);
                let gap_m = if stays { member.gap_m.max(by_law_m) } else { member.gap_m };
                add_member(&mut parts, (member, gap_m), object, sizes(object), self.forms.ceiling);
            }
        }
        let mut clears = Vec::new();
        let shared = mm(self.group.map_or(0.0, |g| g.clearance_front_m) * self.forms.tightness);
        clears.extend((shared > 0).then(|| Box2 { x0: rect.x1, x1: rect.x1 + shared, ..rect }));
        let behind = mm(self.group.map_or(0.0, |g| g.clearance_back_m) * self.forms.tightness);
        clears.extend((behind > 0).then(|| Box2 { x0: rect.x0 - behind, x1: rect.x0, ..rect }));
        finish(self.item, self.group.is_some(), parts, clears, self.forms)
    }
}

fn size_mm(object: &ObjectType, size: usize) -> [i32; 3] {
    object.sizes_m.get(size).or(object.sizes_m.first()).map_or([500; 3], |s| s.map(|v| mm(v).max(1)))
}

/// Returns the height of the underside of something `h` high: on a wall where its type hangs it, below the ceiling;
/// from the ceiling, whatever the height of that.
fn hung(object: &ObjectType, h: i32, ceiling: i32) -> i32 {
    match object.mount {
        Mount::Floor | Mount::Surface => 0,
        Mount::Wall => mm(object.mount_height_m.unwrap_or(1.5)).min(ceiling - h).max(0),
        Mount::Ceiling => (ceiling - h).max(0),
    }
}

/// Finishes a unit that needs this floor beside what its parts need.
fn finish<'a>(item: &'a str, group: bool, parts: Vec<Part<'a>>, mut clears: Vec<Box2>, forms: &Forms) -> Unit<'a> {
    parts.iter().for_each(|part| clears_of(part, forms.tightness, &mut clears));
    seats_behind(&parts, forms.tightness, &mut clears);
    seats_around(&parts, forms.tightness, &mut clears);
    if forms.lawful {
        asked_floor(&parts, forms, |aim| aim.by_law, &mut clears);
    }
    let docks = parts.iter().filter(|p| p.object.shape == Shape::Dock && forms.robot > 0);
    let parked: Vec<Box2> = docks.map(|dock| parked_at(dock, forms.robot)).collect();
    clears.extend(&parked);
    // a strip of free floor that lies under the unit's own anchor says nothing
    clears.retain(|c| !parts.iter().any(|p| p.solid.stops_robot() && p.solid.rect.contains(c)));
    finish_with(item, group, parts, clears, parked)
}

/// Returns the floor that a robot of this diameter takes at a dock, mm.
fn parked_at(dock: &Part, robot: i32) -> Box2 {
    let own = dock.solid.rect.turned((4 - dock.quarter) % 4);
    let middle = (own.y0 + own.y1) / 2;
    Box2 { x0: own.x1, x1: own.x1 + robot, y0: middle - robot / 2, y1: middle + robot - robot / 2 }.turned(dock.quarter)
}

fn finish_with<'a>(item: &'a str, group: bool, parts: Vec<Part<'a>>, clears: Vec<Box2>, parked: Vec<Box2>) -> Unit<'a> {
    let mut bbox = parts[0].solid.rect;
    for part in &parts {
        if part.mount != Mount::Ceiling && part.mount != Mount::Surface && !part.solid.is_flat() {
            bbox = bbox.union(&part.solid.rect);
        }
    }
    let reach = clears.iter().fold(bbox, |r, c| r.union(c));
    let back = bbox.x0;
    let needs_wall = parts.iter().any(|p| p.mount == Mount::Wall && p.solid.rect.x0 <= back + 5);
    let extent = extent_of(&parts);
    Unit { item, group, parts, clears, bbox, reach, extent, needs_wall, parked }
}

/// Returns the rectangle around all parts, of which there is at least one.
fn extent_of(parts: &[Part]) -> Box2 {
    parts.iter().fold(parts[0].solid.rect, |all, part| all.union(&part.solid.rect))
}

/// Adds the floor in front of and beside a part that must stay free.
pub(crate) fn clears_of(part: &Part, tightness: f64, out: &mut Vec<Box2>) {
    if part.mount == Mount::Surface || part.mount == Mount::Ceiling || part.solid.z0 > ROBOT_HEIGHT + 400 {
        return;
    }
    let front = mm(part.object.clearance_front_m * tightness);
    let side = mm(part.object.clearance_side_m * tightness);
    // in the part's own frame, then turned to the unit's
    let own = part.solid.rect.turned((4 - part.quarter) % 4);
    let mut add = |b: Box2| out.push(b.turned(part.quarter));
    // one stands on a level shower's tray, so nothing else does
    if part.object.shape == Shape::Shower && part.solid.is_flat() {
        add(own);
    }
    // one works on all sides of an island, so nothing stands in the way later either
    let around = mm(part.object.free_around_m);
    if around > 0 {
        add(own.grown(around));
    }
    if front > 0 {
        add(Box2 { x0: own.x1, x1: own.x1 + front, ..own });
    }
    if side > 0 && part.object.clear_sides > 0 {
        add(Box2 { y0: own.y1, y1: own.y1 + side, ..own });
        if part.object.clear_sides > 1 {
            add(Box2 { y0: own.y0 - side, y1: own.y0, ..own });
        }
    }
}

/// Adds a member of a group so far from the anchor.
fn add_member<'a>(
    parts: &mut Vec<Part<'a>>,
    (member, gap_m): (&Member, f64),
    object: &'a ObjectType,
    size: usize,
    ceiling: i32,
) {
    let [w, d, h] = size_mm(object, size);
    let count = member.count.clamp(1, MAX_MEMBERS);
    let anchor = parts[0].solid;
    let a = anchor.rect;
    let (gap, offset) = (mm(gap_m), mm(member.offset_m));
    let facing = |toward: u8| match member.facing {
        FacingRule::Same => 0,
        FacingRule::Toward => toward,
        FacingRule::Opposite => 2,
    };
    // extents along the unit's x and y after turning
    let extent = |q: u8| if q.is_multiple_of(2) { (d, w) } else { (w, d) };
    let at = |cx0: i32, cy0: i32, q: u8| {
        let (ex, ey) = extent(q);
        Box2 { x0: cx0, y0: cy0, x1: cx0 + ex, y1: cy0 + ey }
    };
    // boxes of two things may touch, never overlap: tucking a chair under its table means touching it
    let base = hung(object, h, ceiling);
    let beside = !matches!(member.relation, Relation::On | Relation::Over | Relation::Under);
    let gap = if beside && base < anchor.z1 && gap < 0 { 0 } else { gap };
    let floor = |rect: Box2| Solid { rect, z0: base, z1: base + h };
    let apart = gap.max(0);
    let part = |quarter: u8, solid: Solid| Part {
        object,
        quarter,
        solid,
        mount: object.mount,
        support: None,
        optional: !member.required,
    };
    match member.relation {
        Relation::Left | Relation::Right => {
            let left = member.relation == Relation::Left;
            let q = facing(if left { 3 } else { 1 });
            let (_, ey) = extent(q);
            for _ in 0..count {
                let y = if left { a.y1 + gap } else { a.y0 - gap - ey };
                let step = if left { (0, 20) } else { (0, -20) };
                if let Some(solid) = pushed(parts, floor(at(a.x0 + offset, y, q)), step, apart) {
                    parts.push(part(q, solid));
                }
            }
        }
        Relation::Front | Relation::Back => {
            let front = member.relation == Relation::Front;
            let q = facing(if front { 2 } else { 0 });
            let (ex, ey) = extent(q);
            let x = if front { a.x1 + gap } else { a.x0 - gap - ex };
            let pitch = (a.height() / count as i32).max(ey + 50);
            for k in 0..count as i32 {
                let y = offset - ey / 2 + (2 * k - (count as i32 - 1)) * pitch / 2;
                let step = if front { (20, 0) } else { (-20, 0) };
                if let Some(solid) = pushed(parts, floor(at(x, y, q)), step, apart) {
                    parts.push(part(q, solid));
                }
            }
        }
        Relation::Around => {
            for (rect, q) in around(a, w, d, gap, count) {
                parts.push(part(q, floor(rect)));
            }
        }
        Relation::On => {
            let q = facing(0);
            let (ex, ey) = extent(q);
            for _ in 0..count {
                let x = (a.x0 + a.x1 - ex) / 2 + gap;
                let y = (a.y0 + a.y1 - ey) / 2 + offset;
                if let Some(rect) = on_top(parts, at(x, y, q)) {
                    let solid = Solid { rect, z0: anchor.z1, z1: anchor.z1 + h };
                    parts.push(Part { mount: Mount::Surface, support: Some(0), ..part(q, solid) });
                }
            }
        }
        Relation::Above => {
            // against the wall behind the unit, which stands at the back of everything so far
            let back = parts.iter().filter(|p| p.mount != Mount::Ceiling).map(|p| p.solid.rect.x0).min().unwrap_or(0);
            let z = if base < anchor.z1 && anchor.z1 + 50 + h <= ceiling { anchor.z1 + 50 } else { base };
            if z < anchor.z1 && !member.required {
                return; // the anchor reaches up to where it would hang
            }
            let rect = Box2 { x0: back, y0: offset - w / 2, x1: back + d, y1: offset - w / 2 + w };
            let solid = Solid { rect, z0: z, z1: z + h };
            if let Some(solid) = pushed(parts, solid, (0, 20), 0) {
                parts.push(Part { mount: Mount::Wall, ..part(0, solid) });
            }
        }
        Relation::Over | Relation::Under => {
            let q = facing(0);
            let (ex, ey) = extent(q);
            // centered, but not through the wall behind the anchor
            let x = ((a.x0 + a.x1 - ex) / 2 + gap).max(a.x0);
            let rect = at(x, (a.y0 + a.y1 - ey) / 2 + offset, q);
            let z = if member.relation == Relation::Over { base } else { 0 };
            let solid = Solid { rect, z0: z, z1: z + h };
            parts.push(part(q, solid));
        }
    }
}

/// Moves a solid in steps until it overlaps no part and leaves a gap to those it passed, mm; `None` after 3 m.
fn pushed(parts: &[Part], solid: Solid, step: (i32, i32), gap: i32) -> Option<Solid> {
    let with_gap = |s: &Solid| {
        let (dx, dy) = (gap * step.0.signum(), gap * step.1.signum());
        Solid { rect: s.rect.union(&s.rect.shifted(-dx, -dy)), ..*s }
    };
    let free = |s: &Solid| s.is_flat() || !parts.iter().any(|p| !p.solid.is_flat() && p.solid.overlaps(&with_gap(s)));
    (0..150).map(|k| Solid { rect: solid.rect.shifted(k * step.0, k * step.1), ..solid }).find(free)
}

/// Returns the place on the anchor's top nearest to the wished one: inside its outline, beside what stands there.
fn on_top(parts: &[Part], wish: Box2) -> Option<Box2> {
    let top = parts[0].solid.rect;
    if wish.width() > top.width() || wish.height() > top.height() {
        return None;
    }
    let into = |b: Box2| {
        let dx = (top.x0 - b.x0).max(0) - (b.x1 - top.x1).max(0);
        let dy = (top.y0 - b.y0).max(0) - (b.y1 - top.y1).max(0);
        b.shifted(dx, dy)
    };
    let taken = |b: &Box2| {
        parts.iter().any(|p| p.mount == Mount::Surface && p.solid.rect.overlaps(b))
            || parts[0].taken().any(|t| t.overlaps(b))
    };
    (0..80)
        .map(|k: i32| if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 })
        .map(|k| into(wish.shifted(0, k * 50)))
        .chain((-10..10).map(|k| into(wish.shifted(k * 50, 0))))
        .find(|b| !taken(b))
}

/// Returns `count` seats of `w` x `d` around a table, each facing it: long sides first, then the ends.
fn around(table: Box2, w: i32, d: i32, gap: i32, count: u32) -> Vec<(Box2, u8)> {
    const ELBOW: i32 = 80;
    let fits = |length: i32| ((length + ELBOW) / (w + ELBOW)).max(1);
    let (x_sides, y_sides) = (fits(table.height()), fits(table.width()));
    let long_first = table.height() >= table.width();
    let (long, short) = if long_first { (x_sides, y_sides) } else { (y_sides, x_sides) };
    let count = count as i32;
    let on_long = count.min(2 * long);
    let on_short = (count - on_long).min(2 * short);
    let halves = [on_long - on_long / 2, on_long / 2, on_short - on_short / 2, on_short / 2];
    let sides: [u8; 4] = if long_first { [0, 2, 1, 3] } else { [1, 3, 0, 2] };
    let mut out = Vec::new();
    for (n, side) in halves.into_iter().zip(sides) {
        let length = if side.is_multiple_of(2) { table.height() } else { table.width() };
        let (cx, cy) = table.center();
        for k in 0..n {
            let along = (2 * k + 1 - n) * (length / n.max(1)).max(w + 10) / 2;
            let rect = match side {
                0 => Box2 {
                    x0: table.x1 + gap,
                    y0: cy + along - w / 2,
                    x1: table.x1 + gap + d,
                    y1: cy + along - w / 2 + w,
                },
                2 => Box2 {
                    x0: table.x0 - gap - d,
                    y0: cy + along - w / 2,
                    x1: table.x0 - gap,
                    y1: cy + along - w / 2 + w,
                },
                1 => Box2 {
                    x0: cx + along - w / 2,
                    y0: table.y1 + gap,
                    x1: cx + along - w / 2 + w,
                    y1: table.y1 + gap + d,
                },
                _ => Box2 {
                    x0: cx + along - w / 2,
                    y0: table.y0 - gap - d,
                    x1: cx + along - w / 2 + w,
                    y1: table.y0 - gap,
                },
            };
            out.push((rect, (side + 2) % 4));
        }
    }
    out
}
