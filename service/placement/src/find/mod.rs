//! Positions for one unit, by arrangement: each valid one with how good it is, higher is better.

mod barred;
mod center;
mod ends;
mod exits;
mod fill;
mod rows;
mod top;
mod walls;

use std::rc::Rc;

use d3dgen_model::domain::{Arrangement, Mount, Shape};

pub(super) use exits::lines_at_exit;
pub(super) use rows::{Terms, leave_out_single, over, rows};

use super::demand::{Task, is_table};
use super::docks::{crowding, touches_robot};
use super::geom::{Box2, turn};
use super::neighbors::{Neighbors, beside_sofas};
use super::seats::{beside_beds, sits_with_staff};
use super::state::{Placed, Rule, State};
use super::style::{Style, grain, style};
use super::unit::Unit;

/// What a lone seat for visitors loses on the staff's side of a counter: more than all else there can make up for.
const WITH_STAFF: f64 = 9.0;
/// What a place loses for each small thing that has none there, and for what would hang on the wall beside it.
const LOST: f64 = 0.4;
const LOST_ASIDE: f64 = 2.0;

/// What a place loses that leaves wheelchairs no floor to turn on.
const NO_CIRCLE: f64 = 6.0;

/// How far ahead of the middle of those who look at it a screen hangs at least, and how much farther aside than ahead, mm.
const AHEAD: i32 = 400;
const ASIDE: i32 = 600;

/// A valid position, routes not yet looked at.
#[derive(Debug, Clone)]
pub(super) struct Candidate<'a> {
    pub placed: Placed<'a>,
    pub score: f64,
    /// True for what is wanted in a corner and stands in one.
    pub in_corner: bool,
    /// Positions of one class look alike (one wall, one corner): the search tries different classes.
    pub class: u32,
}

/// What a room turns to.
#[derive(Debug, Clone, Copy)]
struct Focus {
    /// Where its users look, in quarters.
    q: u8,
    /// Its outline.
    rect: Box2,
    /// The middle of what they sit on, lie in or sit at.
    seat: (i32, i32),
    /// True when they sit around it.
    around: bool,
}

impl Focus {
    /// Returns true for what its users have before them without turning their heads far.
    fn sees(&self, thing: &Box2) -> bool {
        let back = (4 - self.q) % 4;
        let ((x, y), (from, axis)) = (thing.turned(back).center(), turn(back, self.seat.0, self.seat.1));
        x - from > AHEAD && (y - axis).abs() < x - from + ASIDE
    }
}

/// How often each rule turned a position down.
pub(super) type Tally = [u32; 7];

/// The search for positions of one unit in one state of the room.
pub(super) struct Find<'f, 'a, 's> {
    pub state: &'f State<'a, 's>,
    pub task: &'f Task<'a>,
    pub index: usize,
    /// Makes equal positions differ a little, by seed and room.
    pub salt: u64,
    /// Robot's diameter with a margin, mm: narrower gaps are dead corners.
    pub aisle: i32,
    pub out: Vec<Candidate<'a>>,
    pub tally: &'f mut Tally,
    /// What will face this unit from the wall across.
    pub across: Option<Rc<Unit<'a>>>,
    /// Toward which end of its wall it stands rather than in the middle; 0 for neither.
    pub aside: i8,
    /// True for one of several docks.
    pub banked: bool,
    /// True where a sofa is not moved from its wall towards what it looks at.
    pub at_wall: bool,
    style: Style,
    /// What the unit must not disturb, where the room can do without it.
    neighbors: Option<Neighbors<'f, 'a, 's>>,
}

impl<'f, 'a, 's> Find<'f, 'a, 's> {
    pub fn new(
        state: &'f State<'a, 's>,
        task: &'f Task<'a>,
        index: usize,
        salt: u64,
        aisle: i32,
        tally: &'f mut Tally,
    ) -> Self {
        let both = task.anchor.clear_sides > 1 && task.anchor.clearance_side_m > 0.0;
        let style = style(task.anchor.shape, task.anchor.mount, both);
        let (out, across, neighbors) = (Vec::new(), None, None);
        let (aside, banked, at_wall) = (0, false, false);
        Self { state, task, index, salt, aisle, out, tally, across, aside, banked, at_wall, style, neighbors }
    }

