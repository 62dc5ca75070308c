//! Toilets for the people of a building that is no home: closets by their number, and one for wheelchairs on every storey that
//! visitors come to. They join the rooms of any list, unless it says that it is all there is to be.

use d3dgen_model::domain::{Domain, Furnishing, RoomType};
use d3dgen_model::sanitary::{self, LEFT_OUT, Need};
use d3dgen_model::scene_graph::{Note, SceneGraph};

use super::planned::Planned;
use super::{vital, workers};
use crate::levels::storeys::Wanted;
use crate::reading::Reading;
use crate::tokens::storey::Where;
use crate::tokens::words::words;

/// Rooms with toilets that are added for people, at most: beyond, a building has units with their own.
const MOST_ADDED: usize = 8;
/// Code of the note that says which were added.
const ADDED: &str = "toilets_added";
/// Why there is one for wheelchairs on every storey.
const BY_STOREY: &str = "IBC 1110.2, DIN 18040-1 5.3.3";
/// Floor of a toilet beside what grows with its closets, m^2: the way in and the basins.
const SPARE_M2: f64 = 3.0;

/// Adds the toilets that the rooms of a draft lack; returns true where something changed.
pub(crate) fn complete<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>, draft: &SceneGraph) -> bool {
    if reading.single || !sanitary::applies(draft, reading.domain) || rules_out(reading) {
        return false;
    }
    let levels = sanitary::without_accessible(draft, reading.domain);
    let need = need_of(reading, rooms, draft);
    if reading.only {
        return leave_out(reading, rooms, &levels, "the list was said to be all there is");
    }
    let accessible = give_accessible(reading, rooms, &levels);
    if reading.total.is_some() && !rooms.iter().any(|r| sanitary::is_for_all(reading.domain, r.kind)) {
        return leave_out(reading, rooms, &levels, "the number of rooms leaves no place for it") || accessible;
    }
    let closets = reading.total.is_none() && give_closets(reading, rooms, &need);
    let one_storey = draft.rooms.iter().all(|r| r.level == 0);
    let named = need.parted && one_storey && name_by_sex(reading.domain, rooms);
    accessible || closets || named
}

/// Returns true where the prompt wants no toilets.
fn rules_out(reading: &Reading) -> bool {
    words().dwelling.toilets.iter().any(|id| reading.wishes.forbidden.contains(id))
}

fn need_of(reading: &Reading, rooms: &[Planned], draft: &SceneGraph) -> Need {
    let drafted = |r: &Planned| r.people_area_m2.or(r.area_m2).unwrap_or(r.kind.area_m2.target);
    let own = rooms.iter().map(|r| (r.kind, drafted(r), r.occupants));
    let mut need = sanitary::needed(reading.domain, own);
    // who works there and sits at no desk goes to the toilet all the same
    need.people = need.people.max(draft.occupancy.staff.unwrap_or(0));
    need
}

/// Says which toilets a list leaves out; returns true where it leaves out any.
fn leave_out(reading: &mut Reading, rooms: &[Planned], levels: &[i32], why: &str) -> bool {
    let none = !rooms.iter().any(|r| sanitary::is_for_all(reading.domain, r.kind));
    let said = reading.conflicts.iter().any(|note| note.code == LEFT_OUT);
    if said || !none && levels.is_empty() {
        return false;
    }
    let what = if none { "toilet and one for wheelchairs" } else { "toilet for wheelchairs on every storey" };
    let message = format!("such a building needs a {what}; {why}, so none was added");
    reading.conflicts.push(Note::new(LEFT_OUT, message));
    true
}

