//! Many equal units at once: parallel rows with aisles, and lamps spread over a ceiling.

use std::rc::Rc;

use d3dgen_model::domain::{Arrangement, Shape};

use super::{Rule, Tally};
use crate::demand::Task;
use crate::geom::{Box2, turn};
use crate::space::{DoorZone, Space, WallSide};
use crate::state::{Placed, State, at_frame};
use crate::style::grain;
use crate::unit::Unit;

/// Least width of an aisle people use, mm.
const AISLE: i32 = 900;
/// Floor by which two who sit back to back let a third pass, mm.
const PASSAGE: i32 = 250;
/// What rows lose for each door in the wall that they look at, and for each beside it.
const IN_STAGE_WALL: f64 = 1.6;
const BESIDE_STAGE: f64 = 1.6;
/// Least floor between the desks of those who sit back to back, mm.
const BACK_TO_BACK: i32 = 1800;
/// Floor of the two behind them that those who sit back to back may share, mm.
const SHARED_MOST: i32 = 200;
/// Floor before things from which on it is a lane that those on its other side use too, mm.
const SHARED_LANE: i32 = 1800;
/// Free floor between tables in a row where there is room, mm.
const TABLES_APART: i32 = 500;
/// Steps away from a place on the ceiling that is taken, mm.
const BESIDE: [(i32, i32); 9] =
    [(0, 0), (500, 0), (-500, 0), (0, 500), (0, -500), (900, 0), (-900, 0), (0, 900), (0, -900)];
/// The same along the axes of a room whose middle is taken, mm.
const OFF_STEP: i32 = 250;
/// Floor between doors and what senses smoke below the ceiling, mm (IRC R314.3: 3 ft), and the steps that it is moved by.
const FROM_DOOR: i32 = 930;
const ALONG: i32 = 250;
/// Width below which something on the ceiling is a device and no lamp, mm.
const DEVICE: i32 = 200;
/// Most that aisles between rows of desks widen where the room has the floor, mm.
const WIDENED: i32 = 700;
/// Distances of a curtain from the foot of its bed, mm.
const FOOT_GAPS: [i32; 4] = [300, 450, 150, 50];
/// What rows of desks lose whose users share all of the floor behind them.
const SHARED: f64 = 3.0;
/// What rows of desks lose all of whose windows are before or behind the screens.
const GLARE: f64 = 2.5;
/// What they lose all of whose screens mirror one, how near to the axis of its desk that begins and how far away it lies, mm.
const MIRRORS: f64 = 3.0;
const MIRRORED: (i32, i32) = (500, 3800);
/// What rows lose past neither end of which people get as through an aisle.
const NARROW_ENDS: f64 = 1.0;
/// What rows of desks lose all of which have open floor behind their screens, before and after places are looked at.
const OPEN_BACKS: f64 = 4.0;
const SINGLE: f64 = 6.0;
/// What counters lose for each row behind the first.
const IN_LINE: f64 = 6.0;
/// How much of that an island of two lines loses, with those who serve between them.
const ISLAND: f64 = 0.2;
/// What counters lose behind which all doors of the room are: who is served comes in before them.
const BEHIND_COUNTERS: f64 = 6.0;
/// What a line of counters gains with no more than an aisle behind those who serve there, and which of the distances to the
/// wall that is.
const BACKED: f64 = 3.0;
const AISLE_BEHIND: usize = 3;
/// What desks lose for each meter to the windows.
const FROM_LIGHT: f64 = 0.4;
/// Floor behind a desk over which it stands against a wall all the same, mm.
const AT_WALL: i32 = 350;
/// Row plans whose every position is tested.
const PLANS: usize = 20;
/// Arrangements handed to the search.
const KEPT: usize = 6;

/// Units in rows, with how good the whole is.
pub(crate) struct Batch<'a> {
    pub placed: Vec<Placed<'a>>,
    /// True for desks that are to stand face to face, or against a wall.
    pub in_pairs: bool,
    pub score: f64,
}

/// How rows are drawn up, in the frame of a unit turned by `q`.
#[derive(Debug, Clone, Copy)]
struct Plan {
    q: u8,
    columns: i32,
    rows: i32,
    /// Units it is for.
    count: i32,
    /// Units side by side before a cross aisle.
    run: i32,
    /// From one unit's edge to the next in a row, mm.
    gap_v: i32,
    /// From one row's front to the next row's back, mm.
    gap_u: i32,
    /// Every second row turned around, back to back.
    paired: bool,
    /// From the back of a row to that of the one turned around behind it, mm: 0 where they touch.
    gap_back: i32,
    score: f64,
}

