//! Plans that clients bring.

use d3dgen_pipeline::bring::{Said, bring};
use d3dgen_pipeline::scene_graph::Brought;
use d3dgen_plans::{Options, Source};
use d3dgen_plugins::Registry;
use d3dgen_proto::v1::{ImportFloorplanRequest, ImportFloorplanResponse};
use tonic::Status;

use crate::convert::message;
use crate::status::{self, invalid};

/// Reads the plan; what is refused is put down to its `content`, the message names the place.
pub(super) fn import(asked: &ImportFloorplanRequest, registry: &Registry) -> Result<ImportFloorplanResponse, Status> {
    if asked.content.is_empty() {
        return Err(invalid("content", "is empty; put the bytes of the plan's file here"));
    }
    let source = Source {
        name: &asked.file_name,
        bytes: &asked.content,
        companion: &|file| asked.companions.get(file).cloned(),
    };
    let options = Options {
        layers: Vec::new(),
        format: asked.format.clone(),
        meters_per_unit: asked.meters_per_unit,
        level: asked.level.clone(),
        rectify: asked.rectify,
        inner_wall_m: asked.inner_wall_m,
        outer_wall_m: asked.outer_wall_m,
        add_doors: asked.add_doors,
        add_windows: asked.add_windows,
    };
    let brought = Brought {
        title: format!("furnish {}", asked.file_name),
        seed: asked.seed,
        country: asked.country.clone(),
        robots: asked.robot_kinds.clone(),
        robot_radius_m: asked.robot_radius_m,
        ..Brought::default()
    };
    let room_types = asked.room_types.iter().map(|(name, kind)| (name.clone(), kind.clone())).collect();
    let said = Said { options, domain: asked.domain_id.clone(), room_types, graph: None, brought };
    let (graph, plan) = bring(&source, &said, registry).map_err(|e| status::plan("content", e))?;
    Ok(ImportFloorplanResponse { scene_graph: Some(message(&graph)), floorplan: Some(message(&plan)) })
}