/// Gives each of these storeys a toilet for wheelchairs: in a fixed number of rooms, in place of a plain one or of another that
/// nobody named.
fn give_accessible<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>, levels: &[i32]) -> bool {
    let Some(kind) = accessible_kind(reading) else { return false };
    // those that are on no storey yet go where one is missing before there are more of them
    let pinned = |w: &&Wanted| w.room_type == kind.id;
    let pinned: usize = reading.storeys.wanted.iter().filter(pinned).map(|w| w.count as usize).sum();
    let there = rooms.iter().filter(|r| r.room_type == kind.id).count();
    let several = reading.storeys.levels.len() > 1;
    let loose = if several { there.saturating_sub(pinned) } else { 0 };
    for (k, level) in levels.iter().enumerate() {
        if k >= loose && !put_accessible(reading, rooms, kind) {
            return leave_out(reading, rooms, levels, "the number of rooms leaves no place for it") || k > 0;
        }
        if several {
            reading.storeys.wanted.push(Wanted { room_type: kind.id.clone(), count: 1, at: Where::Level(*level) });
        }
    }
    let said = reading.assumptions.iter().any(|note| note.code == ADDED);
    if levels.len() > loose && !said {
        let what = kind.label.to_lowercase();
        let message = format!("{what} added on each storey that visitors come to and that had none ({BY_STOREY})");
        reading.assumptions.push(Note::new(ADDED, message));
    }
    !levels.is_empty()
}

/// Adds a toilet for wheelchairs, in a fixed number of rooms in place of a plain one or of another; false where none can be spared.
fn put_accessible<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>, kind: &'a RoomType) -> bool {
    let room = Planned::new(&kind.id, kind);
    if reading.total.is_none() {
        rooms.push(room);
        return true;
    }
    let plain = |r: &Planned| !r.requested && is_plain(reading.domain, r.kind);
    match rooms.iter().rposition(plain) {
        Some(i) => {
            rooms[i] = Planned { unit: rooms[i].unit.clone(), ..room };
            true
        }
        None => vital::put(reading, rooms, room),
    }
}

/// Returns the domain's usual toilet for wheelchairs: that of its program, else the smallest.
fn accessible_kind<'a>(reading: &Reading<'a>) -> Option<&'a RoomType> {
    let domain = reading.domain;
    let fits = |k: &&RoomType| sanitary::is_accessible(domain, k) && reading.may_add(&k.id);
    let by_program = reading.program.rooms.iter().filter_map(|e| domain.room_type(&e.room_type)).find(fits);
    let smallest =
        || domain.room_types.iter().filter(fits).min_by(|a, b| a.area_m2.target.total_cmp(&b.area_m2.target));
    by_program.or_else(smallest)
}

/// Gives the people closets enough: toilets grow, then there are more of them, for women and men where they are many.
fn give_closets<'a>(reading: &mut Reading<'a>, rooms: &mut Vec<Planned<'a>>, need: &Need) -> bool {
    let domain = reading.domain;
    // storeys and units of large buildings have their own
    if rooms.iter().any(|r| r.unit.is_some()) {
        return false;
    }
    let own = |r: &Planned| sanitary::is_for_all(domain, r.kind);
    let count = |rooms: &[Planned]| -> u32 {
        rooms.iter().filter(|r| own(r)).map(|r| sanitary::closets(domain, r.kind, r.reckoned_m2())).sum()
    };
    // a list that counts its toilets has as many
    let counted = |r: &Planned| reading.wishes.wishes.iter().any(|w| w.exact && w.room_type == r.room_type);
    let fixed = rooms.iter().any(|r| is_plain(domain, r.kind) && r.requested && counted(r));
    let have = count(rooms);
    // those who sleep there and nobody else have their own
    let own_only = need.people == 0 && rooms.iter().any(|r| reading.wet.has_toilet(r.kind));
    if have >= need.closets || own_only {
        return false;
    }
    let Some(kind) = plain_kind(reading, need) else { return false };
    let least = if need.parted && !fixed { words().sexes.len() } else { usize::from(!fixed) };
    let there = rooms.iter().filter(|r| is_plain(domain, r.kind)).count();
    rooms.extend((there..least).map(|_| Planned::new(&kind.id, kind)));
    let missing = need.closets.saturating_sub(count(rooms));
    grow(reading, rooms, missing, need.parted);
    let mut added = 0;
    while !fixed && count(rooms) < need.closets && added < MOST_ADDED {
        rooms.push(Planned::new(&kind.id, kind));
        added += 1;
    }
    let message = match need.people {
        0 => format!("{} added: the list of rooms had none", kind.label.to_lowercase()),
        n => format!(
            "{n} people have {} water closets, {} were needed ({})",
            count(rooms),
            need.closets,
            need.sources.join("; ")
        ),
    };
    reading.assumptions.push(Note::new("toilets_by_people", message));
    true
}