impl Plan {
    fn breadth(&self, w: i32, aisle: i32) -> i32 {
        let aisles = (self.columns - 1) / self.run;
        self.columns * w + (self.columns - 1 - aisles) * self.gap_v + aisles * aisle
    }

    fn depth(&self, d: i32) -> i32 {
        let (gaps, backs) = if self.paired { ((self.rows - 1) / 2, self.rows / 2) } else { (self.rows - 1, 0) };
        self.rows * d + gaps * self.gap_u + backs * self.gap_back
    }

    /// Returns the floor to keep before and after the rows, mm: to use them, and for what they look at.
    fn margins(&self, unit: &Unit, front: i32, stage: i32) -> (i32, i32) {
        // the last of an odd number of rows has its back to the wall
        if self.paired && self.rows % 2 == 1 {
            return (front, 0);
        }
        let back = if self.paired { front } else { 0 };
        match unit.look() {
            0 => (back, front.max(stage)),
            2 => (back.max(stage), front),
            _ => (back, front),
        }
    }

    /// Returns what rows lose whose users share the floor behind them, where they could have this much, mm.
    fn shared(&self, own: i32) -> f64 {
        if self.rows < 3 || own == 0 { 0.0 } else { SHARED * f64::from((own - self.gap_u).max(0)) / f64::from(own) }
    }

    /// Returns the share of rows with nobody across and no wall behind.
    fn open_backs(&self) -> f64 {
        let alone = if self.paired { self.rows % 2 } else { self.rows - 1 };
        f64::from(alone) / f64::from(self.rows.max(1))
    }

    /// Returns the low edge of a column, counted from the first.
    fn column(&self, c: i32, w: i32, aisle: i32) -> i32 {
        let aisles = c / self.run;
        c * w + (c - aisles) * self.gap_v + aisles * aisle
    }

    /// Returns the low edge of a row, counted from the first, and whether it is turned around.
    fn row(&self, r: i32, d: i32) -> (i32, bool) {
        if !self.paired {
            return (r * (d + self.gap_u), false);
        }
        (r * d + r.div_euclid(2) * self.gap_u + (r + 1).div_euclid(2) * self.gap_back, r % 2 == 0)
    }
}

/// What rows have to do with the rest of the room.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Terms {
    pub salt: u64,
    /// Narrowest aisle, mm.
    pub robot: i32,
    /// Keeps seats from standing back to back, for something will face them.
    pub one_way: bool,
    /// Floor before the rows for whatever faces them, mm.
    pub stage: i32,
}

/// Returns ways to set up a task's units in rows, best first; each position holds, routes not looked at.
pub(crate) fn rows<'a>(
    state: &State<'a, '_>,
    task: &Task,
    index: usize,
    unit: &Rc<Unit<'a>>,
    terms: &Terms,
    tally: &mut Tally,
) -> Vec<Batch<'a>> {
    let aisle = terms.robot.max(AISLE);
    let focus = state.placed.iter().find(|p| p.first_line && p.unit.item != task.item).map(|p| p.q);
    let in_pairs = stands_in_pairs(unit, task, focus, terms);
    let mut plans = plans(state, unit, task, focus, terms);
    plans.sort_by(|a, b| b.score.total_cmp(&a.score));
    plans.truncate((PLANS * 10 / task.count.max(10) as usize).max(3));
    // the most promising first: the rest is not set up once enough are better than it could become
    let mut sites: Vec<Site> = plans.iter().flat_map(|plan| sites(state.space, plan, unit, terms, aisle)).collect();
    // on an island some counters face the door, whichever way it is turned
    let one_line = |plan: &Plan| task.anchor.shape == Shape::Counter && !plan.paired;
    // who serves has a wall behind and an aisle to it: the rest of the hall is for those who are served
    sites.iter_mut().filter(|s| one_line(s.plan) && s.aisle_behind).for_each(|s| s.most += BACKED);
    sites.sort_by(|a, b| b.most.total_cmp(&a.most));
    let mut out: Vec<Batch> = Vec::new();
    for site in &sites {
        if out.get(KEPT - 1).is_some_and(|least| least.score >= site.most) {
            break;
        }
        let plan = site.plan;
        let mut placed = set_up(state, plan, unit, site.at, aisle, index, tally);
        if let Some((from, to)) = site.before_stage {
            // the row that makes up for others must not stand on the stage
            placed.retain(|p| {
                let r = p.world(&unit.bbox).turned((4 - plan.q) % 4);
                r.x0 >= from && r.x1 <= to
            });
        }
        let single = if in_pairs { leave_out_single(state.space, task, &mut placed) } else { 0 };
        if placed.is_empty() {
            continue;
        }
        let single = SINGLE * single as f64 / placed.len() as f64;
        let share = task.counted(placed.len()) as f64 / task.counted(usize::MAX).max(1) as f64;
        let raggedness = if task.spare > 0 { ragged(&placed, plan) } else { 0.0 };
        let dark = if in_pairs { from_windows(state.space, &placed) + mirrors(state.space, &placed) } else { 0.0 };
        let behind = if one_line(plan) { doors_behind(state.space, &placed) } else { 0.0 };
        let score = site.most + 8.0 * (share - 1.0) - raggedness - single - dark - behind;
        let at = out.partition_point(|other| other.score >= score);
        out.insert(at, Batch { placed, in_pairs, score });
        out.truncate(KEPT);
    }
    out
}

