//! What every reader makes of its file: rooms, walls, openings and labels in meters, x east and y north.
//!
//! Nothing here is checked: outlines may cross, overlap, lean; `layout` judges them.

use d3dgen_model::Point;
use d3dgen_model::scene_graph::Note;

use crate::Error;

/// Most points of one file; larger drawings are not floor plans.
pub(crate) const MOST_POINTS: usize = 200_000;

/// A plan as drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// Closed outlines of rooms.
    pub rooms: Vec<DrawnRoom>,
    /// Walls as lines; rooms are what they enclose where no outlines are drawn.
    pub walls: Vec<DrawnWall>,
    /// Doors, passages, windows.
    pub openings: Vec<DrawnOpening>,
    /// Words on the plan.
    pub labels: Vec<DrawnLabel>,
    /// Floors that walls stand on: they bound rooms where no wall is drawn.
    pub floors: Vec<DrawnFloor>,
    /// What the file calls the building.
    pub titles: Vec<String>,
    /// What was assumed while reading.
    pub notes: Vec<Note>,
}

/// A closed outline.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnRoom {
    /// Name on the plan; empty when the words inside are to be taken.
    pub label: String,
    /// What the file says it is (`bedroom`), beside the name.
    pub kind: Option<String>,
    /// Corners in either sense, m.
    pub corners: Vec<Point>,
    /// Outlines inside that are no floor of it: courts, shafts, other rooms.
    pub holes: Vec<Vec<Point>>,
    /// Storey.
    pub level: Option<String>,
    /// Clear height, m.
    pub height_m: Option<f64>,
    /// True when it was found rather than drawn: it gives way where it does not fit, and the plan stands without it.
    pub traced: bool,
    /// Where it stands in the file, for messages.
    pub place: String,
}

impl DrawnRoom {
    pub(crate) fn new(label: String, corners: Vec<Point>, place: String) -> Self {
        let (kind, holes, level, height_m) = (None, Vec::new(), None, None);
        Self { label, kind, corners, holes, level, height_m, traced: false, place }
    }
}

/// A piece of floor under walls.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnFloor {
    /// Corners in either sense, m.
    pub corners: Vec<Point>,
    /// True for a hole in the floor.
    pub hole: bool,
    /// Storey.
    pub level: Option<String>,
}

/// A wall as a line.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnWall {
    /// Ends, m.
    pub line: [Point; 2],
    /// Storey.
    pub level: Option<String>,
    /// Where it stands in the file, for messages.
    pub place: String,
}

/// What an opening is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum OpeningKind {
    /// With a leaf.
    Door,
    /// Without a leaf.
    Passage,
    /// In an outer wall, above the floor.
    Window,
}

/// A door, passage or window.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnOpening {
    /// What it is.
    pub kind: OpeningKind,
    /// Points it is drawn with: the ends of a line, the corners of a box, or one point, m.
    pub points: Vec<Point>,
    /// Width, m, where the file states it.
    pub width_m: Option<f64>,
    /// Height of sill and head above the floor, m, where the file states them.
    pub sill_m: Option<f64>,
    /// See `sill_m`.
    pub head_m: Option<f64>,
    /// True when it slides along the wall.
    pub sliding: bool,
    /// A leaf drawn as a quarter circle: hinge, and the two ends of the arc, m; `points` is then empty.
    pub arc: Option<[Point; 3]>,
    /// Storey.
    pub level: Option<String>,
    /// Where it stands in the file, for messages.
    pub place: String,
}

impl DrawnOpening {
    pub(crate) fn new(kind: OpeningKind, points: Vec<Point>, level: Option<String>, place: String) -> Self {
        Self { kind, points, width_m: None, sill_m: None, head_m: None, sliding: false, arc: None, level, place }
    }
}

/// Words at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnLabel {
    /// The words.
    pub text: String,
    /// Where, m.
    pub at: Point,
    /// Storey.
    pub level: Option<String>,
}

/// Returns a note.
pub(crate) fn note(code: &str, message: impl Into<String>) -> Note {
    Note { code: code.into(), message: message.into() }
}

impl Drawing {
    /// Returns every point of the drawing.
    pub(crate) fn points_mut(&mut self) -> impl Iterator<Item = &mut Point> {
        let rooms = self
            .rooms
            .iter_mut()
            .flat_map(|r| r.corners.iter_mut().chain(r.holes.iter_mut().flat_map(|h| h.iter_mut())));
        let floors = self.floors.iter_mut().flat_map(|f| f.corners.iter_mut());
        let walls = self.walls.iter_mut().flat_map(|w| w.line.iter_mut());
        let openings = self
            .openings
            .iter_mut()
            .flat_map(|o| o.points.iter_mut().chain(o.arc.iter_mut().flat_map(|a| a.iter_mut())));
        rooms.chain(walls).chain(openings).chain(floors).chain(self.labels.iter_mut().map(|l| &mut l.at))
    }

    /// Refuses numbers that are none and drawings beyond any building.
    pub(crate) fn check_numbers(&mut self) -> Result<(), Error> {
        let mut count = 0_usize;
        for p in self.points_mut() {
            count += 1;
            if !(p.x.is_finite() && p.y.is_finite() && p.x.abs() < 1e9 && p.y.abs() < 1e9) {
                let message = format!("the point ({}, {}) is no place in a building", p.x, p.y);
                return Err(Error::refused("drawing", message));
            }
        }
        if count > MOST_POINTS {
            return Err(Error::refused("drawing", format!("has {count} points, at most {MOST_POINTS} are read")));
        }
        Ok(())
    }

    /// Keeps one storey: the named one, or the first that has rooms or walls.
    ///
    /// # Errors
    /// `Refused` with the storeys there are.
    pub(crate) fn keep_level(&mut self, wanted: Option<&str>) -> Result<(), Error> {
        let mut levels: Vec<String> = Vec::new();
        let all = self.rooms.iter().map(|r| &r.level).chain(self.walls.iter().map(|w| &w.level));
        let all = all.chain(self.floors.iter().map(|f| &f.level));
        for level in all.flatten() {
            if !levels.contains(level) {
                levels.push(level.clone());
            }
        }
        let Some(first) = levels.first() else {
            return match wanted {
                None => Ok(()),
                Some(level) => {
                    Err(Error::refused("--level", format!("`{level}` is not there; the plan names no levels")))
                }
            };
        };
        let chosen = match wanted {
            None => first.clone(),
            Some(level) if levels.iter().any(|l| l.trim().eq_ignore_ascii_case(level.trim())) => {
                levels.iter().find(|l| l.trim().eq_ignore_ascii_case(level.trim())).cloned().unwrap_or_default()
            }
            Some(level) => {
                let message = format!("`{level}` is not there; the plan has {}", levels.join(", "));
                return Err(Error::refused("--level", message));
            }
        };
        if levels.len() > 1 && wanted.is_none() {
            let other = levels.get(1).cloned().unwrap_or_default();
            let message = format!(
                "the plan has {} levels ({}); only `{chosen}` was read: a run with `--level \"{other}\"` reads that one",
                levels.len(),
                levels.join(", ")
            );
            self.notes.push(note("one_level", message));
        }
        let here = |level: &Option<String>| level.as_ref().is_none_or(|l| *l == chosen);
        self.rooms.retain(|r| here(&r.level));
        self.walls.retain(|w| here(&w.level));
        self.openings.retain(|o| here(&o.level));
        self.labels.retain(|l| here(&l.level));
        self.floors.retain(|f| here(&f.level));
        Ok(())
    }
}
