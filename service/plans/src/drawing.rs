//! What every reader makes of its file: rooms, walls, openings and labels in meters, x east and y north.
//!
//! Nothing here is checked: outlines may cross, overlap, lean; `layout` judges them.

use std::collections::BTreeMap;

use d3dgen_model::Point;
use d3dgen_model::scene_graph::Note;

use crate::error::Error;

/// Most points of one file; larger drawings are not floor plans.
pub(crate) const MOST_POINTS: usize = 200_000;
/// Most layers that a note of what was left out names.
const MOST_UNREAD: usize = 12;
/// Coordinates beyond this are slips, m.
const FARTHEST_M: f64 = 1e9;

/// A plan as drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Drawing {
    /// Closed outlines of rooms.
    pub rooms: Vec<DrawnRoom>,
    /// Walls as lines; rooms are what they enclose where no outlines are drawn.
    pub walls: Vec<DrawnWall>,
    /// Doors, passages, windows.
    pub openings: Vec<DrawnOpening>,
    /// Closed shapes that may be rooms: `evidence` decides.
    pub shapes: Vec<DrawnShape>,
    /// Shapes that are rooms only where walls enclose none.
    pub unclear: Vec<DrawnShape>,
    /// Lines that are walls only where no layer says that it has any, with what is said when they are left out.
    pub perhaps_walls: Vec<(String, DrawnWall)>,
    /// Columns and walls that stand free.
    pub solids: Vec<DrawnSolid>,
    /// Words on the plan.
    pub labels: Vec<DrawnLabel>,
    /// Floors that walls stand on: they bound rooms where no wall is drawn.
    pub floors: Vec<DrawnFloor>,
    /// Cars of lifts, one for each storey that they stop at.
    pub cabins: Vec<DrawnCabin>,
    /// Heights of the floors of storeys, m, by their names.
    pub elevations_m: BTreeMap<String, f64>,
    /// What the file calls the building.
    pub titles: Vec<String>,
    /// What was left out because nothing says what it is (`layer A-XYZ`), and how many shapes.
    pub unread: BTreeMap<String, usize>,
    /// What was left out because it is no part of the building (furniture, symbols), and how many shapes.
    pub skipped: BTreeMap<String, usize>,
    /// What is drawn at all: kinds of shapes by their layers, and how many.
    pub layers: BTreeMap<String, BTreeMap<String, usize>>,
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

/// How sure a closed shape is a room, from the least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Evidence {
    /// Nothing says so.
    None,
    /// A name stands in it.
    Text,
    /// It lies on a layer of walls.
    Wall,
    /// It has a name itself.
    Named,
    /// Its layer says so, or the user.
    Room,
}

/// A closed shape that may be a room.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnShape {
    /// The room that it would be.
    pub room: DrawnRoom,
    /// What says that it is one.
    pub evidence: Evidence,
    /// Layer, as messages name it.
    pub layer: String,
    /// Kind of shape, as the file calls it.
    pub kind: String,
    /// True for circles and the like, which are no rooms.
    pub curved: bool,
}

impl DrawnShape {
    /// Returns what is said of it when it is left out.
    pub(crate) fn told(&self) -> String {
        format!("{} as {}", self.layer, self.kind)
    }
}

/// Something that stands from floor to ceiling and bounds no room.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnSolid {
    /// What it is.
    pub kind: SolidKind,
    /// Corners in either sense, m.
    pub outline: Vec<Point>,
    /// Storey.
    pub level: Option<String>,
    /// Where it stands in the file, for messages.
    pub place: String,
}

/// What stands free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SolidKind {
    /// A column or pillar.
    Column,
    /// A piece of wall.
    Wall,
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

/// The car of a lift on one storey.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnCabin {
    /// Name of the lift.
    pub name: String,
    /// Corners in order, m.
    pub corners: [Point; 4],
    /// Ends of its doors on this storey, m.
    pub doors: Vec<[Point; 2]>,
    /// Storey.
    pub level: Option<String>,
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

/// Returns the least x and y and the greatest x and y of points, or `None` without any.
pub(crate) fn extent(points: impl IntoIterator<Item = Point>) -> Option<[f64; 4]> {
    let each = points.into_iter().map(|p| [p.x, p.y, p.x, p.y]);
    each.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])])
}

/// Returns counted things as a list, the most of them first; `None` without any.
fn listed(counts: &BTreeMap<String, usize>) -> Option<String> {
    let mut all: Vec<(&String, &usize)> = counts.iter().collect();
    all.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let more = all.len().saturating_sub(MOST_UNREAD);
    let more = if more > 0 { format!(", and {more} more") } else { String::new() };
    let list: Vec<String> = all.iter().take(MOST_UNREAD).map(|(what, count)| format!("{what} ({count})")).collect();
    (!list.is_empty()).then(|| list.join(", ") + &more)
}

impl Drawing {
    /// Counts a shape that is left out.
    pub(crate) fn leave_out(&mut self, what: impl Into<String>) {
        *self.unread.entry(what.into()).or_default() += 1;
    }

    /// Counts what is no part of the building.
    pub(crate) fn skip(&mut self, what: impl Into<String>) {
        *self.skipped.entry(what.into()).or_default() += 1;
    }

    /// Counts a shape of a layer, whatever becomes of it.
    pub(crate) fn saw(&mut self, layer: &str, kind: &str) {
        *self.layers.entry(layer.to_owned()).or_default().entry(kind.to_owned()).or_default() += 1;
    }