/// Where the low corner of rows may be.
struct Site<'p> {
    plan: &'p Plan,
    /// The corner, in the frame of the plan, mm.
    at: (i32, i32),
    /// The floor that rows leave a stage, from where to where they may stand.
    before_stage: Option<(i32, i32)>,
    /// True with an aisle and no more between the rows and the wall behind.
    aisle_behind: bool,
    /// What the rows are worth where everything finds its place, the most that they can be.
    most: f64,
}

/// Returns where the rows of a plan may begin: in the middle, at the walls, an aisle from them.
fn sites<'p>(space: &Space, plan: &'p Plan, unit: &Unit, terms: &Terms, aisle: i32) -> Vec<Site<'p>> {
    let wide = space.bounds.turned((4 - plan.q) % 4);
    let (d, w) = (unit.bbox.width(), unit.bbox.height());
    let (spare_u, spare_v) = (wide.width() - plan.depth(d), wide.height() - plan.breadth(w, aisle));
    let (back, front) = plan.margins(unit, unit.reach.x1 - unit.bbox.x1, terms.stage);
    let us = [(spare_u + back - front).max(0) / 2, back.min(spare_u), (spare_u - front).max(0), aisle];
    let vs = [spare_v / 2, 0, spare_v, aisle, spare_v - aisle];
    let staged = |u0: i32| terms.stage == 0 || (back..=spare_u - front).contains(&u0);
    let before_stage = (terms.stage > 0).then_some((wide.x0 + back, wide.x1 - front));
    let mut out = Vec::new();
    for (ku, u0) in us.into_iter().enumerate().filter(|(_, u0)| *u0 <= spare_u && staged(*u0)) {
        for (kv, v0) in vs.into_iter().enumerate().filter(|(_, v0)| (0..=spare_v).contains(v0)) {
            let tidy = [0.5, 0.3, 0.1, 0.1][ku] + [0.5, 0.25, 0.25, 0.1, 0.1][kv];
            // one comes to the rows past one of their ends
            let narrow = if plan.rows > 1 && v0.max(spare_v - v0) < aisle { NARROW_ENDS } else { 0.0 };
            let noise = 0.5 * grain(terms.salt, i64::from(plan.q) * 64 + i64::from(plan.columns), (ku * 8 + kv) as i64);
            let (at, most) = ((wide.x0 + u0, wide.y0 + v0), plan.score + tidy + noise - narrow);
            out.push(Site { plan, at, before_stage, aisle_behind: ku == AISLE_BEHIND, most });
        }
    }
    out
}

/// Returns true for desks of people who work together, looking at nothing but their work and each other.
fn stands_in_pairs(unit: &Unit, task: &Task, focus: Option<u8>, terms: &Terms) -> bool {
    let free_behind = unit.bbox.x0 > unit.reach.x0;
    let turned = focus.is_some() || terms.one_way || terms.stage > 0;
    unit.anchor().object.shape == Shape::Desk && task.count > 1 && !free_behind && !turned
}

