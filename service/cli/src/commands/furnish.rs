//! `d3dgen furnish`: a plan that the user brings becomes a furnished, judged world.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::bring::{self, Said};
use d3dgen_pipeline::generate::{Event, Settings, Stage, furnish_and_check};
use d3dgen_pipeline::scene_graph::Brought;
use d3dgen_plans::{LayerUse, Options, Source, readers};
use d3dgen_plugins::Registry;

use super::formats;
use crate::error::Error;
use crate::input::{document, write_text};
use crate::output::Output;
use crate::progress::Progress;
use crate::registry::{RegistryArgs, domain};
use crate::summary::Summary;
use crate::{bundle, interrupt, summary};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// The plan: floorplan.json of d3dgen, GeoJSON, IMDF (zip or folder), SVG, DXF, Open-RMF building.yaml, or the map.yaml of
    /// a nav2 map
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// Folder to write: new, empty, or an earlier output, which is replaced
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Format of the plan (floorplan, imdf, geojson, svg, dxf, rmf, nav2); otherwise recognized
    #[arg(long, value_name = "NAME")]
    plan_format: Option<String>,
    /// Scene graph of the plan's rooms, for a floorplan.json; otherwise made of its rooms and doors
    #[arg(long, value_name = "GRAPH", conflicts_with_all = ["domain", "country", "robot", "robot_radius"])]
    graph: Option<PathBuf>,
    /// Kind of building (`d3dgen domains list`); otherwise guessed from the names of the rooms
    #[arg(long, value_name = "ID")]
    domain: Option<String>,
    /// Country or division whose rules apply: a code (DE, CA-ON), or its name or a city
    #[arg(long, value_name = "COUNTRY")]
    country: Option<String>,
    /// Robot the world is for: cleaning, disinfection, delivery, service or transport; may be given more than once
    #[arg(long, value_name = "KIND")]
    robot: Vec<String>,
    /// Radius in m of the largest robot
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    robot_radius: Option<f64>,
    /// Seed of all choices: the same seed and plan give the same bytes
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// Name of the world, lower case with underscores
    #[arg(long, value_name = "NAME", value_parser = super::world_name)]
    name: Option<String>,
    /// Type of a room, by its name on the plan: `--room-type "B1=bedroom"`; may be given more than once
    #[arg(long, value_name = "NAME=TYPE", value_parser = pair)]
    room_type: Vec<(String, String)>,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Print one JSON line for the world
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    formats: formats::FormatArgs,
    #[command(flatten)]
    registry: RegistryArgs,
}

/// The file that a folder of a venue has.
const MANIFEST: &str = "manifest.json";

/// How the drawing is read.
#[derive(clap::Args)]
struct ReadingArgs {
    /// Length of one unit of the drawing in m (a cell, for a map), where the file does not say it
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    meters_per_unit: Option<f64>,
    /// Storey to read alone; otherwise all of them
    #[arg(long, value_name = "NAME")]
    level: Option<String>,
    /// What is drawn on a layer (class, group, kind): wall, room, door, window, column, furniture or ignore, as in
    /// `--layer "A-210 Existing=wall"`; may be given more than once
    #[arg(long, value_name = "NAME=USE", value_parser = layer)]
    layer: Vec<(String, LayerUse)>,
    /// Make outlines with slanted walls of steps instead of refusing them (walls drawn as lines are in any case)
    #[arg(long)]
    rectify: bool,
    /// Thickness in m of inner walls that are drawn as lines
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    inner_wall: Option<f64>,
    /// Thickness in m of outer walls
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    outer_wall: Option<f64>,
    /// Add an entrance and doors where rooms cannot be reached
    #[arg(long)]
    add_doors: bool,
    /// Add a window to each room that needs daylight, or is better with it, has an outer wall and no window
    #[arg(long)]
    add_windows: bool,
}

/// Returns the parts of `NAME=TYPE`.
fn pair(text: &str) -> Result<(String, String), String> {
    let (name, kind) = text.rsplit_once('=').ok_or("needs the form NAME=TYPE")?;
    Ok((name.trim().to_owned(), kind.trim().to_owned()))
}

