//! Scenarios that are moved, as archives.

use std::sync::atomic::AtomicBool;

use d3dgen_crowd::{Options, simulate};
use d3dgen_export::film;
use d3dgen_model::world::World;
use tonic::Status;

use super::go_on;
use crate::core::Core;
use crate::grpc::domain::plugin;
use crate::status::{self, invalid};

/// Length where none is said, s.
pub(super) const USUAL_S: f64 = 600.0;

/// Returns the files of a scenario that is moved, by path.
///
/// # Errors
/// `INVALID_ARGUMENT` for a time that is none and a scenario without anybody; `CANCELLED` once nobody waits for it.
pub(super) fn files(
    core: &Core,
    world: &World,
    options: Options,
    with_film: bool,
    stop: &AtomicBool,
) -> Result<Vec<(String, Vec<u8>)>, Status> {
    let now = core.domains.now();
    let plugin = plugin(&now, "world.scene_graph.domain", &world.scene_graph.domain)?;
    let run = simulate(world, plugin.domain(), options, &mut |_| go_on(stop).is_ok()).map_err(refused);
    go_on(stop)?;
    let run = run?;
    let mut files = vec![
        ("trajectory.json".to_owned(), json(&run.trajectory)?),
        ("walkable.geojson".to_owned(), json(&run.walkable)?),
        ("metrics.json".to_owned(), json(&run.metrics)?),
    ];
    if with_film {
        files.push(("crowd.png".into(), film::film(world, &run.trajectory, options.seconds).map_err(status::export)?));
    }
    Ok(files)
}

fn refused(error: d3dgen_crowd::Error) -> Status {
    let field = match error {
        d3dgen_crowd::Error::Seconds(_) => "seconds",
        d3dgen_crowd::Error::Nobody | d3dgen_crowd::Error::Stopped(_) => "world.scenario",
    };
    invalid(field, error.to_string())
}

fn json(value: &impl serde::Serialize) -> Result<Vec<u8>, Status> {
    serde_json::to_vec(value).map_err(|e| Status::internal(e.to_string()))
}