/// Takes desks away with nobody across and no wall behind, where the room may do with fewer and most of them stay; returns how
/// many there are else.
pub(crate) fn leave_out_single(space: &Space, task: &Task, placed: &mut Vec<Placed>) -> usize {
    let back = |p: &Placed| {
        let own = p.world(&p.unit.anchor().solid.rect).turned((4 - p.q) % 4);
        (own.x0, own.y0, own.y1)
    };
    // where its back is and its middle along it, in the frame of the lower one of the two headings
    let place = |p: &Placed| {
        let (u, v0, v1) = back(p);
        let sign = if p.q < 2 { 1 } else { -1 };
        (p.q % 2, sign * u, sign * (v0 + v1))
    };
    let mut places: Vec<(u8, i32, i32)> = placed.iter().map(place).collect();
    places.sort_unstable();
    // another one next to it in the list is at the same place
    let is_alone = |place: (u8, i32, i32)| {
        let first = places.partition_point(|other| *other < place);
        places.get(first + 1) != Some(&place)
    };
    let is_single = |p: &Placed| {
        let (u, v0, v1) = back(p);
        let at = |w: &WallSide| w.q == p.q && (0..=AT_WALL).contains(&(u - w.u)) && w.v0 <= v0 && w.v1 >= v1;
        is_alone(place(p)) && !space.walls.iter().any(at)
    };
    let single = placed.iter().filter(|p| is_single(p)).count();
    let stay = placed.len() - single;
    let may_go = task.spare > 0 && stay >= task.required as usize && 3 * stay >= 2 * placed.len();
    if may_go && single > 0 {
        placed.retain(|p| !is_single(p));
        return 0;
    }
    single
}

/// Returns what desks lose that stand far from the windows of their room, on average.
fn from_windows(space: &Space, placed: &[Placed]) -> f64 {
    let apart = |a: (i32, i32), b: (i32, i32)| (b.0 - a.1).max(a.0 - b.1).max(0);
    let far = |p: &Placed| {
        let own = p.world(&p.unit.bbox);
        let to = |w: &Box2| apart((own.x0, own.x1), (w.x0, w.x1)) + apart((own.y0, own.y1), (w.y0, w.y1));
        space.windows.iter().map(|w| to(&w.zone)).min().unwrap_or(0)
    };
    let sum: i64 = placed.iter().map(|p| i64::from(far(p))).sum();
    FROM_LIGHT * sum as f64 / 1000.0 / placed.len().max(1) as f64
}

/// Returns what desks lose with windows right before or behind their screens.
fn mirrors(space: &Space, placed: &[Placed]) -> f64 {
    let mirrored = |p: &Placed| {
        let back = (4 - p.q) % 4;
        let (x, y) = p.world(&p.unit.anchor().solid.rect).turned(back).center();
        space.windows.iter().filter(|w| space.walls[w.wall].q % 2 == p.q % 2).any(|w| {
            let window = w.zone.turned(back);
            (window.y0 - y).max(y - window.y1) < MIRRORED.0 && (window.center().0 - x).abs() < MIRRORED.1
        })
    };
    MIRRORS * placed.iter().filter(|p| mirrored(p)).count() as f64 / placed.len().max(1) as f64
}

/// Returns what counters lose behind whose fronts the doors of their room are.
fn doors_behind(space: &Space, placed: &[Placed]) -> f64 {
    let behind = |p: &Placed, zone: &Box2| {
        let upright = (4 - p.q) % 4;
        let (own, door) = (p.world(&p.unit.anchor().solid.rect).turned(upright), zone.turned(upright));
        door.x0 + door.x1 < 2 * own.x1
    };
    let pairs = || placed.iter().flat_map(|p| space.doors.iter().map(move |d| (p, d)));
    let n = pairs().filter(|(p, d)| behind(p, &d.open_zone)).count();
    BEHIND_COUNTERS * n as f64 / pairs().count().max(1) as f64
}

/// Returns steps away from the middle of a room along both its axes, the short ones first: over the landing of a stairwell a lamp
/// has room, over its flights it has none.
fn off_middle(main: Box2) -> impl Iterator<Item = (i32, i32)> {
    let most = main.width().max(main.height()) / 2;
    let steps = (1..=most / OFF_STEP).map(|n| n * OFF_STEP);
    steps.flat_map(|far| [(far, 0), (-far, 0), (0, far), (0, -far)])
}

