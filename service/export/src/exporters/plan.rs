//! An architect's plan as `plan.svg`, `plan.png` and `plan.pdf`, and as `plan.dxf` for CAD programs.
//!
//! The picture is drawn once as SVG: walls with thickness, door swings, windows, furniture symbols, room names with net
//! areas, robot zones, dimensions, title block and legend. All type is outlines, so it looks the same everywhere. PNG and
//! PDF are that SVG rendered; the DXF has the same parts at full size, on layers.

mod building;
mod dimensions;
mod dxf;
mod labels;
mod page;
mod panel;
mod pdf;
mod pen;
mod robots;
mod storeys;
mod style;
mod symbols;
mod ways;

use d3dgen_model::domain::{Domain, Mount, Shape, Zone};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::geometry::{Point, Pose, Rect};
use d3dgen_model::placements::Placement;
use d3dgen_model::scenario::RoiKind;
use d3dgen_model::world::World;
use resvg::{tiny_skia, usvg};

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::subject::Subject;
use building::Sides;
use dimensions::Dimensions;
use page::{Frame, Page, Path};

/// Sheet width aimed for, sheet units.
const WIDTH: f64 = 2000.0;
/// Height of the drawing aimed for, sheet units.
const HEIGHT: f64 = 1240.0;
/// Distance of the frame from the edge of the sheet.
const EDGE: f64 = 28.0;
/// Free space between frame, drawing and title block.
const GAP: f64 = 44.0;
/// Scale limits, sheet units per meter: small flats are not blown up, large halls stay legible.
const SCALES: [f64; 2] = [26.0, 112.0];
/// Scale below which small rooms lose their names and the sheet grows instead, sheet units per meter.
const LEGIBLE: f64 = 46.0;
/// Width limits of the PNG, px.
const PNG_WIDTHS: [f64; 2] = [1600.0, 2400.0];

/// How much it hurts where a name lies on the swing of a door, a robot's zone, a rug or a lamp, as labels weigh it.
const ON_SWING: u32 = 8;
const ON_ZONE: u32 = 3;
const ON_RUG: u32 = 1;

/// Type size of dimensions and entrances, sheet units.
const UNIT: f64 = 16.0;

/// Writes the plan.
pub struct Plan;

impl Exporter for Plan {
    fn name(&self) -> &'static str {
        "plan"
    }

    fn about(&self) -> &'static str {
        "an architect's plan to look at, to print to scale and for CAD: plan.svg, plan.png, plan.pdf and plan.dxf"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["plan.dxf", "plan.pdf", "plan.png", "plan.svg"]
    }

    fn is_usual(&self) -> bool {
        true
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        files(subject.world, subject.domain, true)
    }
}

/// Returns the files of the plan, sorted by path, with or without the picture that takes longer than all the rest.
///
/// # Errors
/// `Picture` when a renderer refuses the SVG: a bug of ours.
pub fn files(world: &World, domain: &Domain, with_png: bool) -> Result<Vec<File>, Error> {
    let svg = svg(world, domain);
    let drawn = parsed(&svg, "plan.pdf")?;
    let (laid_out, storeys) = storeys::laid_out(world, (0.0, 0.0));
    let mut files = vec![
        File::new("plan.dxf", dxf::dxf(&laid_out, domain, &storeys)),
        File::new("plan.pdf", pdf::pdf(&drawn, &panel::title(world, domain))?),
    ];
    if with_png {
        files.push(File::new("plan.png", rendered(&svg, &drawn)?));
    }
    files.push(File::new("plan.svg", svg));
    Ok(files)
}

/// How legible a drawing's labels are.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Legibility {
    /// Rooms.
    pub rooms: usize,
    /// Rooms that have only a number in the drawing and their name in the list beside it.
    pub numbered: usize,
    /// What all labels take, m^2 of the building.
    pub labels_m2: f64,
    /// The part of it that lies on furniture, m^2; rugs and what hangs over head are none.
    pub on_furniture_m2: f64,
    /// The part of it where leaves of doors swing, m^2.
    pub on_swings_m2: f64,
}

impl Legibility {
    fn of(labels: &labels::Labels, furniture: &[Rect], swings: &[Rect], scale: f64) -> Self {
        let m2 = |units: f64| units / (scale * scale);
        let covered = |on: &[Rect]| labels.boxes.iter().map(|b| covered(b, on)).sum::<f64>();
        Self {
            rooms: labels.boxes.len(),
            numbered: labels.numbers.iter().flatten().count(),
            labels_m2: m2(labels.boxes.iter().map(Rect::area).sum()),
            on_furniture_m2: m2(covered(furniture)),
            on_swings_m2: m2(covered(swings)),
        }
    }
}

