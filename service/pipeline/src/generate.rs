//! The stages in a row: from a request to a checked world, with progress, cancellation and new attempts.
//!
//! Used by everyone who makes whole worlds (the command line, a server, tests). The scene graph is made once: it is what
//! was asked for. When the plan, the furniture or the check fails, the stages after it start again under a seed derived
//! from the first, so that the outcome still depends on nothing but the request.

use std::sync::atomic::AtomicBool;

use d3dgen_knowledge::{Query, Retrieval};
use d3dgen_model::brief::Brief;
use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::report::Report;
use d3dgen_model::scenario::{Scenario, without_dock};
use d3dgen_model::scene_graph::{BY_PROMPT, Connector, Note, Robot, SceneGraph};
use d3dgen_model::seed::Stream;
use d3dgen_model::stage::{Error, Stop};
use d3dgen_model::world::World;
use d3dgen_plugins::{Plugin, Registry};

use crate::placement::{Furnished, before_openings};
use crate::scene_graph::Request;
use crate::{brief, fit, floorplan, give_way, grow, mend, placement, scenario, scene_graph, ways_out, world};

/// How to make a world, beside the request itself.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Name of the world, `^[a-z0-9_]+$`; made of the graph when absent.
    pub name: Option<String>,
    /// How often plan and furniture are tried, at least 1.
    pub attempts: u32,
    /// Earlier plan whose locked parts are kept.
    pub pinned_floorplan: Option<Floorplan>,
    /// Earlier placements whose locked ones are kept.
    pub pinned_placements: Option<Placements>,
    /// What was asked for; read from the prompt of the scene graph when absent. The report answers each fact of it.
    pub brief: Option<Brief>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { name: None, attempts: 6, pinned_floorplan: None, pinned_placements: None, brief: None }
    }
}

/// How often plan and furniture are tried for each smaller robot, when one that was to fit does not.
const FEW_ATTEMPTS: u32 = 3;
/// How often they are tried for a robot that somebody has and that the building need not be made for.
const FOR_OWN_ROBOT: u32 = 2;
/// Attempts without any plan after which something gives way, where something can.
const MOST_IN_VAIN: u32 = 4;
/// Attempts that break the same rule at the same place, after which another one would too.
const SAME_FAULTS: u32 = 3;
/// How often a graph is mended for what its worlds break.
const MENDS: usize = 2;
/// Rooms of a storey up to which a sound world that misses a law, or with something before a door or window, is tried again:
/// in a large building there is always one.
const FEW_ROOMS: usize = 26;
/// The same for all storeys together.
const FEW_ON_STOREYS: usize = 40;

/// Floor between rooms up to which they are near each other, m.
const NEAR_M: f64 = 6.0;

/// A step on the way, in the order of the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Prompt to rooms and relations.
    SceneGraph,
    /// Rooms to outlines, walls, openings.
    Floorplan,
    /// Furniture.
    Placement,
    /// Robots and people.
    Scenario,
    /// Assembly and check.
    World,
}

impl Stage {
    /// Every stage in order.
    pub const ALL: [Self; 5] = [Self::SceneGraph, Self::Floorplan, Self::Placement, Self::Scenario, Self::World];

    /// Returns the one name a stage has everywhere.
    pub fn name(self) -> &'static str {
        match self {
            Self::SceneGraph => "scene_graph",
            Self::Floorplan => "floorplan",
            Self::Placement => "placement",
            Self::Scenario => "scenario",
            Self::World => "world",
        }
    }
}

