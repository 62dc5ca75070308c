//! Worlds that clients keep: each with the states it went through, one of them in force.
//!
//! Every change is one batch of the server's own records, so that what is acknowledged is there after a crash, and half of
//! a change never is. What the worlds are about is of no matter here.

use std::ops::ControlFlow;

use d3dgen_model::report::Report;
use d3dgen_model::world::World;
use d3dgen_store::{Batch, KeyRange};
use serde::{Deserialize, Serialize};
use tonic::Status;

use crate::access::{Caller, Scope};
use crate::core::Core;
use crate::own::{self, WORLD_REVISIONS, WORLD_STATES, WORLDS, WORLDS_COUNTED};
use crate::status::{self, reason};

/// Worlds of one client at most.
const WORLDS_EACH: usize = 1000;
/// States of a world that are kept; the oldest go first.
const STATES: u64 = 50;
/// Key of the number of worlds so far.
const COUNT: &str = "worlds";

/// A kept world, without its states.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Kept {
    /// Id: `world_17`.
    pub id: String,
    /// Name of the client that keeps it.
    pub owner: String,
    /// Name for people.
    pub title: String,
    /// Counts the changes, which makes the etag.
    pub change: u64,
    /// Number of its oldest state.
    pub first: u64,
    /// Number of the state in force.
    pub revision: u64,
    /// Number of its newest state.
    pub last: u64,
    /// True when the state in force is sound.
    pub sound: bool,
    /// Rooms of the state in force.
    pub rooms: usize,
    /// When it was kept first, ms since 1970.
    pub created_ms: u64,
    /// When it was changed last, ms since 1970.
    pub updated_ms: u64,
}

/// What is said of a state of a kept world.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Revision {
    /// Its number.
    pub number: u64,
    /// What made it, for people.
    pub label: String,
    /// When it was kept, ms since 1970.
    pub created_ms: u64,
}

/// A state of a kept world.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State {
    /// The world.
    pub world: World,
    /// The verdict on it.
    pub report: Report,
}

impl Kept {
    /// Returns what tells the state of the record from every other.
    pub fn etag(&self) -> String {
        format!("{}-{}", self.id, self.change)
    }

    /// # Errors
    /// `ABORTED` when the client saw another state last.
    fn expect(&self, etag: &str) -> Result<(), Status> {
        if self.etag() == etag {
            return Ok(());
        }
        let message = format!("{} has changed since: its etag is {}; read it again, and decide", self.id, self.etag());
        Err(status::because(reason::CHANGED, &Status::aborted(message)))
    }

    fn touch(&mut self, core: &Core) {
        self.change += 1;
        self.updated_ms = core.clock.now_ms();
    }

    fn show(&mut self, state: &State) {
        self.sound = state.report.sound;
        self.rooms = state.world.scene_graph.rooms.len();
    }
}

/// Returns a kept world of the caller; those of others are as if they were not there.
///
/// # Errors
/// `NOT_FOUND`; `INTERNAL` when the storage refuses.
pub fn get(core: &Core, id: &str, caller: &Caller) -> Result<Kept, Status> {
    let found: Option<Kept> = own::get(&core.databases.own, WORLDS, id).map_err(status::own)?;
    found.filter(|kept| is_of(kept, caller)).ok_or_else(|| {
        let id: String = id.chars().take(60).collect();
        Status::not_found(format!("no world {id:?} is kept"))
    })
}

fn is_of(kept: &Kept, caller: &Caller) -> bool {
    caller.scope >= Scope::Admin || kept.owner == caller.name
}

/// Returns the kept worlds of the caller, the one changed last first.
///
/// # Errors
/// `INTERNAL` when the storage refuses.
pub fn list(core: &Core, caller: &Caller) -> Result<Vec<Kept>, Status> {
    let mut found: Vec<Kept> = Vec::new();
    let all = KeyRange::prefix("");
    own::each(&core.databases.own, WORLDS, &all, |_, kept: Kept| {
        if is_of(&kept, caller) {
            found.push(kept);
        }
        Ok(ControlFlow::Continue(()))
    })
    .map_err(status::own)?;
    found.sort_by(|a, b| b.updated_ms.cmp(&a.updated_ms).then_with(|| b.id.cmp(&a.id)));
    Ok(found)
}

/// Returns a state of a kept world.
///
/// # Errors
/// `NOT_FOUND` for a number that is none of its states; `INTERNAL` when the storage refuses.
pub fn state(core: &Core, kept: &Kept, number: u64) -> Result<State, Status> {
    let found = own::get(&core.databases.own, WORLD_STATES, &key(&kept.id, number)).map_err(status::own)?;
    found.ok_or_else(|| {
        let (first, last) = (kept.first, kept.last);
        Status::not_found(format!("{} has the states {first} to {last}, not {number}", kept.id))
    })
}

/// Returns what is said of the states of a kept world, oldest first.
///
/// # Errors
/// `INTERNAL` when the storage refuses.
pub fn revisions(core: &Core, kept: &Kept) -> Result<Vec<Revision>, Status> {
    let mut found = Vec::new();
    let range = KeyRange::prefix(format!("{}/", kept.id));
    own::each(&core.databases.own, WORLD_REVISIONS, &range, |_, revision: Revision| {
        found.push(revision);
        Ok(ControlFlow::Continue(()))
    })
    .map_err(status::own)?;
    Ok(found)
}