/// Returns how much of a rectangle others cover, what several cover once.
fn covered(b: &Rect, others: &[Rect]) -> f64 {
    let clip = |r: &Rect| Rect { x0: r.x0.max(b.x0), y0: r.y0.max(b.y0), x1: r.x1.min(b.x1), y1: r.y1.min(b.y1) };
    let parts: Vec<Rect> = others.iter().filter(|r| r.overlaps(b)).map(clip).collect();
    let mut xs: Vec<f64> = parts.iter().flat_map(|p| [p.x0, p.x1]).collect();
    xs.sort_by(f64::total_cmp);
    let mut area = 0.0;
    for pair in xs.windows(2).filter(|pair| pair[0] < pair[1]) {
        let mut spans: Vec<(f64, f64)> =
            parts.iter().filter(|p| p.x0 <= pair[0] && pair[1] <= p.x1).map(|p| (p.y0, p.y1)).collect();
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut reached = f64::MIN;
        for (from, to) in spans {
            area += (pair[1] - pair[0]) * (to - from.max(reached)).max(0.0);
            reached = reached.max(to);
        }
    }
    area
}

/// Returns how legible the labels of a world's plan are.
pub fn legibility(world: &World, domain: &Domain) -> Legibility {
    draw(world, domain).1
}

/// Returns the plan as SVG.
pub fn svg(world: &World, domain: &Domain) -> String {
    draw(world, domain).0
}

fn draw(world: &World, domain: &Domain) -> (String, Legibility) {
    let size = building::outer_bounds(&world.floorplan);
    let Placed { world: laid_out, storeys, around, scale, margins, beside } = placed(world);
    let world = &laid_out;
    let plan = &world.floorplan;
    let k = (scale / 55.0).clamp(0.7, 1.15);
    let frame =
        Frame { scale, origin: Point::new(around.x0, around.y1), at: (EDGE + margins.west, EDGE + margins.north) };
    let on_sheet = frame.rect(&around);
    let drawing = Rect { x0: EDGE, y0: EDGE, x1: on_sheet.x1 + margins.east, y1: on_sheet.y1 + margins.south };

    let mut page = Page::new();
    let (mut numbers, mut legible) = (Vec::new(), Legibility::default());
    let block = page.block(|page| {
        let shown = Shown::of(world, domain);
        building::floors(page, &frame, plan, domain);
        if !world.scenario.robots.is_empty() {
            robots::zones(page, &frame, &world.scenario, k);
        }
        furniture(page, &frame, &shown);
        building::walls(page, &frame, plan, domain);
        building::windows(page, &frame, plan, domain);
        building::doors(page, &frame, plan);
        building::entrances(page, &frame, plan, UNIT);
        storeys::elevators(page, &frame, plan);
        page.open_group("dimensions");
        for floor in floors(plan, &storeys) {
            Dimensions::of(floor, scale, UNIT).draw(page, &frame, UNIT);
        }
        page.close_group();
        storeys::titles(page, &frame, plan, &storeys, UNIT);
        let marks = robots::marks(page, &frame, &world.scenario, 17.0 * k.max(0.85));
        (numbers, legible) = label(page, &frame, (world, domain), &shown, marks, 18.0 * k.clamp(0.8, 1.1));
        drawing.y1
    });
    let facts = panel::Facts { world, domain, numbers: &numbers, around: &size, scale, k };
    let (width, height) = facts.draw(&mut page, &drawing, beside);
    // A title block larger than the drawing leaves space around it: the drawing stands in its middle.
    let spare = if beside { (0.0, height - EDGE - drawing.y1) } else { (width - EDGE - drawing.x1, 0.0) };
    page.place(&block, (spare.0.max(0.0) / 2.0, spare.1.max(0.0) / 2.0));
    let border = Rect { x0: EDGE, y0: EDGE, x1: width - EDGE, y1: height - EDGE };
    page.path("fr", Path::new().rect(&border));
    let paper = panel::paper(width, height, scale);
    let title = panel::title(world, domain);
    let svg = page.finish((width, height), (paper.width_mm, paper.height_mm), &title, &style::sheet(k));
    (svg, legible)
}

/// Returns the scale of the drawing, sheet units per meter; large buildings get a larger sheet.
fn scale(around: &Rect, panel_width: f64) -> f64 {
    let fit = |width: f64, height: f64| {
        let taken = 2.0 * (EDGE + GAP) + 120.0;
        ((width - taken - panel_width) / around.width()).min((height - taken) / around.height())
    };
    let usual = fit(WIDTH, HEIGHT);
    let scale = if usual < LEGIBLE { fit(1.2 * WIDTH, 1.6 * HEIGHT).min(LEGIBLE) } else { usual };
    scale.clamp(SCALES[0], SCALES[1])
}

