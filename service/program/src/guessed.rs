//! Types of rooms that a plan gives no name: by their size and place in a building whose program is known.

use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE, Program, RoomType, Zone};
use d3dgen_model::scene_graph::Note;

use super::given::Label;
use super::tokens::text::{Phrases, tokens};

/// The word for a room that says nothing else, as programs explain it (`means`).
const ROOM: &str = "room";
/// Entries at the head of a program among which its main room is.
const HEAD: usize = 6;
/// Rooms alike along a corridor from which on they are taken for what the building has most of.
const ALIKE: usize = 3;
/// Most of one type that a program has when it is what the building has most of.
const MANY: u32 = 4;
/// A room is as large as such rooms are when it has this share of their least area, and at most so much of their largest.
const LEAST_SHARE: f64 = 0.7;
const MOST_SHARE: f64 = 1.6;
/// A main room is at least this share of the largest room of the plan.
const LARGEST_SHARE: f64 = 0.7;

/// Gives types to unnamed rooms of the generic type; notes say what was guessed.
pub(super) fn unnamed(labels: &[Label], room_types: &mut [String], titles: &[String], domain: &Domain) -> Vec<Note> {
    let Some(program) = program(titles, domain) else { return Vec::new() };
    let mut notes = Vec::new();
    if let Some(kind) = most_of(program, domain) {
        let alike = along_corridors(labels, room_types, kind, domain);
        if alike.len() >= ALIKE {
            alike.iter().for_each(|i| room_types[*i].clone_from(&kind.id));
            let message = format!(
                "{} rooms without a name along a corridor were guessed to be `{}`, of which a {} has most; --room-type \
                 \"NAME=TYPE\" says better",
                alike.len(),
                kind.id,
                program.title.to_lowercase()
            );
            notes.push(Note::new("rooms_guessed", message));
        }
    }
    if let Some((room, kind)) = main_room(labels, room_types, program, domain) {
        room_types[room].clone_from(&kind.id);
        let message = format!(
            "the largest room without a name ({:.0} m2) was guessed to be `{}`, the main room of a {}; --room-type \"NAME=TYPE\" \
             says better",
            labels[room].area_m2,
            kind.id,
            program.title.to_lowercase()
        );
        notes.push(Note::new("main_room_guessed", message));
    }
    notes
}

/// Returns the program of the building that a title names, the domain's first one where none does.
fn program<'d>(titles: &[String], domain: &'d Domain) -> Option<&'d Program> {
    let named = domain.building_types.iter().find(|building| {
        building.keywords.iter().any(|(language, words)| {
            let mut phrases = Phrases::new(language);
            words.iter().for_each(|w| phrases.insert(w, ()));
            titles.iter().any(|title| {
                let list = tokens(&title.replace('_', " "));
                (0..list.len()).any(|i| phrases.longest_at(&list, i).is_some())
            })
        })
    });
    let of = |id: &str| domain.programs.iter().find(|p| p.id == id);
    named.and_then(|b| of(&b.program)).or(domain.programs.first())
}

/// Returns the type that a building has most rooms of: what `room` means in it, or what its program has many of.
fn most_of<'d>(program: &Program, domain: &'d Domain) -> Option<&'d RoomType> {
    if let Some(id) = program.means.get(ROOM) {
        return domain.room_type(id);
    }
    let most = program.rooms.iter().filter(|r| r.max >= MANY).max_by_key(|r| r.max)?;
    domain.room_type(&most.room_type).filter(|k| k.zone != Zone::Circulation)
}

fn is_free(label: &Label, room_type: &str) -> bool {
    label.unnamed && room_type == GENERIC_ROOM_TYPE
}

/// Returns unnamed rooms with a door to circulation that are as large as rooms of a type are.
fn along_corridors(labels: &[Label], room_types: &[String], kind: &RoomType, domain: &Domain) -> Vec<usize> {
    let circulates = |room: &usize| {
        room_types.get(*room).and_then(|id| domain.room_type(id)).is_some_and(|k| k.zone == Zone::Circulation)
    };
    let fits = |area: f64| area >= LEAST_SHARE * kind.area_m2.min && area <= MOST_SHARE * kind.area_m2.max;
    (0..labels.len())
        .filter(|i| is_free(&labels[*i], &room_types[*i]) && fits(labels[*i].area_m2))
        .filter(|i| labels[*i].beside.iter().any(circulates))
        .collect()
}

/// Returns the largest unnamed room and the type of the program's main room, where the plan has none of that type yet.
fn main_room<'d>(
    labels: &[Label],
    room_types: &[String],
    program: &Program,
    domain: &'d Domain,
) -> Option<(usize, &'d RoomType)> {
    let kinds = program.rooms.iter().take(HEAD).filter_map(|r| domain.room_type(&r.room_type));
    let main = kinds
        .filter(|k| k.zone != Zone::Circulation && k.id != GENERIC_ROOM_TYPE)
        .max_by(|a, b| a.area_m2.max.total_cmp(&b.area_m2.max))?;
    let largest = labels.iter().map(|l| l.area_m2).fold(0.0, f64::max);
    let free = (0..labels.len()).filter(|i| is_free(&labels[*i], &room_types[*i]));
    let room = free.max_by(|a, b| labels[*a].area_m2.total_cmp(&labels[*b].area_m2))?;
    let area = labels[room].area_m2;
    let is_main = area >= LARGEST_SHARE * largest && area >= LEAST_SHARE * main.area_m2.min;
    (is_main && !room_types.contains(&main.id)).then_some((room, main))
}
