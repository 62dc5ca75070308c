//! Rooms that are entered through others: which room is the host of each en suite, closet and terrace.

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_model::domain::{Access, AdjacencyRelation, Domain, RoomType, Zone, tags};
use d3dgen_model::offer;
use d3dgen_model::offer::sleeps;
use d3dgen_model::scene_graph::{Note, SceneGraph};

use super::vital;
use crate::built::planned::Planned;
use crate::reading::Reading;
use crate::subject::programs::{is_dwelling, is_office};
use crate::tokens::storey::Where;
use crate::tokens::words::words;
use crate::wished::wishes::{Pair, PerHost};

/// Code of the note that one of several bathrooms belongs to the main bedroom.
const EN_SUITE: &str = "en_suite";
/// Rooms behind one lock at most: more have no wall in common with it.
const MOST_BEHIND: usize = 2;

/// Returns the type of the room that comes with every host: the one that is named, or where that is no room entered through
/// another the one for the same use that is: "every room has a bathroom" of a hospital means its en suites.
fn private_kind<'a>(reading: &Reading<'a>, rooms: &[Planned], pair: &PerHost) -> &'a RoomType {
    let named = reading.domain.room_type_or_generic(&pair.guest);
    let sleeps = |id: &String| rooms.iter().any(|r| &r.room_type == id && r.kind.zone == Zone::Night);
    let serves = |kind: &&RoomType| kind.access == Access::Host && kind.wet && kind.hosts.iter().any(sleeps);
    if named.access == Access::Host || !named.wet || pair.host.is_some() {
        return named;
    }
    reading.domain.room_types.iter().find(serves).unwrap_or(named)
}

/// Gives each host the room that the prompt wants with every one of them: "every patient room has an en suite".
pub(super) fn equip_hosts<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    for pair in &reading.wishes.per_host {
        let kind = private_kind(reading, rooms, pair);
        let takes = |r: &Planned| match &pair.host {
            Some(host) => &r.room_type == host,
            None => r.kind.zone == Zone::Night && r.kind.access != Access::Host && kind.hosts.contains(&r.room_type),
        };
        loop {
            let hosts = rooms.iter().filter(|r| takes(r)).count();
            if rooms.iter().filter(|r| r.room_type == kind.id).count() >= hosts {
                break;
            }
            let guest = Planned { requested: true, ..Planned::new(&kind.id, kind) };
            if reading.total.is_none() {
                rooms.push(guest);
                continue;
            }
            // the number of rooms is fixed: the last host makes room for something else of the program, or else that for it
            let own = |r: &Planned| takes(r) || r.room_type == kind.id;
            let last = rooms.iter().rposition(|r| takes(r) && !r.requested);
            let next = reading
                .program
                .rooms
                .iter()
                .map(|e| Planned::new(&e.room_type, reading.domain.room_type_or_generic(&e.room_type)));
            let fresh = |p: &Planned| {
                !own(p) && p.kind.access != Access::Host && !rooms.iter().any(|r| r.room_type == p.room_type)
            };
            let next = next.into_iter().find(|p| fresh(p) && reading.may_add(&p.room_type));
            if let (Some(last), Some(next)) = (last.filter(|_| hosts > 1), next) {
                rooms[last] = next;
                continue;
            }
            let spare = (0..rooms.len())
                .rev()
                .find(|&i| !rooms[i].requested && !own(&rooms[i]) && !vital::is_vital(reading, rooms, i))
                .or_else(|| (0..rooms.len()).rev().find(|&i| takes(&rooms[i]) && !rooms[i].requested));
            let Some(spare) = spare else { break };
            rooms[spare] = guest;
        }
    }
}

/// Returns true for two rooms of the public, one told with the other, where people work: each of them lies at the
/// circulation, or the one would be the only way to the other and to all who work behind it.
pub(super) fn are_public(reading: &Reading, pair: &Pair) -> bool {
    let public = |id: &String| {
        let kind = reading.domain.room_type(id)?;
        (kind.zone == Zone::Public && kind.access != Access::Host).then_some(kind)
    };
    let (Some(a), Some(b)) = (public(&pair.a), public(&pair.b)) else { return false };
    let serves = |k| offer::has_counters(reading.domain, k);
    is_office(reading.program) || serves(a) || serves(b)
}