/// Returns the parts of `NAME=USE`.
fn layer(text: &str) -> Result<(String, LayerUse), String> {
    let (name, word) = text.rsplit_once('=').ok_or("needs the form NAME=USE")?;
    let known = || LayerUse::ALL.map(|(name, _)| name).join(", ");
    let layer_use =
        LayerUse::of_word(word).ok_or_else(|| format!("`{word}` is no use of a layer; there are {}", known()))?;
    Ok((name.trim().to_owned(), layer_use))
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let formats = self.formats.chosen(&self.registry.store)?;
        let registry = self.registry.load()?;
        let output = Output::new(&self.out)?;
        let (graph, plan) = self.given(&registry)?;
        let settings = Settings { name: self.name.clone(), pinned_floorplan: Some(plan), ..Settings::default() };
        let progress = if self.json { Progress::silent() } else { Progress::of(1) };
        let mut clock: BTreeMap<Stage, Duration> = BTreeMap::new();
        let mut begun = Instant::now();
        let mut observe = |event: Event<'_>| match event {
            Event::Started(..) => begun = Instant::now(),
            Event::Finished(stage, ..) => *clock.entry(stage).or_default() += begun.elapsed(),
            Event::Furnished(_, room) => {
                progress.doing(&format!("furnishing: {} of {} rooms, {}", room.done, room.total, room.room_id));
            }
            Event::Rejected(..) => {}
        };
        let made = furnish_and_check(&graph, &registry, &settings, &mut observe, interrupt::flag());
        progress.finish();
        let made = made?;
        let writing = Instant::now();
        let plugin = domain(&registry, &made.world.scene_graph.domain)?;
        bundle::write(&made.world, &made.report, plugin.domain(), &formats, &output)?;
        interrupt::check()?;
        let kept = output.commit()?;
        let mut times: Vec<(&'static str, Duration)> = clock.iter().map(|(stage, t)| (stage.name(), *t)).collect();
        times.push(("files", writing.elapsed()));
        let page = Summary::new(&made, &self.out, times).with_kept(kept);
        if self.json {
            write_text(None, &format!("{}\n", page.json()))?;
        }
        eprint!("{}", page.page());
        summary::judged(&made.report)
    }

    /// Returns the plan with its scene graph.
    fn given(&self, registry: &Registry) -> Result<(SceneGraph, Floorplan), Error> {
        let options = Options {
            format: self.plan_format.clone(),
            meters_per_unit: self.reading.meters_per_unit,
            level: self.reading.level.clone(),
            rectify: self.reading.rectify,
            layers: self.reading.layer.clone(),
            inner_wall_m: self.reading.inner_wall,
            outer_wall_m: self.reading.outer_wall,
            add_doors: self.reading.add_doors,
            add_windows: self.reading.add_windows,
        };
        let read_error = |source| Error::Read { path: self.plan.clone(), source };
        // a folder is a venue in files of its own, which its manifest stands for
        let file = if self.plan.is_dir() { self.plan.join(MANIFEST) } else { self.plan.clone() };
        if self.plan.is_dir() && !file.is_file() {
            let message = format!("{} is a folder without {MANIFEST}: it is no IMDF venue", self.plan.display());
            return Err(Error::Input(message));
        }
        let size = fs::metadata(&file).map_err(read_error)?;
        if size.is_file() && size.len() > readers::MOST_BYTES as u64 {
            return Err(Error::Input(format!("{} is too large for a floor plan", self.plan.display())));
        }
        let bytes = fs::read(&file).map_err(read_error)?;
        let name = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let source = Source { name: &name, bytes: &bytes, companion: &|name| companion(&file, name) };
        let graph: Option<SceneGraph> = self.graph.as_deref().map(document).transpose()?;
        let brought = Brought {
            title: format!("furnish {name}"),
            seed: self.seed,
            country: self.country.clone(),
            robots: self.robot.clone(),
            robot_radius_m: self.robot_radius,
            ..Brought::default()
        };
        let (domain, room_types) = (self.domain.clone(), self.room_type.clone());
        let said = Said { options, domain, room_types, graph: graph.as_ref(), brought };
        bring::bring(&source, &said, registry).map_err(|error| match error {
            bring::Error::Plan(source) => Error::Plan { path: self.plan.clone(), source },
            bring::Error::Stage(refused) => refused.into(),
        })
    }
}

/// Returns a file that the plan names, of its own folder.
fn companion(plan: &Path, file: &str) -> Option<Vec<u8>> {
    let path = plan.parent().unwrap_or(Path::new("")).join(file);
    let small = fs::metadata(&path).is_ok_and(|m| m.is_file() && m.len() <= readers::MOST_BYTES as u64);
    if small { fs::read(path).ok() } else { None }
}
