//! Simple models of objects: one function per build, each a short list of boxes, cylinders and spheres.
//!
//! Frame of a model: x to the right of somebody who looks at its front, the front at -y, z up, origin in the middle of
//! the footprint on the underside. The parts fill the bounding box `width x depth x height` exactly.

mod beds;
mod body;
mod machines;
mod sanitary;
mod seats;
mod storage;
mod tables;

use d3dgen_model::domain::Shape;

use crate::color::Rgb;
use body::Body;

/// One primitive with its color role.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Geometry, m.
    pub solid: Solid,
    /// Color role.
    pub tone: Tone,
}

/// A primitive, m.
#[derive(Debug, Clone, PartialEq)]
pub enum Solid {
    /// An upright box between two corners.
    Box {
        /// Least x, y, z.
        min: [f64; 3],
        /// Largest x, y, z.
        max: [f64; 3],
    },
    /// A round bar.
    Cylinder {
        /// Middle of the axis.
        center: [f64; 3],
        /// Radius.
        radius: f64,
        /// Length along the axis.
        length: f64,
        /// Direction.
        axis: Axis,
    },
    /// A ball.
    Sphere {
        /// Middle.
        center: [f64; 3],
        /// Radius.
        radius: f64,
    },
}

/// Direction of a cylinder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Across the front.
    X,
    /// Front to back.
    Y,
    /// Upright.
    Z,
}

/// Color role of a part: how it derives from the object's own color.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tone {
    /// The object's color.
    Main,
    /// A darker shade of it: frames, plinths, joints.
    Dark,
    /// A lighter tint of it: doors, cushions.
    Light,
    /// Legs, rails, taps.
    Metal,
    /// Sheets, paper, enamel.
    White,
    /// Screens, tires, hobs.
    Black,
    /// Foliage.
    Green,
    /// Windows and screens of showers.
    Glass,
}

impl Tone {
    /// Returns the color for an object of this main color.
    pub(crate) fn color(self, main: Rgb) -> Rgb {
        match self {
            Self::Main => main,
            Self::Dark => main.mix(Rgb([0.0; 3]), 0.35),
            Self::Light => main.mix(Rgb([1.0; 3]), 0.35),
            Self::Metal => Rgb([0.6, 0.62, 0.65]),
            Self::White => Rgb([0.95, 0.95, 0.95]),
            Self::Black => Rgb([0.1, 0.1, 0.11]),
            Self::Green => Rgb([0.28, 0.48, 0.24]),
            Self::Glass => Rgb([0.78, 0.88, 0.92]),
        }
    }

    /// Returns the name of its material.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Main => "Main",
            Self::Dark => "Dark",
            Self::Light => "Light",
            Self::Metal => "Metal",
            Self::White => "White",
            Self::Black => "Black",
            Self::Green => "Green",
            Self::Glass => "Glass",
        }
    }
}

impl Solid {
    /// Returns the bounding box: least and largest x, y, z.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        match self {
            Self::Box { min, max } => [*min, *max],
            Self::Cylinder { center, radius, length, axis } => {
                let half = match axis {
                    Axis::X => [length / 2.0, *radius, *radius],
                    Axis::Y => [*radius, length / 2.0, *radius],
                    Axis::Z => [*radius, *radius, length / 2.0],
                };
                around(*center, half)
            }
            Self::Sphere { center, radius } => around(*center, [*radius; 3]),
        }
    }

    /// Returns the middle.
    pub fn center(&self) -> [f64; 3] {
        let [min, max] = self.bounds();
        std::array::from_fn(|i| (min[i] + max[i]) / 2.0)
    }

    /// Returns the extents of the bounding box.
    pub fn size(&self) -> [f64; 3] {
        let [min, max] = self.bounds();
        std::array::from_fn(|i| max[i] - min[i])
    }

    fn volume(&self) -> f64 {
        use std::f64::consts::PI;
        match self {
            Self::Box { .. } => self.size().iter().product(),
            Self::Cylinder { radius, length, .. } => PI * radius * radius * length,
            Self::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
        }
    }
}

fn around(center: [f64; 3], half: [f64; 3]) -> [[f64; 3]; 2] {
    [std::array::from_fn(|i| center[i] - half[i]), std::array::from_fn(|i| center[i] + half[i])]
}

/// Returns the parts of a build at this `[width, depth, height]`, m.
pub fn parts(shape: Shape, size_m: [f64; 3]) -> Vec<Part> {
    let mut body = Body::new(size_m);
    build_of(shape)(&mut body);
    body.finish()
}

fn build_of(shape: Shape) -> fn(&mut Body) {
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
        Shape::Bed => beds::bed,
        Shape::HospitalBed => beds::hospital_bed,
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
    }
}

/// Returns a sensible mass, kg: furniture is mostly hollow, so densities are far below those of the materials.
pub(crate) fn mass_kg(parts: &[Part], material: &str) -> f64 {
    let density_kg_m3 = match material {
        "metal" | "steel" => 180.0,
        "ceramic" | "porcelain" | "stone" | "concrete" => 300.0,
        "glass" => 250.0,
        "fabric" | "plastic" => 60.0,
        _ => 110.0,
    };
    let volume: f64 = parts.iter().map(|p| p.solid.volume()).sum();
    ((volume * density_kg_m3).max(0.05) * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests;