/// Finds for every en suite, closet and the like the room it is entered from.
pub(super) fn hang_on_hosts(reading: &mut Reading, rooms: &mut [Planned]) {
    let domain = reading.domain;
    // the control room of "MRI with control room" has a door to the scanner and one for those who work there
    let beside = |p: &&Pair| {
        let of = |id: &String| domain.room_type(id).is_none_or(|k| k.access == Access::Host);
        let mut rules = rules_here(domain, reading.country_code.as_deref());
        !of(&p.a) && rules.any(|r| r.relation == AdjacencyRelation::Must && r.a == p.a && r.b == p.b)
    };
    let pairs: Vec<Pair> = reading.wishes.pairs.iter().filter(|p| p.belongs && !beside(p)).cloned().collect();
    let storeys: Vec<Option<Where>> = rooms.iter().map(|r| only_storey(reading, &r.room_type)).collect();
    for i in 0..rooms.len() {
        let room = &rooms[i];
        // "on the second floor a terrace": not that of the living room below
        let elsewhere = |h: usize| storeys[i].is_some_and(|at| storeys[h].is_some_and(|other| other != at));
        let hosted = room.kind.access == Access::Host;
        // "management with boardroom": nobody meets behind somebody's office; a closet is not entered through a bathroom
        let through = |p: &&Pair| domain.room_type(&p.b).is_some_and(|host| !room.kind.may_hang_on(host));
        let belongs = pairs.iter().find(|p| p.a == room.room_type).filter(|p| !through(p));
        // "lobby with counters": the public goes on from one to the other, those who work there do not
        let belongs = belongs.filter(|p| !are_public(reading, p));
        if !hosted && belongs.is_none() {
            continue;
        }
        // "seclusion room with an anteroom": one goes in through it
        if let Some(behind) = belongs.and_then(|pair| behind_lock(domain, rooms, i, pair)) {
            rooms[behind].host = Some(i);
            continue;
        }
        let fits = |h: &Planned| match belongs {
            // "isolation room with anteroom": the type says that one enters through the anteroom
            Some(pair) => h.room_type == pair.b && !h.kind.hosts.contains(&room.room_type),
            None => room.kind.hosts.contains(&h.room_type),
        };
        let by_type = |h: &Planned| hosted && room.kind.hosts.contains(&h.room_type);
        // an en suite for wheelchairs is one of the en suites
        let alike = |r: &Planned| {
            r.room_type == rooms[i].room_type || [r, &rooms[i]].iter().all(|r| reading.wet.has_toilet(r.kind))
        };
        let guests = |h: usize, rooms: &[Planned]| rooms.iter().filter(|r| r.host == Some(h) && alike(r)).count();
        // the usual host first: a terrace lies before the living room
        let rank = |h: &Planned| room.kind.hosts.iter().position(|k| *k == h.room_type);
        let candidates = |test: &dyn Fn(&Planned) -> bool| {
            let free = |h: &usize| *h != i && test(&rooms[*h]) && rooms[*h].host != Some(i) && !elsewhere(*h);
            (0..rooms.len()).filter(free).min_by_key(|&h| {
                let apart = rooms[h].unit != room.unit;
                (apart, guests(h, rooms), rank(&rooms[h]), usize::from(rooms[h].host.is_some()), h)
            })
        };
        // en suites beyond those of the rooms that they are told of go to the others that have none
        let told = candidates(&fits);
        let bare = |h: &usize| !hosted || guests(*h, rooms) == 0;
        let host = told.filter(bare).or_else(|| candidates(&by_type)).or(told);
        // a room the prompt gives to one host only ("bedroom with its own bath and a second bath")
        let taken = !hosted && host.is_some_and(|h| guests(h, rooms) > 0);
        if taken {
            continue;
        }
        if host.is_none() && hosted {
            let message =
                format!("{} has no room to be entered from; it opens to the circulation instead", room.kind.label);
            reading.assumptions.push(Note::new("no_host", message));
        }
        rooms[i].host = host;
    }
}

/// Puts the rooms that a lock is there for behind it, also where the prompt does not say which: those that it names with the lock, else
/// those of the first of the types that the lock's own lists of which there are any. A lock with nothing to go on to is said.
pub(super) fn hang_on_locks(reading: &mut Reading, rooms: &mut [Planned]) {
    let locks: Vec<usize> = (0..rooms.len()).filter(|&i| !rooms[i].kind.locks.is_empty()).collect();
    // locks that are nothing else come first: one dresses before the airlock of a clean room
    let (only, also): (Vec<usize>, Vec<usize>) = locks.into_iter().partition(|&i| is_only_lock(rooms[i].kind));
    for round in 0..MOST_BEHIND {
        for &lock in only.iter().chain(&also) {
            let behind = rooms.iter().filter(|r| r.host == Some(lock)).count();
            // each lock has its first room before one of them has its second
            if behind == round
                && let Some(room) = next_behind(reading, rooms, lock)
            {
                rooms[room].host = Some(lock);
            }
        }
    }
    for &lock in only.iter().filter(|&&i| rooms.iter().all(|r| r.host != Some(i))) {
        let name = rooms[lock].called.clone().unwrap_or_else(|| rooms[lock].kind.label.clone());
        let message = format!("{name} leads nowhere: there is no room here that lies behind such a lock");
        reading.conflicts.push(Note::new("lock_leads_nowhere", message));
    }
}

