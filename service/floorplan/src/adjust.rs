//! Plans that are changed instead of made: some rooms locked, a room more or less, a wall moved.

use d3dgen_model::floorplan::{Door, Floorplan};
use d3dgen_model::scene_graph::Note;
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::{Error, Stop};

use super::assemble::{Earlier, assemble};
use super::board::{Board, cells, units};
use super::cost::{Judge, WEIGHTS, taste};
use super::insert::Chooser;
use super::lattice::{Cellbox, meters, nearest};
use super::outline::Mosaic;
use super::revise::{Aim, Task};
use super::spec::{Brief, RoomSpec};

/// Searches of a part before it is given up.
const ATTEMPTS: usize = 10;
/// The same around locked rooms, where all that there is at first is to become something else.
const ANEW_ATTEMPTS: usize = 40;

/// Places tried for a room more.
const PLACES: usize = 10;

/// A wall that is to stand elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct WallMove {
    /// Id of any piece of it.
    pub wall_id: String,
    /// How far to the east or north, m; negative to the west or south. Whole steps of 5 cm are made of it.
    pub by_m: f64,
}

/// Plans the rooms that are not locked anew around those that are.
pub(crate) fn replan(
    brief: &Brief,
    plan: &Floorplan,
    seed: u64,
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    let site = Site::new(brief, plan)?;
    let start = site.with_the_rooms_asked_for(0)?;
    let pins = site.behind_doors();
    let task = Task { brief, kept: &site.kept, pins: &pins, aim: Aim::Anew, moves_spine: false };
    site.search(&task, &start, seed, rng, stop)
}

/// Changes a plan as little as the change asks for: rooms that the brief has and the plan lacks are added, rooms that the
/// brief lacks are taken out, and a wall is moved.
pub(crate) fn change(
    brief: &Brief,
    plan: &Floorplan,
    moved: Option<&WallMove>,
    rng: &mut Stream,
    stop: Stop<'_>,
) -> Result<Floorplan, Error> {
    let site = Site::new(brief, plan)?;
    let more = brief.rooms.len() > plan.rooms.len();
    let mut outcome = None;
    for nth in 0..if more { PLACES } else { 1 } {
        // When there are no more places, the first refusal stands.
        let mut start = match (site.with_the_rooms_asked_for(nth), &outcome) {
            (Ok(start), _) => start,
            (Err(error), None) => return Err(error),
            (Err(_), Some(_)) => break,
        };
        let mut pins = moved.map_or(Ok(Vec::new()), |m| site.move_wall(&mut start, m))?;
        pins.extend(site.behind_doors());
        let task = Task { brief, kept: &site.kept, pins: &pins, aim: Aim::Repair, moves_spine: false };
        match site.search(&task, &start, plan.seed, rng, stop) {
            Ok(plan) => return Ok(plan),
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            Err(error) => outcome = outcome.or(Some(Err(error))),
        }
    }
    outcome.unwrap_or_else(|| Ok(plan.clone()))
}

/// A plan that is to be changed.
struct Site<'a> {
    brief: &'a Brief,
    plan: &'a Floorplan,
    board: Board,
    /// By room of the brief: true for those that stay as they are.
    kept: Vec<bool>,
}

impl<'a> Site<'a> {
    fn new(brief: &'a Brief, plan: &'a Floorplan) -> Result<Self, Error> {
        let board = Board::read(brief, plan).map_err(refused)?;
        // What holds a locked part keeps its walls.
        let by_parts: Vec<&str> = plan
            .walls
            .iter()
            .filter(|w| w.locked)
            .flat_map(|w| &w.room_ids)
            .chain(plan.doors.iter().filter(|d| d.locked).flat_map(|d| &d.room_ids))
            .chain(plan.windows.iter().filter(|w| w.locked).map(|w| &w.room_id))
            .map(String::as_str)
            .collect();
        let kept = |id: &str| plan.room(id).is_some_and(|r| r.locked) || by_parts.contains(&id);
        // stairs and shafts line up with those of other storeys
        let kept = brief.rooms.iter().map(|r| r.fixed || kept(&r.id)).collect();
        Ok(Self { brief, plan, board, kept })
    }

