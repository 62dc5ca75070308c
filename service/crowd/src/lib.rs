//! A crowd on the exact free floor of a world: the people and robots of its scenario, moved tenth of a second by tenth.
//!
//! Routes first (`routes`: from door to door over a fine lattice, by stairs and lifts between storeys), then the others (`avoid`:
//! sampled velocity obstacles), and what people do on the way (`engine`: doors, lines, seats, making way). Same world and seed,
//! same tracks: there is no clock and no thread here. What it is not for: files (the caller writes), pictures (`export`).

mod avoid;
mod engine;
mod figures;
mod mover;
mod routes;
mod search;
mod setup;
mod space;
mod walkable;

use d3dgen_model::domain::Domain;
use d3dgen_model::trajectory::Trajectory;
use d3dgen_model::world::World;
use serde_json::Value;

/// What is to be simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Length, s.
    pub seconds: f64,
    /// Seed of those who come and go; the scenario's own where it is not said.
    pub seed: Option<u64>,
}

/// Shortest and longest time that is simulated, s.
pub const SECONDS: [f64; 2] = [1.0, 86_400.0];

/// A simulated scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Where everybody was.
    pub trajectory: Trajectory,
    /// The floor that they were on, as GeoJSON: `walkable` and `obstacle`, by storey.
    pub walkable: Value,
    /// The figures of social navigation, see `docs/scenarios.md`.
    pub metrics: Value,
}

/// Why a scenario cannot be simulated.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The time is none.
    #[error("{0} s cannot be simulated; give {low} to {high} s", low = SECONDS[0], high = SECONDS[1])]
    Seconds(f64),
    /// Nobody is in the scenario.
    #[error("the scenario has neither people nor robots; make one with `d3dgen scenario`")]
    Nobody,
    /// Somebody stopped it.
    #[error("stopped at {0} s of the simulation")]
    Stopped(f64),
}

/// Simulates the scenario of a world; `observe` is told the time that is done, s, about every second of the simulation, and
/// stops it with `false`.
///
/// # Errors
/// `Seconds` for a time that is none, `Nobody` for a scenario in which nothing moves, `Stopped` when `observe` says so.
pub fn simulate(
    world: &World,
    domain: &Domain,
    options: Options,
    observe: &mut dyn FnMut(f64) -> bool,
) -> Result<Run, Error> {
    if !(SECONDS[0]..=SECONDS[1]).contains(&options.seconds) {
        return Err(Error::Seconds(options.seconds));
    }
    let scenario = &world.scenario;
    if scenario.agents.is_empty() && scenario.robots.is_empty() && scenario.flows.is_empty() {
        return Err(Error::Nobody);
    }
    let spaces = setup::spaces(world);
    let links = routes::links(&spaces, &world.floorplan);
    let seed = options.seed.unwrap_or(scenario.seed);
    let mut engine = setup::engine(world, domain, (&spaces, &links), seed, options.seconds);
    let mut reached = 0.0;
    let whole = engine.run(&mut |t| {
        reached = t;
        observe(t)
    });
    if !whole {
        return Err(Error::Stopped(reached));
    }
    let movers = std::mem::take(&mut engine.movers);
    let outcomes = movers.iter().map(figures::Outcome::of).collect::<Vec<_>>();
    let levels: Vec<i32> = spaces.iter().map(|s| s.level).collect();
    let (mut agents, mut robots) = (Vec::new(), Vec::new());
    for mover in movers {
        let robot = mover.robot;
        if let Some(track) = mover.track(&levels) {
            if robot { &mut robots } else { &mut agents }.push(track);
        }
    }
    let trajectory =
        Trajectory { format: "crowd/1", world: world.name.clone(), seed, hour: scenario.hour.clone(), agents, robots };
    let metrics = figures::measure(world, &spaces, &trajectory, &outcomes, options.seconds);
    Ok(Run { walkable: walkable::geojson(&spaces), trajectory, metrics })
}
