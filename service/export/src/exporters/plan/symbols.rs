//! Top views of objects: one function per build, as an architect would draw them.

mod halls;
mod machines;
mod sanitary;
mod seats;
mod storage;
mod tables;

use d3dgen_model::domain::{Mount, Shape};

use super::pen::Pen;

/// Height above which a wall thing is above the cut of the plan and drawn dashed, m.
const CUT_M: f64 = 1.4;

/// Draws the symbol of a build.
pub(super) fn draw(shape: Shape, underside_m: f64, pen: &mut Pen<'_>) {
    match pen.mount {
        Mount::Ceiling => overhead(pen),
        // Thin things on walls show as a line; deep ones above the cut as a dashed outline.
        Mount::Wall if underside_m > CUT_M && pen.d > 0.15 => pen.outline("h", 0.0),
        Mount::Wall if pen.d < 0.15 && shape != Shape::Curtain => pen.outline("s", 0.0),
        _ => symbol_of(shape)(pen),
    }
}

/// A lamp or machine on the ceiling: its dashed outline.
fn overhead(pen: &mut Pen<'_>) {
    let (u, v) = pen.half();
    if (u - v).abs() < 0.15 * u.max(v) {
        pen.circle("h", (0.0, 0.0), u.min(v));
    } else {
        pen.outline("h", 0.02);
    }
}

fn symbol_of(shape: Shape) -> fn(&mut Pen<'_>) {
    match shape {
        Shape::Box => storage::plain,
        Shape::Cabinet => storage::cabinet,
        Shape::Shelf => storage::shelf,
        Shape::Rack => storage::rack,
        Shape::Trolley => storage::trolley,
        Shape::Table => tables::table,
        Shape::RoundTable => tables::round_table,
        Shape::Desk => tables::desk,
        Shape::Counter => tables::counter,
        Shape::Chair => seats::chair,
        Shape::SwivelChair => seats::swivel_chair,
        Shape::Stool => seats::stool,
        Shape::Sofa => seats::sofa,
        Shape::Bench => seats::bench,
        Shape::Bed => seats::bed,
        Shape::HospitalBed => seats::hospital_bed,
        Shape::Sink => sanitary::sink,
        Shape::Basin => sanitary::basin,
        Shape::Toilet => sanitary::toilet,
        Shape::Bathtub => sanitary::bathtub,
        Shape::Shower => sanitary::shower,
        Shape::Cubicle => sanitary::cubicle,
        Shape::Panel => machines::panel,
        Shape::Pole => machines::pole,
        Shape::Plant => machines::plant,
        Shape::Lamp => machines::lamp,
        Shape::Appliance => machines::appliance,
        Shape::Stove => machines::stove,
        Shape::Rug => machines::rug,
        Shape::Curtain => machines::curtain,
        Shape::Dock => machines::dock,
        Shape::Cylinder => machines::cylinder,
        Shape::Vehicle => machines::vehicle,
        Shape::Scanner => machines::scanner,
        Shape::Stairs => storage::stairs,
        Shape::Pool => halls::pool,
        Shape::Track => halls::track,
        Shape::Stall => halls::stall,
    }
}