/// Returns what is added for those who walk: the toilet of the program, else one with as many closets as they need.
fn plain_kind<'a>(reading: &Reading<'a>, need: &Need) -> Option<&'a RoomType> {
    let domain = reading.domain;
    let fits = |k: &&RoomType| is_plain(domain, k) && reading.may_add(&k.id);
    let grows = |k: &&RoomType| sanitary::growing_line(domain, k).is_some();
    let of_program = || reading.program.rooms.iter().filter_map(|e| domain.room_type(&e.room_type)).filter(fits);
    let all = || domain.room_types.iter().filter(fits);
    let many = need.closets > 2;
    let growing = || of_program().find(grows).or_else(|| all().find(grows));
    let usual = || of_program().next().or_else(|| all().next());
    if many { growing().or_else(usual) } else { usual() }
}

/// Gives toilets that hold more closets on more floor so many more.
fn grow(reading: &Reading, rooms: &mut [Planned], missing: u32, parted: bool) {
    let domain = reading.domain;
    let places: Vec<usize> = (0..rooms.len()).filter(|&i| growing_line(domain, &rooms[i]).is_some()).collect();
    let among = if parted { places.len().max(1) } else { 1 };
    let each = missing.div_ceil(among as u32);
    for i in places.into_iter().take(among).filter(|_| missing > 0) {
        let Some(line) = growing_line(domain, &rooms[i]) else { continue };
        let now = line.units(rooms[i].reckoned_m2());
        let area = SPARE_M2 + line.area_per_item_m2 * f64::from((now + each).min(line.max));
        let area = area.max(rooms[i].reckoned_m2());
        rooms[i].size_for_people(area);
    }
}

/// Returns the line by which a toilet for those who walk has more closets, where the prompt gives it no area.
fn growing_line<'a>(domain: &Domain, room: &Planned<'a>) -> Option<&'a Furnishing> {
    let free = room.area_m2.is_none() && is_plain(domain, room.kind);
    free.then(|| sanitary::growing_line(domain, room.kind)).flatten()
}

/// Returns true for toilets that all may use and that are not made for wheelchairs.
fn is_plain(domain: &Domain, kind: &RoomType) -> bool {
    sanitary::is_for_all(domain, kind) && !sanitary::is_accessible(domain, kind)
}

/// Calls toilets of a kind those of women and of men in turn, where they are as many for the ones as for the others; returns true
/// where it did.
fn name_by_sex(domain: &Domain, rooms: &mut [Planned]) -> bool {
    let free = |r: &Planned| is_plain(domain, r.kind) && !r.requested && r.called.is_none();
    let sexes = words().sexes.len().max(1);
    let alike = |id: &str| (0..rooms.len()).filter(|&i| free(&rooms[i]) && rooms[i].kind.id == id).collect::<Vec<_>>();
    let kinds = rooms.iter().filter(|r| free(r)).map(|r| alike(&r.kind.id));
    let pairs = kinds.filter(|same| same.len() >= sexes && same.len().is_multiple_of(sexes)).max_by_key(Vec::len);
    let Some(toilets) = pairs else { return false };
    for (k, i) in toilets.into_iter().enumerate() {
        rooms[i].called = Some(workers::whose(k, &rooms[i].kind.label));
    }
    true
}