    /// Notes what was left out, the most of it first.
    pub(crate) fn tell_of_unread(&mut self) {
        if let Some(list) = listed(&std::mem::take(&mut self.unread)) {
            let message = format!(
                "nothing says that these are part of the building: {list}; left out, words such as wall, door, window or room \
                 would say it, or --layer \"NAME=wall\""
            );
            self.notes.push(note("not_understood", message));
        }
        if let Some(list) = listed(&std::mem::take(&mut self.skipped)) {
            self.notes.push(note("left_out", format!("furniture, symbols and the like were left out: {list}")));
        }
    }

    /// Returns the layers there are with what is drawn on them, for a drawing in which nothing encloses a room; empty for files
    /// without layers.
    pub(crate) fn tell_of_layers(&self) -> String {
        let kinds = |kinds: &BTreeMap<String, usize>| {
            kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect::<Vec<_>>().join(", ")
        };
        let mut all: Vec<(&String, usize)> = self.layers.iter().map(|(l, k)| (l, k.values().sum())).collect();
        all.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let list: Vec<String> =
            all.iter().take(MOST_UNREAD).map(|(l, _)| format!("`{l}` ({})", kinds(&self.layers[*l]))).collect();
        let more = all.len().saturating_sub(MOST_UNREAD);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        match all.first() {
            Some((layer, _)) => format!(
                "; there are the layers {}{more}: say what they are with --layer \"{layer}=wall\" (or room, door, window, column, \
                 furniture, ignore)",
                list.join(", ")
            ),
            None => String::new(),
        }
    }

    /// Returns every point of the drawing.
    pub(crate) fn points_mut(&mut self) -> impl Iterator<Item = &mut Point> {
        self.points_where(|_| true)
    }

    /// Returns every point of one storey.
    pub(crate) fn on_level_mut(&mut self, level: &str) -> impl Iterator<Item = &mut Point> {
        self.points_where(move |l| l.as_deref() == Some(level))
    }

    fn points_where(&mut self, here: impl Fn(&Option<String>) -> bool + Copy) -> impl Iterator<Item = &mut Point> {
        let shapes = self.shapes.iter_mut().chain(&mut self.unclear).map(|s| &mut s.room);
        let rooms = self.rooms.iter_mut().chain(shapes).filter(move |r| here(&r.level));
        let rooms = rooms.flat_map(|r| r.corners.iter_mut().chain(r.holes.iter_mut().flatten()));
        let floors = self.floors.iter_mut().filter(move |f| here(&f.level)).flat_map(|f| f.corners.iter_mut());
        let perhaps = self.perhaps_walls.iter_mut().map(|(_, wall)| wall);
        let walls =
            self.walls.iter_mut().chain(perhaps).filter(move |w| here(&w.level)).flat_map(|w| w.line.iter_mut());
        let solids = self.solids.iter_mut().filter(move |s| here(&s.level)).flat_map(|s| s.outline.iter_mut());
        let openings = self.openings.iter_mut().filter(move |o| here(&o.level));
        let openings = openings.flat_map(|o| o.points.iter_mut().chain(o.arc.iter_mut().flatten()));
        let cabins = self.cabins.iter_mut().filter(move |c| here(&c.level));
        let cabins = cabins.flat_map(|c| c.corners.iter_mut().chain(c.doors.iter_mut().flatten()));
        let labels = self.labels.iter_mut().filter(move |l| here(&l.level)).map(|l| &mut l.at);
        rooms.chain(walls).chain(openings).chain(floors).chain(cabins).chain(labels).chain(solids)
    }

    /// Refuses numbers that are none and drawings beyond any building.
    pub(crate) fn check_numbers(&mut self) -> Result<(), Error> {
        let shapes = self.shapes.iter().map(|s| &s.room);
        let rooms = self
            .rooms
            .iter()
            .chain(shapes)
            .flat_map(|r| r.corners.iter().chain(r.holes.iter().flatten()).map(|p| (p, &r.place)));
        let perhaps = self.perhaps_walls.iter().map(|(_, wall)| wall);
        let walls = self.walls.iter().chain(perhaps).flat_map(|w| w.line.iter().map(|p| (p, &w.place)));
        let solids = self.solids.iter().flat_map(|s| s.outline.iter().map(|p| (p, &s.place)));
        let openings =
            self.openings.iter().flat_map(|o| o.points.iter().chain(o.arc.iter().flatten()).map(|p| (p, &o.place)));
        let labels = self.labels.iter().map(|l| (&l.at, &l.text));
        let floor = "floor".to_owned();
        let floors = self.floors.iter().flat_map(|f| f.corners.iter().map(|p| (p, &floor)));
        let far = |v: f64| !(v.is_finite() && v.abs() < FARTHEST_M);
        let cabins =
            self.cabins.iter().flat_map(|c| c.corners.iter().chain(c.doors.iter().flatten()).map(|p| (p, &c.name)));
        let mut all = rooms.chain(walls).chain(openings).chain(labels).chain(floors).chain(cabins).chain(solids);
        if let Some((p, place)) = all.find(|(p, _)| far(p.x) || far(p.y)) {
            let message = format!("the point ({:e}, {:e}) m is no place in a building", p.x, p.y);
            return Err(Error::refused(place, message));
        }
        let count = self.points_mut().count();
        if count > MOST_POINTS {
            return Err(Error::refused("drawing", format!("has {count} points, at most {MOST_POINTS} are read")));
        }
        Ok(())
    }
}