/// Returns how many units rows lack of being as long as the longest, over their number.
fn ragged(placed: &[Placed], plan: &Plan) -> f64 {
    let across = |p: &Placed| p.world(&p.unit.anchor().solid.rect).turned((4 - plan.q) % 4).x0;
    let mut rows: Vec<i32> = placed.iter().map(across).collect();
    rows.sort_unstable();
    let lengths = || rows.chunk_by(|a, b| a == b).map(<[i32]>::len);
    let longest = lengths().max().unwrap_or(0);
    lengths().map(|n| longest - n).sum::<usize>() as f64 / longest.max(1) as f64
}

fn plans(state: &State, unit: &Unit, task: &Task, focus: Option<u8>, terms: &Terms) -> Vec<Plan> {
    let count = task.count as i32;
    let (robot, look) = (terms.robot, unit.look());
    let aisle = robot.max(AISLE);
    let (b, r) = (unit.bbox, unit.reach);
    let (front, back) = (r.x1 - b.x1, b.x0 - r.x0);
    let side = (b.y0 - r.y0).max(r.y1 - b.y1);
    let shape = unit.anchor().object.shape;
    // those who serve at two lines of counters share the floor between them, as on an island
    let island = shape == Shape::Counter && b.x0 < unit.anchor().solid.rect.x0;
    let gap_back = if island { back.max(aisle) } else { 0 };
    // cars and stalls share the lane before them
    let lane = front >= SHARED_LANE && back == 0;
    let kind = matches!(shape, Shape::Desk | Shape::Rack | Shape::Shelf) || shape == Shape::Bench && !terms.one_way;
    let pairs = kind || island || lane;
    // tables stand apart where there is room
    let (apart, least) = match shape {
        Shape::Table => (TABLES_APART.max(side), side),
        Shape::RoundTable => (TABLES_APART.max(side), (TABLES_APART / 2).max(side)),
        _ => (side, side),
    };
    let mut sides = vec![apart, least];
    sides.dedup();
    let in_pairs = stands_in_pairs(unit, task, focus, terms);
    let need = front.max(back);
    let mut gaps = vec![if need > 0 { need } else { robot }, need.max(robot)];
    gaps.dedup();
    let mut out = Vec::new();
    for q in 0..4_u8 {
        let wide = state.space.bounds.turned((4 - q) % 4);
        let turned = focus.map_or(0.0, |f| if (q + look) % 4 == (f + 2) % 4 { 1.5 } else { 0.0 });
        let stage = if terms.stage > 0 { stage_score(state, (q + look + 2) % 4) } else { 0.0 };
        let set = turned + stage - if shape == Shape::Desk && focus.is_none() { glare(state, q) } else { 0.0 };
        for paired in [false, true] {
            if paired && (!pairs || focus.is_some() || count < 2 || back > gap_back || terms.stage > 0) {
                continue;
            }
            // whoever sits back to back has floor of one's own where there is room
            let behind_desks = BACK_TO_BACK - 2 * (b.x1 - unit.anchor().solid.rect.x1);
            let own = if paired && shape == Shape::Desk { (2 * need + PASSAGE).max(behind_desks) } else { 0 };
            // and never shares so much of it that neither could get up while the other sits there, however close things stand
            let least = (own - PASSAGE - SHARED_MOST).max(if own > 0 { behind_desks } else { 0 });
            let gaps = gaps.iter().copied().filter(|g| *g >= least).chain((own > 0).then_some(own));
            let gaps: Vec<i32> = gaps.collect();
            let widens = shape == Shape::Desk && focus.is_none();
            let hall = Hall { unit, task, wide, aisle, front, stage: terms.stage, own, set, in_pairs, widens };
            let gaps = gaps.iter().flat_map(|u| sides.iter().map(move |v| (*u, *v)));
            for ((gap_u, gap_v), run) in gaps.flat_map(|gap| [i32::MAX, 4, 3, 2].map(|run| (gap, run))) {
                let plan = Plan { q, columns: 1, rows: 1, count, run, gap_v, gap_u, paired, gap_back, score: 0.0 };
                out.extend((1..=count).map_while(|columns| hall.tries(plan, columns)).flatten().flatten());
            }
        }
    }
    out
}

