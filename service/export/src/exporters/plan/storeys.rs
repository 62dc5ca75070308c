//! Several storeys on one sheet: side by side, each with its title.

use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::geometry::{Point, Pose, Rect, to_mm};
use d3dgen_model::storeys::LinkKind;
use d3dgen_model::world::World;

use super::building::outer_bounds;
use super::dimensions::Dimensions;
use super::page::{Anchor, Frame, Page, Path};
use super::style;

/// Least space between two storeys, m.
const BETWEEN_M: f64 = 3.5;
/// Width over height that a sheet of several storeys should have.
const SHEET: f64 = 1.7;

/// How far from the top of a storey a door is at its top, m, and how far a name at a door reaches to each side, in units of type.
const AT_TOP_M: f64 = 0.5;
const DOOR_NAME: f64 = 3.0;

/// A storey on the sheet.
pub(super) struct Storey {
    pub title: String,
    /// Outer faces of its walls, m.
    pub around: Rect,
    /// Its plan alone, where it is on the sheet.
    pub plan: Floorplan,
}

/// Returns a world of one storey as it is, one of several with its storeys beside each other, so far apart across and along,
/// m, or further.
pub(super) fn laid_out(world: &World, apart: (f64, f64)) -> (World, Vec<Storey>) {
    let levels = world.floorplan.level_numbers();
    if levels.len() < 2 {
        return (world.clone(), Vec::new());
    }
    let whole = outer_bounds(&world.floorplan);
    let (w, h) = (whole.width() + apart.0.max(BETWEEN_M), whole.height() + apart.1.max(BETWEEN_M));
    // as many in a row as make the sheet's shape
    let shape = |columns: usize| {
        let rows = levels.len().div_ceil(columns);
        let ratio = columns as f64 * w / (rows as f64 * h);
        // places left over look forgotten
        let left = (rows * columns - levels.len()) as f64;
        (ratio / SHEET).max(SHEET / ratio) * (1.0 + 0.3 * left)
    };
    let columns = (1..=levels.len()).min_by(|a, b| shape(*a).total_cmp(&shape(*b))).unwrap_or(1);
    let rows = levels.len().div_ceil(columns);
    let mut out: Option<World> = None;
    let mut titles = Vec::new();
    for (i, &level) in levels.iter().enumerate() {
        // the lowest storey comes first, as one reads
        let (column, row) = (i % columns, rows - 1 - i / columns);
        let by = (column as f64 * w, row as f64 * h);
        let mut storey = world.storey(level);
        flights_from_below(&mut storey, world);
        let storey = moved(storey, by);
        let rooms = storey.floorplan.rooms.iter().filter(|r| !r.circulation).count();
        let title = match level {
            0 => format!("Ground floor, {rooms} rooms"),
            l if l < 0 => format!("Basement {}, {rooms} rooms", -l),
            l => format!("Level {l}, {rooms} rooms"),
        };
        let around = Rect { y1: whole.y1 + by.1, ..outer_bounds(&storey.floorplan) };
        titles.push(Storey { title, around, plan: storey.floorplan.clone() });
        match &mut out {
            None => out = Some(storey),
            Some(all) => join(all, storey),
        }
    }
    let mut out = out.unwrap_or_else(|| world.clone());
    out.scene_graph = world.scene_graph.clone();
    (out, titles)
}

/// Adds to the highest storey the flights that come up to it, which one sees from there.
fn flights_from_below(storey: &mut World, world: &World) {
    for link in world.floorplan.links.iter().filter(|l| l.kind == LinkKind::Stairs) {
        let [.., below, top] = link.room_ids.as_slice() else { continue };
        let Some(flights) = world.placements.placements.iter().find(|p| &p.room_id == below) else { continue };
        if storey.floorplan.room(top).is_some() {
            let mut flights = flights.clone();
            flights.room_id.clone_from(top);
            flights.placement_id.push_str("_from_above");
            storey.placements.placements.push(flights);
        }
    }
}

