//! Our own floorplan document: kept as it is, and locked.

use d3dgen_model::document::Document;
use d3dgen_model::floorplan::Floorplan;

use super::source::{Plan, Reader, Source};
use crate::error::Error;
use crate::options::Options;

pub(super) const READER: Reader = Reader { name: "floorplan", title: "floorplan.json of d3dgen", recognizes, read };

fn recognizes(source: &Source) -> bool {
    let head = source.head();
    source.has_ending(&[".json"]) && head.contains("\"scheme\"") && head.contains("\"rooms\"")
}

fn read(source: &Source, _: &Options) -> Result<Plan, Error> {
    let mut plan = Floorplan::from_json(source.text("floorplan")?)
        .map_err(|e| Error::broken("floorplan", "document", e.to_string()))?;
    plan.scheme = Floorplan::GIVEN.into();
    plan.rooms.iter_mut().for_each(|r| r.locked = true);
    plan.walls.iter_mut().for_each(|w| w.locked = true);
    plan.doors.iter_mut().for_each(|d| d.locked = true);
    plan.windows.iter_mut().for_each(|w| w.locked = true);
    plan.obstacles.iter_mut().for_each(|o| o.locked = true);
    if plan.rooms.is_empty() {
        return Err(Error::broken("floorplan", "/rooms", "is empty; a plan needs at least one room"));
    }
    Ok(Plan::Document(plan))
}