    /// Returns the board with exactly the rooms of the brief; new ones at the place that is `nth` best.
    fn with_the_rooms_asked_for(&self, nth: usize) -> Result<Board, Error> {
        let known = |id: &str| self.brief.rooms.iter().any(|r| r.id == id);
        let strangers: Vec<_> = self.plan.rooms.iter().filter(|r| !known(&r.room_id)).collect();
        if let Some(locked) = strangers.iter().find(|r| r.locked) {
            return Err(Error::Mismatch {
                stage: "floorplan",
                message: format!(
                    "locked room `{}` is not in the scene graph; unlock it to take it out",
                    locked.room_id
                ),
            });
        }
        let gone: Vec<Vec<Cellbox>> = strangers.iter().map(|r| cells(r).map_err(refused)).collect::<Result<_, _>>()?;
        let mut board = self.board.clone();
        let mut chooser = Chooser::new(self.brief, &WEIGHTS, &self.kept, &self.board, &gone);
        for (room, hole) in strangers.iter().zip(&gone) {
            let enclosed = !self.plan.walls.iter().any(|w| w.exterior && w.room_ids.contains(&room.room_id));
            board = chooser.close(&board, hole, enclosed);
        }
        for room in (0..board.rooms.len()).filter(|&r| self.board.rooms[r].is_empty()) {
            board = chooser.insert(&board, room, nth).ok_or_else(|| Error::Infeasible {
                stage: "floorplan",
                message: format!(
                    "there is no place for `{}` beside the locked rooms; unlock some, or plan the building anew",
                    self.brief.rooms[room].id
                ),
            })?;
        }
        Ok(board)
    }

    /// Moves a wall on the board; returns what has to stay so.
    fn move_wall(&self, board: &mut Board, moved: &WallMove) -> Result<Vec<(usize, Cellbox)>, Error> {
        let wall = self.plan.walls.iter().find(|w| w.wall_id == moved.wall_id).ok_or_else(|| Error::Mismatch {
            stage: "floorplan",
            message: format!("the plan has no wall `{}`", moved.wall_id),
        })?;
        let by = nearest(moved.by_m);
        if by == 0 {
            return Err(refused(format!("wall `{}` is to move by less than 5 cm", moved.wall_id)));
        }
        let (vertical, middle) = (wall.line.is_vertical(), wall.line.middle());
        let (at, along) = if vertical { (middle.x, middle.y) } else { (middle.y, middle.x) };
        let stretches = Mosaic::new(&board.layout().boxes).stretches();
        let stretch = stretches
            .iter()
            .find(|s| s.vertical == vertical && s.at == nearest(at) && (meters(s.from)..=meters(s.to)).contains(&along))
            .ok_or_else(|| refused(format!("wall `{}` is not where rooms meet", moved.wall_id)))?;
        if let Some(room) = [stretch.low, stretch.high].into_iter().flatten().find(|&r| self.kept[r]) {
            if self.brief.rooms[room].fixed {
                return Err(refused(format!(
                    "wall `{}` belongs to `{}`, which lines up with other storeys",
                    moved.wall_id, self.brief.rooms[room].id
                )));
            }
            return Err(refused(format!(
                "wall `{}` belongs to `{}`, which is locked; unlock it first",
                moved.wall_id, self.brief.rooms[room].id
            )));
        }
        let strip = |from: i32, to: i32| {
            if vertical {
                Cellbox::new(from, stretch.from, to, stretch.to)
            } else {
                Cellbox::new(stretch.from, from, stretch.to, to)
            }
        };
        let edge = stretch.at + by;
        let taken = strip(stretch.at, edge);
        let (grows, yields) = if by > 0 { (stretch.low, stretch.high) } else { (stretch.high, stretch.low) };
        let mut pins = Vec::new();
        match grows {
            Some(room) => {
                board.give(room, &taken);
                pins.push((room, taken));
            }
            None => board.clear(&taken),
        }
        if let Some(room) = yields {
            // One step behind the wall is the other room's, so that the wall goes no farther.
            pins.push((room, strip(edge, edge + by.signum())));
        }
        Ok(pins)
    }