/// What plans of rows with one heading are judged by; lengths in mm.
struct Hall<'h> {
    unit: &'h Unit<'h>,
    task: &'h Task<'h>,
    /// Bounds of the room, turned so that rows run along y.
    wide: Box2,
    aisle: i32,
    /// Floor before a unit.
    front: i32,
    /// Floor before the rows for whatever faces them.
    stage: i32,
    /// Floor that two rows back to back have for themselves.
    own: i32,
    /// What the heading is worth.
    set: f64,
    in_pairs: bool,
    /// True where the floor that is left may be shared out among the aisles.
    widens: bool,
}

impl Hall<'_> {
    /// Returns a plan with so many columns, rated, and the same with wider aisles where that is an own plan; `None` where the
    /// columns are too many for the room.
    fn tries(&self, plan: Plan, columns: i32) -> Option<[Option<Plan>; 2]> {
        let (d, w) = (self.unit.bbox.width(), self.unit.bbox.height());
        // full rows, where those that they leave out may go
        let full = plan.count - plan.count % columns;
        let count = if full > 0 && plan.count - full <= self.task.spare as i32 { full } else { plan.count };
        let rows = (count + columns - 1) / columns;
        let mut plan = Plan { columns, rows, count, ..plan };
        if plan.breadth(w, self.aisle) > self.wide.height() {
            return None;
        }
        if plan.run < i32::MAX && columns <= plan.run {
            return Some([None, None]); // no cross aisle: the same as one long run
        }
        let needs = |plan: &Plan| {
            let (low, high) = plan.margins(self.unit, self.front, self.stage);
            plan.depth(d) + low + high
        };
        while plan.rows > 1 && needs(&plan) > self.wide.width() {
            plan.rows -= 1;
        }
        let set = self.set - if self.in_pairs { OPEN_BACKS * plan.open_backs() } else { 0.0 };
        let rated = |plan: Plan| {
            let score = set - plan.shared(self.own) + rate(&plan, rows, self.task, (d, w), &self.wide, self.aisle);
            Plan { score, ..plan }
        };
        // the floor that is left shared out among the aisles
        let wider = || {
            let between = if plan.paired { (plan.rows - 1) / 2 } else { plan.rows - 1 };
            let left = (self.wide.width() - needs(&plan)) / (between + 2);
            Plan { gap_u: plan.gap_u + left.min(WIDENED) / 50 * 50, ..plan }
        };
        Some([Some(rated(plan)), (self.widens && plan.rows > 1).then(|| rated(wider()))])
    }
}

/// Rates the walls with this heading as what rows of seats look at: solid, and not where people come in.
fn stage_score(state: &State, q: u8) -> f64 {
    let walls = || state.space.walls.iter().enumerate().filter(|(_, w)| w.q == q);
    let length: i32 = walls().map(|(_, w)| w.length()).sum();
    let windows: i32 = walls().flat_map(|(i, _)| state.space.windows_of(i)).map(|w| w.v1 - w.v0).sum();
    let doors = walls().map(|(i, _)| state.space.doors.iter().filter(|d| d.wall == i).count()).sum::<usize>();
    let beside = state.space.doors.iter().map(|d| beside_stage(state.space, d, q)).sum::<f64>();
    -4.0 * f64::from(windows) / f64::from(length.max(1)) - IN_STAGE_WALL * doors as f64 - BESIDE_STAGE * beside
}

/// Returns how near a door is to the wall that rows look at, from 1 beside it to 0 in the middle of the room and behind: who
/// comes late walks before everybody.
fn beside_stage(space: &Space, door: &DoorZone, q: u8) -> f64 {
    let upright = (4 - q) % 4;
    let (room, at) = (space.bounds.turned(upright), door.zone.turned(upright).center().0);
    let far = f64::from(at - room.x0) / f64::from(room.width().max(1));
    (1.0 - 2.0 * far).max(0.0)
}

/// Rates windows before or behind the screens of desks with this heading.
fn glare(state: &State, q: u8) -> f64 {
    let space = state.space;
    let ahead = space.windows.iter().filter(|w| space.walls[w.wall].q % 2 == q % 2).count();
    GLARE * ahead as f64 / space.windows.len().max(1) as f64
}

