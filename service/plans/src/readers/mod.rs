//! One file a format; [`all`] is the list.

mod dxf;
mod floorplan;
mod geojson;
mod imdf;
mod nav2;
mod rmf;
mod source;
mod svg;
mod trace;

use crate::error::Error;
use crate::options::Options;
pub use source::{MOST_BYTES, Plan, Reader, Source};

/// Every reader; the first that recognizes a file reads it.
pub fn all() -> &'static [Reader] {
    &[floorplan::READER, imdf::READER, geojson::READER, svg::READER, dxf::READER, rmf::READER, nav2::READER]
}

/// Reads a plan.
///
/// # Errors
/// `UnknownFormat` with the formats there are; `Broken` with the place in the file; `Refused` for a scale that is missing.
pub fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let known = || all().iter().map(|r| r.name).collect::<Vec<_>>().join(", ");
    if source.bytes.len() > MOST_BYTES {
        let message = format!("has {} MiB, at most {} MiB are read", source.bytes.len() >> 20, MOST_BYTES >> 20);
        return Err(Error::refused(source.name, message));
    }
    if let Some(m) = options.meters_per_unit.filter(|m| !(m.is_finite() && (1e-7..=1e4).contains(m))) {
        return Err(Error::refused("--meters-per-unit", format!("{m} m is no length of a unit")));
    }
    let reader = match &options.format {
        Some(name) => all().iter().find(|r| r.name == name).ok_or_else(|| {
            Error::UnknownFormat(format!("format `{name}` is not known; plans are read of {}", known()))
        })?,
        None => all().iter().find(|r| (r.recognizes)(source)).ok_or_else(|| {
            let what = foreign(source).map_or("is no plan that is known".to_owned(), |(name, way)| {
                format!("is {name}, which is not read: {way}")
            });
            Error::UnknownFormat(format!("{} {what}; plans are read of {}", source.name, known()))
        })?,
    };
    (reader.read)(source, options)
}

/// A kind of file that people have plans in and that is not read.
struct Foreign {
    /// How its bytes begin; empty where the ending says it.
    head: &'static [u8],
    endings: &'static [&'static str],
    name: &'static str,
    /// How to come by a plan that is read.
    way: &'static str,
}

const FOREIGN: [Foreign; 7] = [
    Foreign {
        head: b"ISO-10303-21",
        endings: &[".ifc", ".ifczip", ".ifcxml"],
        name: "a building model (IFC)",
        way: "export the floor plan of a storey as DXF or SVG (in Bonsai, FreeCAD, Revit or ArchiCAD; `IfcConvert model.ifc \
              plan.svg` does it too), and name the layers of walls and doors so",
    },
    Foreign { head: b"AC10", endings: &[".dwg"], name: "an AutoCAD drawing (DWG)", way: "save it as ASCII DXF" },
    Foreign {
        head: b"%PDF",
        endings: &[".pdf"],
        name: "a PDF",
        way: "open it in Inkscape and save it as SVG, or trace it as DXF",
    },
    Foreign {
        head: b"\x89PNG",
        endings: &[".png", ".jpg", ".jpeg", ".webp", ".gif"],
        name: "a picture",
        way: "draw its walls as SVG or DXF over it; the picture of an occupancy map is read with its map.yaml",
    },
    Foreign { head: b"P5", endings: &[".pgm"], name: "the picture of a map", way: "give the map.yaml beside it" },
    Foreign {
        head: b"\xd0\xcf\x11\xe0",
        endings: &[".rvt", ".rfa", ".pln", ".vsd"],
        name: "a file of a building program (Revit, ArchiCAD, Visio)",
        way: "export the floor plan as DXF",
    },
    Foreign {
        head: b"",
        endings: &[".skp", ".3dm", ".sh3d", ".blend"],
        name: "a 3D model",
        way: "export its floor plan as DXF or SVG",
    },
];

/// Returns what a file is that is not read, and the way round.
fn foreign(source: &Source) -> Option<(&'static str, &'static str)> {
    let known = |f: &&Foreign| !f.head.is_empty() && source.bytes.starts_with(f.head) || source.has_ending(f.endings);
    FOREIGN.iter().find(known).map(|f| (f.name, f.way))
}