fn join(all: &mut World, storey: World) {
    let (plan, other) = (&mut all.floorplan, storey.floorplan);
    plan.rooms.extend(other.rooms);
    plan.walls.extend(other.walls);
    plan.doors.extend(other.doors);
    plan.windows.extend(other.windows);
    all.placements.placements.extend(storey.placements.placements);
    let (scenario, other) = (&mut all.scenario, storey.scenario);
    scenario.rois.extend(other.rois);
    scenario.pois.extend(other.pois);
    scenario.robots.extend(other.robots);
    scenario.agents.extend(other.agents);
}

fn moved(mut world: World, (dx, dy): (f64, f64)) -> World {
    let point = |p: &mut Point| *p = Point::new(to_mm(p.x + dx), to_mm(p.y + dy));
    let pose = |p: &mut Pose| (p.x, p.y) = (to_mm(p.x + dx), to_mm(p.y + dy));
    world.floorplan = world.floorplan.moved(dx, dy);
    world.placements.placements.iter_mut().for_each(|p| pose(&mut p.pose));
    world.scenario.rois.iter_mut().flat_map(|r| &mut r.polygon.0).for_each(point);
    world.scenario.pois.iter_mut().for_each(|p| pose(&mut p.pose));
    world.scenario.robots.iter_mut().for_each(|r| pose(&mut r.start));
    world.scenario.agents.iter_mut().for_each(|a| pose(&mut a.start));
    world
}

/// Draws a cross over each elevator, as architects do.
pub(super) fn elevators(page: &mut Page, frame: &Frame, plan: &Floorplan) {
    let ids = plan.links.iter().filter(|l| l.kind == LinkKind::Elevator).flat_map(|l| &l.room_ids);
    let rooms: Vec<Rect> =
        ids.filter_map(|id| plan.room(id)).map(|r| frame.rect(&r.net_polygon.bounds().grown(-0.1))).collect();
    if rooms.is_empty() {
        return;
    }
    page.open_group("elevators");
    for r in rooms {
        let cross = Path::new().segment((r.x0, r.y0), (r.x1, r.y1)).segment((r.x0, r.y1), (r.x1, r.y0));
        page.path("f", cross.rect(&r));
    }
    page.close_group();
}

/// Writes the title of each storey above it and its dimensions, beside what is written at the doors there.
pub(super) fn titles(page: &mut Page, frame: &Frame, plan: &Floorplan, storeys: &[Storey], size: f64) {
    for storey in storeys {
        let chains = Dimensions::of(&storey.plan, frame.scale, size).bounds();
        let above = chains.map_or(0.0, |b| (b.y1 - storey.around.y1).max(0.0) * frame.scale + size);
        let r = frame.rect(&storey.around);
        let width = page.font(style::HEADING.weight).width(&storey.title, 1.5 * size);
        let doors: Vec<f64> = plan
            .ways_out()
            .into_iter()
            .map(|door| door.line.middle())
            .filter(|at| (at.y - storey.around.y1).abs() < AT_TOP_M)
            .map(|at| frame.map(at).0)
            .filter(|x| (r.x0..=r.x1).contains(x))
            .collect();
        let x = beside(r.x0, width, &doors, DOOR_NAME * size);
        page.text(&storey.title, (x, r.y0 - above - 1.1 * size), 1.5 * size, style::HEADING, Anchor::Start);
    }
}

/// Returns where a text so wide begins, from `first` on, that keeps so far from some places.
fn beside(first: f64, width: f64, places: &[f64], away: f64) -> f64 {
    let clear = |x: &f64| places.iter().all(|at| at + away <= *x || x + width <= at - away);
    let starts = std::iter::once(first).chain(places.iter().map(|at| at + away));
    starts.filter(clear).reduce(f64::min).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::beside;

    #[test]
    fn a_title_stands_beside_the_names_of_doors() {
        assert_eq!(beside(10.0, 100.0, &[], 20.0), 10.0);
        assert_eq!(beside(10.0, 100.0, &[50.0], 20.0), 70.0);
        assert_eq!(beside(10.0, 100.0, &[50.0, 120.0], 20.0), 140.0);
        assert_eq!(beside(10.0, 100.0, &[200.0], 20.0), 10.0);
    }
}