fn rate(plan: &Plan, wished: i32, task: &Task, (d, w): (i32, i32), wide: &Box2, aisle: i32) -> f64 {
    let held = (plan.rows * plan.columns).min(plan.count);
    let due = task.counted(usize::MAX) as f64;
    let mut s = 8.0 * (task.counted(held as usize) as f64 - due) / due.max(1.0);
    // a block shaped like its room
    let (pu, pv) = (f64::from(plan.depth(d)), f64::from(plan.breadth(w, aisle)));
    let (ru, rv) = (f64::from(wide.width()), f64::from(wide.height()));
    s -= 2.0 * (pu / ru - pv / rv).abs();
    // who is served stands before one line of counters, or around an island
    if task.anchor.shape == Shape::Counter {
        s -= IN_LINE * f64::from(plan.rows - 1) * if plan.paired { ISLAND } else { 1.0 };
    }
    // full rows, long runs broken by aisles, wide aisles where there is room
    s -= 0.5 * f64::from(plan.columns * wished - plan.count) / f64::from(plan.columns);
    s -= if plan.run == i32::MAX && plan.columns > 4 { 0.8 } else { 0.0 };
    s -= if plan.run == 2 { 0.2 } else { 0.0 };
    // people who work together sit face to face
    let together = if task.spare > 0 { 1.6 } else { 0.6 };
    s + if plan.paired { together } else { 0.0 }
        + f64::from(plan.gap_v.min(600)) / 1500.0
        + f64::from(plan.gap_u.min(1500)) / 5000.0
}

fn set_up<'a>(
    state: &State<'a, '_>,
    plan: &Plan,
    unit: &Rc<Unit<'a>>,
    (u0, v0): (i32, i32),
    aisle: i32,
    index: usize,
    tally: &mut Tally,
) -> Vec<Placed<'a>> {
    let b = unit.bbox;
    let (d, w) = (b.width(), b.height());
    let mut out: Vec<Placed> = Vec::new();
    // one row more than needed makes up for places that doors take
    for r in 0..=plan.rows {
        for c in 0..plan.columns {
            if out.len() as i32 >= plan.count {
                return out;
            }
            let ((du, around), dv) = (plan.row(r, d), plan.column(c, w, aisle));
            let (q, u, v) = if around {
                // turned by half a turn, so that its back is at the high end of its row
                (((plan.q + 2) % 4), -(u0 + du + d) - b.x0, -(v0 + dv) - b.y1)
            } else {
                (plan.q, u0 + du - b.x0, v0 + dv - b.y0)
            };
            let placed = at_frame(unit, q, u, v, index);
            match state.fit(placed, false) {
                Ok(placed) => out.push(placed),
                Err(rule) => tally[rule as usize] += 1,
            }
        }
    }
    out
}

/// Tests a lamp against the others of its batch, which the state does not know yet.
fn apart(others: &[Placed], p: &Placed) -> Result<(), Rule> {
    let body = p.world(&p.unit.bbox);
    let free = others.iter().all(|o| !o.world(&o.unit.bbox).overlaps(&body));
    if free { Ok(()) } else { Err(Rule::Collision) }
}

/// Returns curtains on the ceiling across the feet of the beds a room begins with.
fn at_feet<'a>(
    state: &State<'a, '_>,
    task: &Task,
    index: usize,
    unit: &Rc<Unit<'a>>,
    tally: &mut Tally,
) -> Vec<Batch<'a>> {
    let mut placed: Vec<Placed> = Vec::new();
    for host in state.placed.iter().filter(|p| p.first_line && p.on_floor()).take(task.count as usize) {
        let anchor = host.world(&host.unit.anchor().solid.rect).turned((4 - host.q) % 4);
        let v = (anchor.y0 + anchor.y1) / 2 - (unit.bbox.y0 + unit.bbox.y1) / 2;
        let tries = FOOT_GAPS.map(|gap| at_frame(unit, host.q, anchor.x1 + gap - unit.bbox.x0, v, index));
        let fits = |p: &Placed| state.test(p, false).and_then(|()| apart(&placed, p));
        match tries.into_iter().find(|p| fits(p).is_ok()) {
            Some(p) => placed.push(p),
            None => tally[Rule::Collision as usize] += 1,
        }
    }
    if placed.is_empty() { Vec::new() } else { vec![Batch { placed, in_pairs: false, score: 1.0 }] }
}

