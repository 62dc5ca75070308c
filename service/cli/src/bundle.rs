//! The folder of a world: its documents, report and files in other formats.

use d3dgen_model::document::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::report::Report;
use d3dgen_model::world::World;

use crate::commands::Formats;
use crate::error::Error;
use crate::output::Output;

/// Writes the folder; of an unsound world only the report and the documents of the stages, unless a brought plan
/// is all that is wrong with it.
///
/// # Errors
/// `Write`, `Export`, or `Interrupted` between two formats.
pub fn write(world: &World, report: &Report, domain: &Domain, formats: &Formats, output: &Output) -> Result<(), Error> {
    write_documents(world, report, output)?;
    if report.is_writable() {
        formats.write(world, domain, output)?;
    }
    Ok(())
}

/// Writes the documents of the folder; of an unsound world not the world itself, unless only a brought plan is to blame.
///
/// # Errors
/// `Write`.
pub fn write_documents(world: &World, report: &Report, output: &Output) -> Result<(), Error> {
    output.write("report.json", report.to_json().as_bytes())?;
    if let Some(brief) = &world.brief {
        output.write("brief.json", brief.to_json().as_bytes())?;
    }
    output.write("scene_graph.json", world.scene_graph.to_json().as_bytes())?;
    output.write("floorplan.json", world.floorplan.to_json().as_bytes())?;
    output.write("placements.json", world.placements.to_json().as_bytes())?;
    output.write("scenario.json", world.scenario.to_json().as_bytes())?;
    if report.is_writable() {
        output.write("world.json", world.to_json().as_bytes())?;
    }
    Ok(())
}