/// A world as it comes onto its sheet.
struct Placed {
    /// Its storeys beside each other.
    world: World,
    storeys: Vec<storeys::Storey>,
    /// Outer faces of all of it, m.
    around: Rect,
    /// Sheet units per meter.
    scale: f64,
    /// Free space around it, sheet units.
    margins: Sides<f64>,
    /// True where the title block stands right of the drawing, not below it.
    beside: bool,
}

/// Finds the scale, and how far storeys are apart so that their dimensions and titles find place between them.
fn placed(world: &World) -> Placed {
    let mut apart = (0.0, 0.0);
    loop {
        let (laid_out, storeys) = storeys::laid_out(world, apart);
        let around = building::outer_bounds(&laid_out.floorplan);
        let beside = around.width() < 1.5 * around.height();
        // The drawing's scale follows from the sheet; weights and type follow from the scale, within limits.
        let scale = scale(&around, if beside { panel::WIDTH + GAP } else { 0.0 });
        let mut margins = Sides { west: 0.0, east: 0.0, north: 0.0, south: 0.0 };
        for floor in floors(&laid_out.floorplan, &storeys) {
            let own = self::margins(floor, &building::outer_bounds(floor), scale);
            margins = margins.max(own);
        }
        if !storeys.is_empty() {
            margins.north += 3.0 * UNIT;
        }
        let needed = ((margins.west + margins.east) / scale, (margins.north + margins.south) / scale);
        // a wider sheet has a smaller scale, which needs more meters between storeys
        if storeys.is_empty() || needed.0 <= apart.0 && needed.1 <= apart.1 {
            return Placed { world: laid_out, storeys, around, scale, margins, beside };
        }
        apart = (1.02 * needed.0.max(apart.0), 1.02 * needed.1.max(apart.1));
    }
}

/// Returns the plan of each storey where it is on the sheet.
fn floors<'a>(plan: &'a Floorplan, storeys: &'a [storeys::Storey]) -> Vec<&'a Floorplan> {
    if storeys.is_empty() { vec![plan] } else { storeys.iter().map(|s| &s.plan).collect() }
}

/// Returns what a storey's dimensions and the names at its doors take around it, sheet units.
fn margins(plan: &Floorplan, around: &Rect, scale: f64) -> Sides<f64> {
    let doors = building::entrance_sides(plan, around);
    let beyond = building::outward_reach(plan) * scale + 2.4 * UNIT;
    let chains = Dimensions::of(plan, scale, UNIT).bounds().map_or(*around, |b| b.union(around));
    // Beside the building the entrance's name runs outwards, above and below it only takes a line.
    let margin = |chain_m: f64, door: bool, name: f64| {
        let chain = if chain_m > 0.0 { chain_m * scale + 1.6 * UNIT } else { 0.0 };
        chain.max(if door { beyond + name } else { 0.0 }).max(30.0) + GAP * 0.8
    };
    Sides {
        west: margin(around.x0 - chains.x0, doors.west, 3.6 * UNIT),
        east: margin(chains.x1 - around.x1, doors.east, 3.6 * UNIT),
        north: margin(chains.y1 - around.y1, doors.north, UNIT),
        south: margin(around.y0 - chains.y0, doors.south, UNIT),
    }
}

/// Returns the picture of an SVG that [`svg`] made, between 1600 and 2400 px wide.
///
/// # Errors
/// `Picture` when the renderer refuses the SVG: a bug of ours.
pub fn png(svg: &str) -> Result<Vec<u8>, Error> {
    rendered(svg, &parsed(svg, "plan.png")?)
}

fn parsed(svg: &str, picture: &'static str) -> Result<usvg::Tree, Error> {
    let refused = |e: usvg::Error| Error::Picture { picture, reason: e.to_string() };
    usvg::Tree::from_str(svg, &usvg::Options::default()).map_err(refused)
}

fn rendered(svg: &str, tree: &usvg::Tree) -> Result<Vec<u8>, Error> {
    let refused = |reason: String| Error::Picture { picture: "plan.png", reason };
    // The width in millimeters is for print; pixels follow the sheet units in the view box.
    let natural = svg
        .split_once("viewBox=\"0 0 ")
        .and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok())
        .ok_or_else(|| refused("it has no view box".into()))?;
    let width = natural.clamp(PNG_WIDTHS[0], PNG_WIDTHS[1]);
    let zoom = width / f64::from(tree.size().width());
    let (width, height) = (width.round(), (f64::from(tree.size().height()) * zoom).round());
    let mut pixmap = tiny_skia::Pixmap::new(width as u32, height as u32)
        .ok_or_else(|| refused(format!("{width} x {height} px is no size for a picture")))?;
    // The sheet's own background may end within the last row or column of pixels.
    pixmap.fill(tiny_skia::Color::WHITE);
    let transform = tiny_skia::Transform::from_scale(zoom as f32, zoom as f32);
    resvg::render(tree, transform, &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|e| refused(e.to_string()))
}