    /// Collects positions of a unit as the task's arrangement wants it.
    pub fn run(mut self, unit: &Rc<Unit<'a>>) -> Vec<Candidate<'a>> {
        if self.task.required == 0 {
            self.neighbors = Some(Neighbors::new(self.state, unit, self.aisle));
        }
        match self.task.arrangement {
            Arrangement::OnSurface => self.on_surfaces(unit),
            Arrangement::AtWindow => self.at_windows(unit),
            Arrangement::Center => self.center(unit),
            Arrangement::Rows if is_table(self.task.anchor) => self.beside_rows(unit),
            Arrangement::Facing => self.facing(unit),
            Arrangement::FacingDoor => self.facing_door(unit),
            _ if self.task.anchor.mount == Mount::Surface => self.on_surfaces(unit),
            _ => self.along_walls(unit),
        }
        self.out
    }

    /// Tests a position and keeps it when it breaks no rule.
    fn offer(&mut self, placed: Placed<'a>, class: u32, score: impl FnOnce(&Self, &Placed<'a>) -> f64) {
        let spare = self.task.required == 0;
        if spare && self.state.hides(&placed) {
            return self.none(Rule::NoPlace);
        }
        let disturbed = self.neighbors.as_ref().is_some_and(|n| n.are_disturbed_by(&placed));
        if disturbed || touches_robot(self.state, &placed, self.aisle) {
            return self.none(Rule::Clearance);
        }
        let at_window = self.task.arrangement == Arrangement::AtWindow;
        let whole = Rc::clone(&placed.unit);
        match self.state.fit(placed, at_window) {
            Ok(placed) => {
                let fills = self.state.fills_circle(&placed);
                if fills && spare {
                    return self.none(Rule::Clearance);
                }
                let grain = grain(
                    self.salt,
                    i64::from(placed.at.0 / 50),
                    i64::from(placed.at.1 / 50) * 4 + i64::from(placed.q),
                );
                let score = score(self, &placed) + 0.25 * grain + 0.6 * self.class_grain(class)
                    - loss(&whole, &placed.unit)
                    - crowding(self.state, &placed, self.aisle)
                    - if sits_with_staff(self.state, &placed) { WITH_STAFF } else { 0.0 }
                    - beside_beds(self.state, &placed)
                    - beside_sofas(self.state, &placed)
                    - if fills { NO_CIRCLE } else { 0.0 };
                let in_corner = self.task.arrangement == Arrangement::Corner && self.is_in_corner(&placed);
                self.out.push(Candidate { placed, score, in_corner, class });
            }
            Err(rule) => self.tally[rule as usize] += 1,
        }
    }

    fn class_grain(&self, class: u32) -> f64 {
        grain(self.salt, i64::from(class) + 1, self.task.line as i64)
    }

    fn none(&mut self, rule: Rule) {
        self.tally[rule as usize] += 1;
    }

    /// Returns where units of the same task stand already.
    fn siblings(&self) -> impl Iterator<Item = &Placed<'a>> {
        self.state.placed.iter().filter(|p| p.unit.item == self.task.item)
    }

    /// Returns what the room turns to: the first furnishing line's units, or whatever was placed first.
    fn focus(&self) -> Option<Focus> {
        let other = || self.state.placed.iter().filter(|p| p.unit.item != self.task.item);
        let first = other().find(|p| p.first_line).or_else(|| other().next())?;
        let alike = || other().filter(|p| p.task == first.task && p.q == first.q);
        let rect = alike().map(|p| p.world(&p.unit.bbox)).reduce(|a, b| a.union(&b))?;
        let own = alike().map(|p| p.world(&p.unit.anchor().solid.rect)).reduce(|a, b| a.union(&b))?;
        let round = matches!(first.unit.anchor().object.shape, Shape::Table | Shape::RoundTable);
        let around = round && alike().count() == 1 && first.unit.parts.len() > 1;
        Some(Focus { q: (first.q + first.unit.look()) % 4, rect, seat: own.center(), around })
    }
}

/// Returns what a place loses that leaves this much of a whole unit.
fn loss(whole: &Unit, left: &Unit) -> f64 {
    let aside = |unit: &Unit| unit.parts.iter().filter(|part| part.hangs_aside()).count() as f64;
    let gone = (whole.parts.len() - left.parts.len()) as f64;
    if gone > 0.0 { LOST * gone + (LOST_ASIDE - LOST) * (aside(whole) - aside(left)) } else { 0.0 }
}