/// Keeps a world; `also` puts what belongs to the change into its batch. For a caller that has its turn.
///
/// # Errors
/// `RESOURCE_EXHAUSTED` when the client keeps as many as it may; `INTERNAL` when the storage refuses.
pub fn create(
    core: &Core,
    owner: &str,
    title: String,
    label: String,
    state: &State,
    also: impl FnOnce(&Kept, &mut Batch),
) -> Result<Kept, Status> {
    let own_worlds = list(core, &Caller { name: owner.to_owned(), scope: Scope::Read })?;
    if own_worlds.len() >= WORLDS_EACH {
        let message = format!("{WORLDS_EACH} worlds are kept, the most for one client: delete some");
        return Err(Status::resource_exhausted(message));
    }
    let counted: u64 = own::get(&core.databases.own, WORLDS_COUNTED, COUNT).map_err(status::own)?.unwrap_or_default();
    let now = core.clock.now_ms();
    let mut kept = Kept {
        id: format!("world_{}", counted + 1),
        owner: owner.to_owned(),
        title: if title.is_empty() { state.world.name.clone() } else { title },
        change: 0,
        first: 1,
        revision: 0,
        last: 0,
        sound: false,
        rooms: 0,
        created_ms: now,
        updated_ms: now,
    };
    let mut batch = Batch::new();
    own::put(&mut batch, WORLDS_COUNTED, COUNT, &(counted + 1));
    push(core, &mut kept, label, state, &mut batch);
    also(&kept, &mut batch);
    core.databases.own.apply(batch).map_err(status::store)?;
    Ok(kept)
}

/// Puts a state behind the one in force into the batch; what was undone, and what is too old, goes.
fn push(core: &Core, kept: &mut Kept, label: String, state: &State, batch: &mut Batch) {
    let number = kept.revision + 1;
    let oldest = kept.first.max((number + 1).saturating_sub(STATES));
    for gone in (kept.first..oldest).chain(number + 1..=kept.last) {
        drop_state(&kept.id, gone, batch);
    }
    (kept.first, kept.revision, kept.last) = (oldest, number, number);
    kept.show(state);
    kept.touch(core);
    let revision = Revision { number, label, created_ms: kept.updated_ms };
    own::put(batch, WORLD_REVISIONS, &key(&kept.id, number), &revision);
    own::put(batch, WORLD_STATES, &key(&kept.id, number), state);
    own::put(batch, WORLDS, &kept.id, kept);
}

fn drop_state(id: &str, number: u64, batch: &mut Batch) {
    batch.delete(WORLD_REVISIONS, key(id, number)).delete(WORLD_STATES, key(id, number));
}

/// Adds a state to a kept world, or gives it another title. For a caller that has its turn.
///
/// # Errors
/// `NOT_FOUND`, `ABORTED`; `INTERNAL` when the storage refuses.
pub fn update(
    core: &Core,
    (id, etag, caller): (&str, &str, &Caller),
    title: String,
    state: Option<(String, &State)>,
) -> Result<Kept, Status> {
    let mut kept = get(core, id, caller)?;
    kept.expect(etag)?;
    if !title.is_empty() {
        kept.title = title;
    }
    let mut batch = Batch::new();
    match state {
        Some((label, state)) => push(core, &mut kept, label, state, &mut batch),
        None => {
            kept.touch(core);
            own::put(&mut batch, WORLDS, &kept.id, &kept);
        }
    }
    core.databases.own.apply(batch).map_err(status::store)?;
    Ok(kept)
}

/// Puts another state of a kept world in force. For a caller that has its turn.
///
/// # Errors
/// `NOT_FOUND`, `ABORTED`; `INTERNAL` when the storage refuses.
pub fn restore(core: &Core, (id, etag, caller): (&str, &str, &Caller), number: u64) -> Result<(Kept, State), Status> {
    let mut kept = get(core, id, caller)?;
    kept.expect(etag)?;
    let state = state(core, &kept, number)?;
    kept.revision = number;
    kept.show(&state);
    kept.touch(core);
    let mut batch = Batch::new();
    own::put(&mut batch, WORLDS, &kept.id, &kept);
    core.databases.own.apply(batch).map_err(status::store)?;
    Ok((kept, state))
}

/// Drops a kept world with its states. For a caller that has its turn.
///
/// # Errors
/// `NOT_FOUND`, `ABORTED`; `INTERNAL` when the storage refuses.
pub fn delete(core: &Core, (id, etag, caller): (&str, &str, &Caller)) -> Result<(), Status> {
    let kept = get(core, id, caller)?;
    kept.expect(etag)?;
    let mut batch = Batch::new();
    for number in kept.first..=kept.last {
        drop_state(&kept.id, number, &mut batch);
    }
    batch.delete(WORLDS, kept.id);
    core.databases.own.apply(batch).map_err(status::store)?;
    Ok(())
}

fn key(id: &str, number: u64) -> String {
    format!("{id}/{number:020}")
}