/// A placement with what its symbol depends on.
struct Thing<'a> {
    placement: &'a Placement,
    shape: Shape,
    layer: Layer,
}

/// From the floor upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Layer {
    Covering,
    Floor,
    Surface,
    Wall,
    Overhead,
}

/// Objects in drawing order.
struct Shown<'a>(Vec<Thing<'a>>);

impl<'a> Shown<'a> {
    fn of(world: &'a World, domain: &Domain) -> Self {
        let mut things: Vec<Thing<'a>> = world
            .placements
            .placements
            .iter()
            .map(|placement| {
                let shape = domain.object(&placement.object).map_or(Shape::Box, |o| o.shape);
                let layer = match placement.mount {
                    Mount::Floor if placement.top_m() < 0.05 => Layer::Covering,
                    Mount::Floor => Layer::Floor,
                    Mount::Surface => Layer::Surface,
                    Mount::Wall => Layer::Wall,
                    Mount::Ceiling => Layer::Overhead,
                };
                Thing { placement, shape, layer }
            })
            .collect();
        // Chairs slide under tables: lower things first.
        things.sort_by(|a, b| {
            let key = |t: &Thing<'_>| (t.layer, (t.placement.top_m() * 1000.0).round() as i64);
            key(a).cmp(&key(b))
        });
        Self(things)
    }
}

fn furniture(page: &mut Page, frame: &Frame, shown: &Shown<'_>) {
    page.open_group("furniture");
    for thing in &shown.0 {
        let mut pen = pen::Pen::new(page, frame, thing.placement);
        symbols::draw(thing.shape, thing.placement.pose.z, &mut pen);
    }
    page.close_group();
}

/// Names the rooms; returns each one's number where there was no space for its name, and how legible the names are.
fn label(
    page: &mut Page,
    frame: &Frame,
    (world, domain): (&World, &Domain),
    shown: &Shown<'_>,
    marks: Vec<Rect>,
    size: f64,
) -> (Vec<Option<usize>>, Legibility) {
    let plan = &world.floorplan;
    let swings = building::swings(frame, plan);
    let mut furniture = Vec::new();
    let mut soft: Vec<(Rect, u32)> = swings.iter().map(|r| (*r, ON_SWING)).collect();
    for thing in &shown.0 {
        let rect = frame.rect(&thing.placement.footprint().bounds());
        match thing.layer {
            Layer::Overhead => soft.push((rect, ON_RUG)),
            Layer::Covering if thing.shape == Shape::Rug => soft.push((rect, ON_RUG)),
            Layer::Covering | Layer::Floor | Layer::Surface | Layer::Wall => furniture.push(rect),
        }
    }
    // Type across the edge of a small zone is hard to read; zones as large as their room cannot be avoided.
    let is_small =
        |kind: RoiKind| matches!(kind, RoiKind::ServiceZone | RoiKind::ChargingBuffer | RoiKind::StagingArea);
    let small = world.scenario.rois.iter().filter(|r| is_small(r.kind));
    soft.extend(small.map(|r| (frame.rect(&r.polygon.bounds()), ON_ZONE)));
    let courts = building::courts(plan);
    let courts = courts.iter().map(|court| labels::Room {
        name: "Courtyard",
        tint: style::tint(Zone::Outdoor),
        area_m2: court.area_m2(),
        floor: court.rects.iter().map(|rect| frame.rect(rect)).collect(),
    });
    let named = ways::named(plan);
    let rooms: Vec<labels::Room<'_>> = named
        .iter()
        .map(|named| labels::Room {
            name: &named.name,
            tint: style::tint(domain.room_type_or_generic(&named.rooms[0].room_type).zone),
            area_m2: named.area_m2(),
            floor: named.rooms.iter().flat_map(|r| r.net_polygon.rects()).map(|rect| frame.rect(&rect)).collect(),
        })
        .chain(courts)
        .collect();
    let hard = [marks, furniture.clone()].concat();
    let labels = labels::draw(page, &rooms, &labels::Obstacles { hard, soft }, size);
    let legible = Legibility::of(&labels, &furniture, &swings, frame.scale);
    let mut numbers = vec![None; plan.rooms.len()];
    named.iter().zip(labels.numbers).for_each(|(named, number)| numbers[named.pieces[0]] = number);
    (numbers, legible)
}

fn at(pose: &Pose) -> Point {
    Point::new(pose.x, pose.y)
}

#[cfg(test)]
mod tests;