/// What a stage made; a client can show a plan while its furniture is still being placed.
#[derive(Debug, Clone, Copy)]
pub enum Artifact<'a> {
    /// Of stage `scene_graph`.
    SceneGraph(&'a SceneGraph),
    /// Of stage `floorplan`.
    Floorplan(&'a Floorplan),
    /// Of stage `placement`.
    Placements(&'a Placements),
    /// Of stage `scenario`.
    Scenario(&'a Scenario),
    /// Of stage `world`.
    World(&'a World, &'a Report),
}

/// News from the path.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// A stage begins, in an attempt counted from 0.
    Started(Stage, u32),
    /// A room is furnished, in an attempt counted from 0.
    Furnished(u32, Furnished<'a>),
    /// A stage is done.
    Finished(Stage, u32, Artifact<'a>),
    /// An attempt (counted from 0) came to nothing, and why; another one follows unless it was the last.
    Rejected(u32, &'a str),
}

/// A world with its verdict.
#[derive(Debug, Clone)]
pub struct Generated {
    /// The world; to be used only when `report.is_writable()`.
    pub world: World,
    /// Every rule and constraint.
    pub report: Report,
    /// How many attempts it took.
    pub attempts: u32,
}

/// Makes and checks a world.
///
/// `observe` hears of every stage; `cancelled` is looked at before each and every few steps of the searches in them. When no
/// attempt is sound, the one with the fewest broken rules is returned, its report saying so.
///
/// # Errors
/// What the stages return (`Refused` at once, `Infeasible` after the last attempt); `Cancelled`.
pub fn generate_world(
    request: &Request,
    registry: &Registry,
    settings: &Settings,
    observe: &mut dyn FnMut(Event<'_>),
    cancelled: &AtomicBool,
) -> Result<Generated, Error> {
    begin(Stage::SceneGraph, 0, observe, cancelled)?;
    let (graph, brief) = brief::rooms(request, registry)?;
    observe(Event::Finished(Stage::SceneGraph, 0, Artifact::SceneGraph(&graph)));
    let settings = Settings { brief: settings.brief.clone().or(brief), ..settings.clone() };
    furnish_and_check(&graph, registry, &settings, observe, cancelled)
}

/// Makes and checks a world of a scene graph: all stages but the first.
///
/// When there is no plan of it, areas and then what the prompt wants beside each other give way, each a conflict of the world's scene
/// graph.
///
/// # Errors
/// As [`generate_world`]; `Mismatch` when the graph's domain is not registered.
pub fn furnish_and_check(
    graph: &SceneGraph,
    registry: &Registry,
    settings: &Settings,
    observe: &mut dyn FnMut(Event<'_>),
    cancelled: &AtomicBool,
) -> Result<Generated, Error> {
    let plugin = plugin_of(registry, graph)?;
    let pinned = settings.pinned_floorplan.is_some() || settings.pinned_placements.is_some();
    let gathered = if pinned { None } else { give_way::gathered(graph, plugin.domain()) };
    let graph = gathered.as_ref().unwrap_or(graph);
    let read = || brief::of_plan(&graph.prompt, settings.pinned_floorplan.as_ref(), registry);
    let settings = &Settings { brief: settings.brief.clone().or_else(read), ..settings.clone() };
    let mut made = |graph: &SceneGraph, settings: &Settings| {
        let mut tries = Tries { plugin, settings, observe: &mut *observe, cancelled };
        tries.with_less(graph)
    };
    let mut made = |graph: &SceneGraph, settings: &Settings| with_room(graph, plugin.domain(), settings, &mut made);
    if let Some(without) = fit::without_robots(graph) {
        let few = Settings { attempts: FOR_OWN_ROBOT.min(settings.attempts), ..settings.clone() };
        let with = made(graph, &few);
        return match &with {
            Ok(found) if found.report.is_writable() => with,
            Ok(_) | Err(Error::Infeasible { .. }) => made(&without, settings),
            Err(_) => with,
        };
    }
    let made = made(graph, settings);
    if !graph.robots.iter().any(Robot::is_fitted) {
        return made;
    }
    let few = Settings { attempts: FEW_ATTEMPTS, ..settings.clone() };
    fit::or_refused(made, graph, &mut |graph| attempts(graph, plugin, (&few, true), &mut |_| (), cancelled))
}

/// Looks for a world of a graph, and of what is left of it where something has to give way.
struct Tries<'t, 'o> {
    plugin: &'t dyn Plugin,
    settings: &'t Settings,
    observe: &'t mut (dyn FnMut(Event<'_>) + 'o),
    cancelled: &'t AtomicBool,
}

impl Tries<'_, '_> {
    /// Mends what the broken rules say, then gives up one thing after the other, then the rooms that still break a rule.
    fn with_less(&mut self, graph: &SceneGraph) -> Result<Generated, Error> {
        let domain = self.plugin.domain();
        let mut tried = graph.clone();
        let mut outcome = self.look(&tried, give_way::steps(graph, domain).next().is_none());
        for _ in 0..MENDS {
            let Some(mended) = self.broken_world(&outcome).and_then(|found| mend::mended(&tried, &found.report)) else {
                break;
            };
            tried = mended;
            outcome = better(outcome, self.look(&tried, false));
        }
        let from = tried.clone();
        let mut steps = give_way::steps(&from, domain).peekable();
        while is_in_vain(&outcome) {
            let Some(step) = steps.next() else { break };
            let next = self.look(&step, steps.peek().is_none());
            tried = step;
            outcome = better(outcome, next);
        }
        let found = self.broken_world(&outcome);
        match found.and_then(|found| mend::without_broken(&tried, &found.world, &found.report)) {
            Some(without) => better(outcome, self.look(&without, true)),
            None => outcome,
        }
    }

    fn look(&mut self, graph: &SceneGraph, is_last: bool) -> Result<Generated, Error> {
        attempts(graph, self.plugin, (self.settings, is_last), self.observe, self.cancelled)
    }

    /// Returns the world that breaks rules, where none was found that does not and nothing that somebody drew is to be kept.
    fn broken_world<'f>(&self, outcome: &'f Result<Generated, Error>) -> Option<&'f Generated> {
        let pinned = self.settings.pinned_floorplan.is_some() || self.settings.pinned_placements.is_some();
        outcome.as_ref().ok().filter(|_| !pinned && is_in_vain(outcome))
    }
}

/// Returns the later of two outcomes, unless only the former has a world, which tells more than that there is none.
fn better(former: Result<Generated, Error>, later: Result<Generated, Error>) -> Result<Generated, Error> {
    if former.is_err() || matches!(later, Err(Error::Cancelled)) || !is_in_vain(&later) { later } else { former }
}

/// Returns true where something has to give way: there is no plan, or none that keeps the hard rules.
fn is_in_vain(outcome: &Result<Generated, Error>) -> bool {
    match outcome {
        Ok(found) => !found.report.is_given() && !found.report.is_writable(),
        Err(error) => matches!(error, Error::Infeasible { .. }),
    }
}

/// Makes a world of a graph whose rooms grow where they come out with fewer places than they are for.
fn with_room(
    graph: &SceneGraph,
    domain: &Domain,
    settings: &Settings,
    made: &mut dyn FnMut(&SceneGraph, &Settings) -> Result<Generated, Error>,
) -> Result<Generated, Error> {
    let mut best = made(graph, settings)?;
    let pinned = settings.pinned_floorplan.is_some() || settings.pinned_placements.is_some();
    let lacks = |found: &Generated| scene_graph::short_rooms(domain, &found.world.scene_graph, &found.world.placements);
    let mut short = lacks(&best);
    let mut larger = graph.clone();
    let few = Settings { attempts: grow::ATTEMPTS.min(settings.attempts), ..settings.clone() };
    for round in 0..grow::ROUNDS {
        let next = grow::with_more_floor(&larger, &short, round).filter(|_| !pinned && !short.is_empty());
        let Some(next) = next else { break };
        larger = next;
        match made(&larger, &few) {
            Ok(found) => {
                let less = lacks(&found);
                let writable = found.report.is_writable() || !best.report.is_writable();
                if writable && grow::missing(&less) < grow::missing(&short) {
                    (best, short) = (found, less);
                }
            }
            Err(Error::Infeasible { .. }) => break,
            Err(error) => return Err(error),
        }
    }
    Ok(best)
}

/// Returns the plugin of a graph's domain.
///
/// # Errors
/// `Mismatch` when it is not registered.
pub fn plugin_of<'r>(registry: &'r Registry, graph: &SceneGraph) -> Result<&'r dyn Plugin, Error> {
    registry.get(&graph.domain).ok_or_else(|| Error::Mismatch {
        stage: "floorplan",
        message: format!("the scene graph is of domain `{}`, which is not registered", graph.domain),
    })
}

/// What is wrong with a world, the worst first: the order in which attempts are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Faults {
    /// Hard rules broken, a robot that does not fit among them.
    broken: usize,
    /// Laws of the knowledge base that are not kept.
    laws: usize,
    /// Robots without a dock of their own.
    undocked: usize,
    /// Things before doors and windows.
    before: usize,
    /// Advice of the knowledge base that is not followed.
    advice: usize,
}

/// Makes a world of a graph in as many attempts as it takes; one that is not the last to look for ends sooner without a plan.
fn attempts(
    graph: &SceneGraph,
    plugin: &dyn Plugin,
    (settings, is_last): (&Settings, bool),
    observe: &mut dyn FnMut(Event<'_>),
    cancelled: &AtomicBool,
) -> Result<Generated, Error> {
    let retrieved = retrieve(graph, plugin);
    let name = settings.name.clone().unwrap_or_else(|| world_name(graph));
    let pinned = settings.pinned_floorplan.is_some() || settings.pinned_placements.is_some();
    let picky = !pinned && graph.rooms.len() <= (FEW_ROOMS * graph.level_numbers().len()).min(FEW_ON_STOREYS);
    let mut best: Option<(Faults, Generated)> = None;
    let mut reason = None;
    let mut same = (None, 0);
    // the storeys of a building have to suit each other: that takes more attempts
    let most = settings.attempts.max(1) * if graph.links.is_empty() { 1 } else { 2 };
    for attempt in 0..most {
        if attempt >= FEW_ATTEMPTS && best.as_ref().is_some_and(|(least, _)| least.broken == 0) {
            break;
        }
        let seed = attempt_seed(graph.seed, attempt);
        match self::attempt(graph, plugin, &retrieved, (&name, seed, attempt), settings, observe, cancelled) {
            // of a brought plan nothing better is to be had
            Ok(found) if found.report.is_given() => return Ok(found),
            Ok(found) => {
                let (first, mut broken) = broken(&found.report);
                // another plan may have the floor that a robot lacks
                let unfit = broken == 0 && graph.robots.iter().any(Robot::is_fitted) && !fit::fits(&found);
                broken += usize::from(unfit);
                let World { floorplan, placements, .. } = &found.world;
                let before = if picky { before_openings(floorplan, placements, plugin.domain()) } else { 0 };
                let (laws, advice) = found.report.missed();
                let undocked = if picky { without_dock(&found.world.scenario.robots).len() } else { 0 };
                let faults = Faults { broken, laws: if picky { laws } else { 0 }, undocked, before, advice };
                if (faults.broken, faults.laws, faults.undocked, faults.before) == (0, 0, 0, 0) {
                    return Ok(found);
                }
                let why = match broken {
                    0 if laws > 0 => format!("{laws} law(s) are not kept"),
                    0 if undocked > 0 => format!("{undocked} robot(s) have no dock of their own"),
                    0 => format!("{before} thing(s) before doors or windows"),
                    _ if unfit => "a robot does not fit".to_owned(),
                    _ => format!("breaks {broken} hard rule(s), first {first}"),
                };
                observe(Event::Rejected(attempt, &why));
                let fault = first_fault(&found.report);
                same = if same.0 == fault { (fault, same.1 + 1) } else { (fault, 1) };
                if best.as_ref().is_none_or(|(least, _)| faults < *least) {
                    best = Some((faults, found));
                }
                let at_fault = broken > 0 && !unfit && !pinned && same.1 >= SAME_FAULTS;
                if at_fault && best.as_ref().is_some_and(|(least, _)| least.broken > 0) {
                    break;
                }
            }
            Err(error) if is_of_plan(&error, pinned) => {
                observe(Event::Rejected(attempt, &error.to_string()));
                reason = Some(match error {
                    Error::Mismatch { stage, message } => Error::Infeasible { stage, message },
                    other => other,
                });
                if best.is_none() && attempt + 1 >= MOST_IN_VAIN && !is_last {
                    break;
                }
            }
            Err(error) => return Err(error),
        }
    }
    match best {
        Some((_, found)) => Ok(found),
        None => Err(reason.expect("every attempt ends in a world or an error")),
    }
}

/// Returns true for what another plan may not have: there is none, or nothing that was brought stands where a door of it needs the
/// floor.
fn is_of_plan(error: &Error, pinned: bool) -> bool {
    match error {
        Error::Infeasible { .. } => true,
        Error::Mismatch { stage, .. } => *stage == "placement" && !pinned,
        _ => false,
    }
}

/// Code of the conflict that the plan has another area than was asked for.
const AREA_MISSED: &str = "area_missed";

/// Conflicts that leave open what is wanted; all others have a natural way out, which was taken.
const CONTRADICTIONS: &[&str] = &["wanted_and_forbidden", "contradicting_counts", "apart_but_joined", "near_and_apart"];

/// Returns what contradicts itself in a request, as its scene graph tells.
pub fn contradictions(graph: &SceneGraph) -> Vec<&str> {
    let found = graph.conflicts.iter().filter(|n| CONTRADICTIONS.contains(&n.code.as_str()));
    found.map(|n| n.message.as_str()).collect()
}

/// Returns what the knowledge base of the graph's domain says about its building, country and rooms.
pub fn retrieve(graph: &SceneGraph, plugin: &dyn Plugin) -> Retrieval {
    d3dgen_knowledge::retrieve(plugin.knowledge(), &Query::of_graph(graph, plugin.domain()))
}

/// Returns a world's name when none is given: building type (or domain) and seed, `ward_7`.
pub fn world_name(graph: &SceneGraph) -> String {
    let kind = graph.building_type.as_deref().unwrap_or(&graph.domain);
    let kind: String =
        kind.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect();
    format!("{kind}_{}", graph.seed)
}

/// Returns the seed of an attempt: the first has the request's own.
pub fn attempt_seed(seed: u64, attempt: u32) -> u64 {
    if attempt == 0 {
        return seed;
    }
    // 32 bits: exact in every JSON reader
    Stream::new(seed, &format!("attempt/{attempt}")).below(1 << 32) as u64
}

fn attempt(
    graph: &SceneGraph,
    plugin: &dyn Plugin,
    retrieved: &Retrieval,
    (name, seed, attempt): (&str, u64, u32),
    settings: &Settings,
    observe: &mut dyn FnMut(Event<'_>),
    cancelled: &AtomicBool,
) -> Result<Generated, Error> {
    let domain = plugin.domain();
    let reseeded = SceneGraph { seed, ..graph.clone() };

    begin(Stage::Floorplan, attempt, observe, cancelled)?;
    let plan = floorplan::generate_until(
        &reseeded,
        domain,
        &retrieved.limits,
        settings.pinned_floorplan.as_ref(),
        cancelled.into(),
    )?;
    observe(Event::Finished(Stage::Floorplan, attempt, Artifact::Floorplan(&plan)));

    begin(Stage::Placement, attempt, observe, cancelled)?;
    let placements = placement::generate_until(
        &reseeded,
        &plan,
        domain,
        &retrieved.limits,
        settings.pinned_placements.as_ref(),
        &mut |room| observe(Event::Furnished(attempt, room)),
        cancelled.into(),
    )?;
    observe(Event::Finished(Stage::Placement, attempt, Artifact::Placements(&placements)));

    begin(Stage::Scenario, attempt, observe, cancelled)?;
    let wishes = scenario::Wishes { brief: settings.brief.as_ref(), ..Default::default() };
    let scenario = scenario::generate_as(&reseeded, &plan, &placements, domain, &wishes)?;
    observe(Event::Finished(Stage::Scenario, attempt, Artifact::Scenario(&scenario)));

    begin(Stage::World, attempt, observe, cancelled)?;
    let mut told = with_area(graph, &plan);
    told.conflicts.extend(scene_graph::shortages(domain, graph, &placements));
    told.conflicts.extend(far_apart(graph, &plan));
    let mut world = world::assemble(name, told, plan, placements, scenario);
    world.brief.clone_from(&settings.brief);
    let report = world::check(&world, domain, retrieved);
    world.scene_graph.conflicts.extend(ways_out::told(&world, &report, domain, retrieved));
    world.rules = Some(report.applied_rules());
    observe(Event::Finished(Stage::World, attempt, Artifact::World(&world, &report)));
    Ok(Generated { world, report, attempts: attempt + 1 })
}

/// Returns what to say of rooms that the prompt wants near each other and that are not.
fn far_apart(graph: &SceneGraph, plan: &Floorplan) -> Option<Note> {
    let near = graph.edges.iter().filter(|e| e.connector == Connector::Near && e.reason == BY_PROMPT);
    let far = near.filter_map(|e| {
        let (a, b) = (plan.room(&e.a)?, plan.room(&e.b)?);
        let gap = a.polygon.bounds().distance(&b.polygon.bounds());
        (a.level == b.level && gap > NEAR_M).then(|| format!("{} from {} ({gap:.0} m)", a.name, b.name))
    });
    let far: Vec<String> = far.collect();
    let message = || format!("the prompt wants rooms near each other that are not: {}", far.join(", "));
    (!far.is_empty()).then(|| Note { code: "not_near".into(), message: message() })
}

/// Returns the graph with what became of the area asked for, where the plan has plainly another.
fn with_area(graph: &SceneGraph, plan: &Floorplan) -> SceneGraph {
    let mut graph = graph.clone();
    let said = |n: &Note| n.code == "area_not_reachable" || n.code == AREA_MISSED;
    let Some(area) = graph.area_m2.filter(|_| !graph.conflicts.iter().any(said)) else { return graph };
    let net = floorplan::net_area_m2(plan);
    if (net - area).abs() > floorplan::AREA_MISS * area {
        let message = format!("{area:.0} m2 were asked for; the plan has {net:.0} m2 with its corridors");
        graph.conflicts.push(Note { code: AREA_MISSED.into(), message });
    }
    graph
}

/// Puts a world together of a plan and its furniture, and judges it by the rules and by the brief that it answers to; the
/// scenario goes on under the plan's seed, with what is locked in one that is `kept`.
///
/// # Errors
/// As [`scenario::generate`].
pub fn finish(
    name: &str,
    graph: SceneGraph,
    (plan, placements): (Floorplan, Placements),
    domain: &Domain,
    retrieved: &Retrieval,
    brief: Option<Brief>,
    kept: Option<&Scenario>,
) -> Result<(World, Report), Error> {
    let reseeded = SceneGraph { seed: plan.seed, ..graph.clone() };
    let wishes = scenario::Wishes { brief: brief.as_ref(), kept, ..Default::default() };
    let scenario = scenario::generate_as(&reseeded, &plan, &placements, domain, &wishes)?;
    let mut world = World { brief, ..world::assemble(name, graph, plan, placements, scenario) };
    let report = world::check(&world, domain, retrieved);
    world.rules = Some(report.applied_rules());
    Ok((world, report))
}

fn begin(stage: Stage, attempt: u32, observe: &mut dyn FnMut(Event<'_>), cancelled: &AtomicBool) -> Result<(), Error> {
    Stop::from(cancelled).check()?;
    observe(Event::Started(stage, attempt));
    Ok(())
}

/// Returns the first broken rule and what breaks it.
fn first_fault(report: &Report) -> Option<(String, String)> {
    let first = report.rules.iter().flat_map(|r| &r.violations).find(|v| !v.given)?;
    Some((first.code.clone(), first.subject.clone()))
}

/// Returns what breaks the first broken rule, in words, and how many there are.
fn broken(report: &Report) -> (String, usize) {
    let mut rules = report.rules.iter().filter_map(|r| Some((r, r.violations.iter().find(|v| !v.given)?)));
    let Some((rule, v)) = rules.next() else { return (String::new(), 0) };
    (format!("{}: `{}`, {}", rule.rule, v.subject, v.message), 1 + rules.count())
}