/// Returns the only storey that the prompt puts rooms of a type on.
fn only_storey(reading: &Reading, room_type: &str) -> Option<Where> {
    let mut on = reading.storeys.wanted.iter().filter(|w| w.room_type == room_type).map(|w| w.at);
    on.next().filter(|_| on.next().is_none())
}

/// Returns true for rooms that are there for nothing but to be passed.
fn is_only_lock(kind: &RoomType) -> bool {
    kind.tags.iter().any(|tag| tag == tags::LOCK)
}

/// Returns the next room to be put behind a lock: of the type of those that are there already, if any are.
fn next_behind(reading: &Reading, rooms: &[Planned], lock: usize) -> Option<usize> {
    let kind = rooms[lock].kind;
    let first = rooms.iter().find(|r| r.host == Some(lock)).map(|r| &r.room_type);
    let told = |r: &Planned| {
        let named = |a: &str, b: &str| a == rooms[lock].room_type && b == r.room_type;
        reading.wishes.pairs.iter().any(|p| named(&p.a, &p.b) || named(&p.b, &p.a))
    };
    let rank = |r: &Planned| kind.locks.iter().position(|id| *id == r.room_type);
    let storey = only_storey(reading, &rooms[lock].room_type);
    let elsewhere = |r: &Planned| only_storey(reading, &r.room_type).is_some_and(|at| storey.is_some_and(|s| s != at));
    let free = |r: &Planned| {
        let alike = first.is_none_or(|id| *id == r.room_type);
        r.host.is_none() && r.kind.zone != Zone::Circulation && alike && rank(r).is_some() && !elsewhere(r)
    };
    let candidates = (0..rooms.len()).filter(|&i| i != lock && free(&rooms[i]));
    candidates.min_by_key(|&i| {
        let room = &rooms[i];
        (!told(room), room.unit != rooms[lock].unit, rank(room), i)
    })
}

/// Returns true for a pair of rooms of which the first cannot be entered through the second, so that it is beside it and not behind it.
pub(super) fn is_beside(reading: &Reading, pair: &Pair) -> bool {
    let of = |id: &str| reading.domain.room_type_or_generic(id);
    pair.belongs && of(&pair.a).access != Access::Host && !of(&pair.a).may_hang_on(of(&pair.b))
}

/// Returns the room that a lock of a pair is the way into: one more of the pair's that has none yet. Locks serve, and are the way
/// (`hosts`) to rooms larger than themselves.
fn behind_lock(domain: &Domain, rooms: &[Planned], lock: usize, pair: &Pair) -> Option<usize> {
    let kind = rooms[lock].kind;
    let larger = |t: &RoomType| t.area_m2.target > kind.area_m2.target && !t.wet;
    let before = |t: &RoomType| t.access == Access::Host && t.hosts.contains(&kind.id) && larger(t);
    let serves = matches!(kind.zone, Zone::Service | Zone::Circulation) && kind.access != Access::Host;
    let free = |r: &Planned| {
        r.room_type == pair.b
            && r.host.is_none()
            && r.kind.access != Access::Host
            && (larger(r.kind) || r.name.is_some())
    };
    let locks = !kind.locks.is_empty() || serves && domain.room_types.iter().any(before);
    if !locks {
        return None;
    }
    rooms.iter().position(free)
}

/// Lets the only bathroom of a home open to its hall where those of other bedrooms would have to go through one to it.
pub(super) fn share_last_bathroom(reading: &mut Reading, rooms: &mut [Planned]) {
    if !is_dwelling(reading.program) || reading.single {
        return;
    }
    let bathes = |r: &Planned| reading.wet.is_bathroom(r.kind) || r.room_type == words().dwelling.shower;
    let sleeps = |r: &Planned| r.kind.zone == Zone::Night && sleeps(reading.domain, r.kind).is_some();
    let own = |i: usize| rooms.iter().any(|r| bathes(r) && r.host == Some(i));
    let without = (0..rooms.len()).filter(|&i| sleeps(&rooms[i]) && !own(i)).count();
    let shared = rooms.iter().any(|r| bathes(r) && r.host.is_none());
    let last = rooms.iter().rposition(|r| bathes(r) && r.host.is_some() && r.kind.access != Access::Host);
    // where several rooms have their own, what the others lack is said
    let hosted = rooms.iter().filter(|r| bathes(r) && r.host.is_some()).count();
    let Some(last) = last.filter(|_| without > 0 && !shared && hosted == 1) else { return };
    rooms[last].host = None;
    let label = rooms[last].kind.label.to_lowercase();
    let message = format!("no other {label} serves all bedrooms; it opens to the hall and not into one of them");
    reading.assumptions.push(Note::new("shared_bathroom", message));
}