    /// Searches from a board until a plan stands.
    fn search(
        &self,
        task: &Task<'_>,
        start: &Board,
        seed: u64,
        rng: &mut Stream,
        stop: Stop<'_>,
    ) -> Result<Floorplan, Error> {
        let mut last = String::from("sizes, doors or daylight of the rooms around do not work out");
        let earlier = Earlier { plan: self.plan, kept: &self.kept };
        let attempts = if task.aim == Aim::Anew { ANEW_ATTEMPTS } else { ATTEMPTS };
        for attempt in 0..attempts {
            // A change that is sound by itself needs no repair.
            let board = match (attempt, task.aim) {
                (0, Aim::Repair) => start.clone(),
                _ => task.revise(start, &taste(self.brief, rng), rng, stop),
            };
            stop.check()?;
            if task.aim == Aim::Anew && board == *start {
                continue;
            }
            if !task.accepts(&board) {
                last = self.shortfall(&board).unwrap_or(last);
                continue;
            }
            match self.finish(&board, &earlier, seed, rng) {
                Ok(plan) => return Ok(plan),
                Err(reason) => last = reason,
            }
        }
        if task.aim == Aim::Anew
            && task.accepts(start)
            && let Ok(mut plan) = self.finish(start, &earlier, seed, rng)
        {
            plan.conflicts.push(Note {
                code: "nothing_else_fits".into(),
                message: "around the locked rooms no other plan was found; the rooms stay where they were".into(),
            });
            return Ok(plan);
        }
        Err(Error::Infeasible { stage: "floorplan", message: last })
    }

    fn finish(&self, board: &Board, earlier: &Earlier<'_>, seed: u64, rng: &mut Stream) -> Result<Floorplan, String> {
        let layout = board.layout();
        let score = Judge::new(self.brief).score(&layout);
        let plan = assemble(self.brief, &layout.boxes, &score, seed, &self.plan.scheme, Some(earlier), rng)?;
        match self.opens_elsewhere(&plan) {
            Some(room) if room.fixed => {
                Err(format!("the door of `{}` would move away from those of the other storeys", room.id))
            }
            Some(room) => Err(format!("a door of `{}` would move, which is locked", room.id)),
            None => Ok(plan),
        }
    }

    /// Returns a room that stays as it is but for a door that is not where it was.
    fn opens_elsewhere(&self, plan: &Floorplan) -> Option<&RoomSpec> {
        let known = |id: &String| self.brief.rooms.iter().any(|r| &r.id == id);
        let stays = |id: &str| {
            let standing = |d: &Door| plan.doors_of(id).any(|n| n.line == d.line && n.kind == d.kind);
            self.plan.doors_of(id).filter(|d| d.room_ids.iter().all(known)).all(standing)
        };
        self.brief.rooms.iter().zip(&self.kept).find(|(room, kept)| **kept && !stays(&room.id)).map(|(room, _)| room)
    }

    /// Returns the floor right behind the doors of kept rooms, which stays with the room that they lead to.
    fn behind_doors(&self) -> Vec<(usize, Cellbox)> {
        let index = |id: &String| self.brief.rooms.iter().position(|r| &r.id == id);
        let mut pins = Vec::new();
        for door in &self.plan.doors {
            let [Some(a), Some(b)] = [0, 1].map(|i| door.room_ids.get(i).and_then(index)) else { continue };
            let other = match (self.kept[a], self.kept[b]) {
                (true, false) => b,
                (false, true) => a,
                _ => continue,
            };
            let (p, q) = (door.line.start, door.line.end);
            for by in [-1, 1] {
                let strip = if door.line.is_vertical() {
                    Cellbox::new(nearest(p.x), nearest(p.y), nearest(p.x) + by, nearest(q.y))
                } else {
                    Cellbox::new(nearest(p.x), nearest(p.y), nearest(q.x), nearest(p.y) + by)
                };
                if self.board.owners(&strip) == [(other, units(&strip))] {
                    pins.push((other, strip));
                }
            }
        }
        pins
    }

    /// Names a room that is in pieces or has lost its place, if that is what is wrong.
    fn shortfall(&self, board: &Board) -> Option<String> {
        let room = (0..board.rooms.len()).find(|&r| !board.is_whole(r))?;
        Some(format!("`{}` is left without a floor in one piece", self.brief.rooms[room].id))
    }
}

fn refused(message: String) -> Error {
    Error::Refused { stage: "floorplan", message }
}
