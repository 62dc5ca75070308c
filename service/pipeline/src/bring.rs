//! A file of a plan that somebody brings becomes the documents that the stages begin with.
//!
//! `plans` reads the file, `scene_graph::given` gives its rooms their types; this joins them, for the command and for servers.

use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage;
use d3dgen_plans::{LaidRoom, Options, Plan, Source, assemble, lay_out, read};
use d3dgen_plugins::Registry;

use crate::scene_graph::{Brought, Label, of_plan, understand};

const STAGE: &str = "plan";

/// Why a plan does not become the documents that the stages begin with.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be read; says where.
    #[error(transparent)]
    Plan(#[from] d3dgen_plans::Error),
    /// What is said of the plan does not go with it, or its rooms make no building.
    #[error(transparent)]
    Stage(#[from] stage::Error),
}

/// What is said about a plan beside its file.
#[derive(Debug, Clone, Default)]
pub struct Said<'a> {
    /// How the file is read.
    pub options: Options,
    /// Domain id; guessed from the names of the rooms when absent.
    pub domain: Option<String>,
    /// Types of rooms, by their names on the plan.
    pub room_types: Vec<(String, String)>,
    /// Scene graph of the plan's rooms, for a floorplan document; made of its rooms and doors when absent.
    pub graph: Option<&'a SceneGraph>,
    /// What to make of it; its domain and notes are found here.
    pub brought: Brought,
}

/// Reads a plan and returns it, all of it locked, with the scene graph of its rooms.
///
/// # Errors
/// `Plan` for what cannot be read, with the place in the file; `Stage` for what does not go with it.
pub fn bring(source: &Source, said: &Said, registry: &Registry) -> Result<(SceneGraph, Floorplan), Error> {
    let title = source.name.split('.').next().unwrap_or_default().to_owned();
    let domain = said.domain.as_deref();
    let mut brought = said.brought.clone();
    let plan = match read(source, &said.options)? {
        Plan::Document(_) if said.options.level.is_some() => {
            return Err(refused("a level goes with drawings only; a floorplan document keeps all its levels"));
        }
        Plan::Document(mut plan) => {
            plan.seed = brought.seed;
            if let Some(graph) = said.graph {
                return Ok((SceneGraph { seed: brought.seed, ..graph.clone() }, plan));
            }
            let labels: Vec<Label> = plan.rooms.iter().map(label_of_planned).collect();
            let known = understand(&typed(labels, &said.room_types)?, &[title], domain, registry)?;
            plan.rooms.iter_mut().zip(known.room_types).for_each(|(room, kind)| room.room_type = kind);
            (brought.domain, brought.notes) = (known.domain, known.notes);
            plan
        }
        Plan::Drawing(_) if said.graph.is_some() => {
            return Err(refused("a scene graph goes with a floorplan document only; drawings get their own"));
        }
        Plan::Drawing(drawing) => {
            let mut layout = lay_out(drawing, &said.options)?;
            let joined = layout.joined();
            let labels: Vec<Label> = layout.rooms.iter().zip(joined).map(label_of_drawn).collect();
            let titles: Vec<String> = [title].into_iter().chain(layout.titles.iter().cloned()).collect();
            let known = understand(&typed(labels, &said.room_types)?, &titles, domain, registry)?;
            layout.rooms.iter_mut().zip(&known.names).for_each(|(room, name)| room.label.clone_from(name));
            let Some(plugin) = registry.get(&known.domain) else {
                return Err(refused(format!("domain `{}` is not registered", known.domain)));
            };
            let (plan, notes) = assemble(layout, &known.room_types, plugin.domain(), brought.seed, &said.options);
            (brought.domain, brought.notes) = (known.domain, [notes, known.notes].concat());
            plan
        }
    };
    Ok((of_plan(&plan, &brought, registry)?, plan))
}

fn label_of_planned(room: &PlanRoom) -> Label {
    Label { text: room.name.clone(), kind: Some(room.room_type.clone()), ..Label::default() }
}

fn label_of_drawn((room, beside): (&LaidRoom, Vec<usize>)) -> Label {
    Label {
        text: room.label.clone(),
        kind: room.kind.clone(),
        also: room.also.clone(),
        hub: room.hub,
        said: false,
        unnamed: room.unnamed,
        area_m2: room.net_polygon.area(),
        beside,
    }
}

/// Returns the labels with the types that are said.
fn typed(mut labels: Vec<Label>, room_types: &[(String, String)]) -> Result<Vec<Label>, Error> {
    for (name, kind) in room_types {
        let mut named = labels.iter_mut().filter(|l| l.text == *name).peekable();
        if named.peek().is_none() {
            return Err(refused(format!("room type {name}={kind}: the plan has no room `{name}`")));
        }
        named.for_each(|l| (l.kind, l.said) = (Some(kind.clone()), true));
    }
    Ok(labels)
}

fn refused(message: impl Into<String>) -> Error {
    stage::Error::Refused { stage: STAGE, message: message.into() }.into()
}