/// Returns true for a small device that watches the air or the room from the ceiling.
fn senses(unit: &Unit) -> bool {
    unit.bbox.width() < DEVICE && unit.anchor().object.affordances.iter().any(|a| a == "see")
}

/// Moves what senses smoke along the room to the nearest place away from doors through which steam comes; where no place is
/// far enough, to the farthest.
fn far_from_doors<'a>(
    space: &Space,
    p: &Placed<'a>,
    test: impl Fn(&Placed<'a>) -> Result<(), Rule>,
) -> Result<Placed<'a>, Rule> {
    let openings: Vec<Box2> =
        space.doors.iter().filter(|d| d.wet).map(|d| space.walls[d.wall].strip(d.v0, d.v1, 0, 0)).collect();
    let along_x = space.main.width() >= space.main.height();
    let half = space.main.width().max(space.main.height()) / 2;
    let steps = (0..=half / ALONG).flat_map(|k| [k * ALONG, -k * ALONG]);
    let mut best: Result<(i32, Placed), Rule> = Err(Rule::Collision);
    for step in steps {
        let at = if along_x { (p.at.0 + step, p.at.1) } else { (p.at.0, p.at.1 + step) };
        let moved = Placed { at, ..p.clone() };
        if test(&moved).is_err() {
            continue;
        }
        let body = moved.world(&moved.unit.bbox);
        let far = openings.iter().map(|o| o.distance(&body)).min().unwrap_or(FROM_DOOR).min(FROM_DOOR);
        if best.as_ref().is_ok_and(|(most, _)| *most >= far) {
            continue;
        }
        best = Ok((far, moved));
        if far == FROM_DOOR {
            break;
        }
    }
    best.map(|(_, moved)| moved)
}

/// Returns units spread evenly over the ceiling of the room's main part.
pub(crate) fn over<'a>(
    state: &State<'a, '_>,
    task: &Task,
    index: usize,
    unit: &Rc<Unit<'a>>,
    tally: &mut Tally,
) -> Vec<Batch<'a>> {
    debug_assert!(task.arrangement == Arrangement::Overhead);
    if unit.anchor().object.shape == Shape::Curtain {
        return at_feet(state, task, index, unit, tally);
    }
    let main = state.space.main;
    let count = task.count.max(1) as i32;
    let (long, short) = (main.width().max(main.height()), main.width().min(main.height()));
    // as many lines as keep the spacing alike in both directions
    let lines = (1..=count).find(|l| (count + l - 1) / l * short <= long * l || *l == count).unwrap_or(1);
    let each = (count + lines - 1) / lines;
    let along_x = main.width() >= main.height();
    let (bx, by) = unit.bbox.center();
    let mut placed = Vec::new();
    for k in 0..count {
        let (line, n) = (k / each, k % each);
        let in_line = each.min(count - line * each);
        let a = long * (2 * n + 1) / (2 * in_line);
        let s = short * (2 * line + 1) / (2 * lines);
        let (x, y) = if along_x { (main.x0 + a, main.y0 + s) } else { (main.x0 + s, main.y0 + a) };
        let q = if along_x { 1 } else { 0 };
        let (du, dv) = turn(q, bx, by);
        let (u, v) = turn(4 - q, x - du, y - dv);
        let p = at_frame(unit, q, u, v, index);
        let mut tested = Err(Rule::Collision);
        if senses(unit) {
            tested = far_from_doors(state.space, &p, |p| state.test(p, false).and_then(|()| apart(&placed, p)));
        }
        // beside its place in line where a lamp or a hood hangs already
        for (du, dv) in BESIDE.into_iter().chain(off_middle(main)) {
            if tested.is_ok() {
                break;
            }
            let moved = Placed { at: (p.at.0 + du, p.at.1 + dv), ..p.clone() };
            tested = state.test(&moved, false).and_then(|()| apart(&placed, &moved)).map(|()| moved);
        }
        match tested {
            Ok(p) => placed.push(p),
            Err(rule) => tally[rule as usize] += 1,
        }
    }
    if placed.is_empty() { Vec::new() } else { vec![Batch { placed, in_pairs: false, score: 1.0 }] }
}