/// Gives the largest bedroom of a home its own of several bathrooms, where those that are left serve the others: nobody who has
/// two baths crosses the hall to both.
pub(super) fn give_main_bedroom_a_bath(reading: &mut Reading, rooms: &mut [Planned]) {
    let d = &words().dwelling;
    let shared_home = reading.building_type.as_ref().is_some_and(|b| d.shared.contains(b));
    if !is_dwelling(reading.program) || reading.single || shared_home {
        return;
    }
    let bathes = |r: &Planned| reading.wet.is_bathroom(r.kind);
    let sleeps =
        |r: &Planned| r.kind.zone == Zone::Night && r.host.is_none() && sleeps(reading.domain, r.kind).is_some();
    let told = |id: &String| {
        let paired = reading.wishes.pairs.iter().any(|p| &p.a == id || &p.b == id);
        paired
            || reading.wishes.apart.iter().any(|a| a.rooms.contains(id))
            || reading.storeys.wanted.iter().any(|w| &w.room_type == id)
    };
    let own = rooms.iter().any(|r| bathes(r) && r.host.is_some());
    let baths: Vec<usize> =
        (0..rooms.len()).filter(|&i| rooms[i].room_type == d.bathroom && rooms[i].host.is_none()).collect();
    // each storey keeps one for whoever is there
    let toilets = rooms.iter().filter(|r| reading.wet.has_toilet(r.kind) && r.host.is_none()).count();
    let enough = baths.len() > 1 && toilets > reading.storeys.above_ground().max(1);
    if own || !enough || told(&d.bathroom) || rooms.iter().filter(|r| sleeps(r)).count() < 2 {
        return;
    }
    let bedrooms = (0..rooms.len()).filter(|&i| rooms[i].room_type == d.bedroom && sleeps(&rooms[i]));
    let main = bedrooms.max_by(|&a, &b| rooms[a].reckoned_m2().total_cmp(&rooms[b].reckoned_m2()).then(b.cmp(&a)));
    let (Some(main), Some(&bath)) = (main, baths.last()) else { return };
    rooms[bath].host = Some(main);
    if let Some(kind) = reading.domain.room_type(&d.ensuite).filter(|_| rooms[bath].called.is_none()) {
        rooms[bath].called = Some(kind.label.clone());
    }
    let message = "of several bathrooms one is entered from the main bedroom".to_owned();
    reading.assumptions.push(Note::new(EN_SUITE, message));
}

/// Lets the bathroom that the main bedroom was given open to the hall where the others on its storey have none; returns true where
/// it did. Which storey that is, is known of a draft of the rooms.
pub(crate) fn share_bath_of_storey(reading: &mut Reading, rooms: &mut [Planned], draft: &SceneGraph) -> bool {
    let given = |note: &Note| note.code == EN_SUITE;
    let d = &words().dwelling;
    let own = |r: &Planned| r.room_type == d.bathroom && r.host.is_some();
    let Some(bath) = rooms.iter().position(own).filter(|_| reading.assumptions.iter().any(given)) else { return false };
    let level = |i: usize| draft.rooms.get(i).map(|r| r.level);
    let here = |i: &usize| level(*i) == level(bath);
    let others = (0..rooms.len()).filter(|i| here(i) && Some(*i) != rooms[bath].host);
    let asleep = others.filter(|&i| sleeps(reading.domain, rooms[i].kind).is_some() && rooms[i].host.is_none()).count();
    let bathes = |r: &Planned| reading.wet.is_bathroom(r.kind) || r.room_type == d.shower;
    let shared = (0..rooms.len()).filter(here).any(|i| bathes(&rooms[i]) && rooms[i].host.is_none());
    if asleep == 0 || shared {
        return false;
    }
    (rooms[bath].host, rooms[bath].called) = (None, None);
    reading.assumptions.retain(|note| !given(note));
    true
}
