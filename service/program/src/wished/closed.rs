//! Lists of rooms: whether one names all rooms there are to be, and what it takes for granted.

use d3dgen_model::domain::{Domain, Occupants, Program, ProgramRoom, RoomType, Zone};
use d3dgen_model::offer;
use d3dgen_model::scene_graph::Note;
use d3dgen_model::style::LayoutStyle;

use super::wishes::{PerHost, Wish, Wishes};
use crate::built::{layout, workers};
use crate::named::mention::{Mention, What};
use crate::people::beds;
use crate::people::heads::People;
use crate::subject::building::Building;
use crate::subject::programs::{MOST_IN_OFFICE, is_dwelling};
use crate::tokens::text::Token;
use crate::tokens::words::{Spoken, Tag, tag_end, words};

/// A building's first room that is so many times larger than all listed ones is what it is for.
const MAIN_ROOM_SHARE: f64 = 1.5;

/// Types of rooms from which on a list is a long one: who names so many means no others.
const LONG_LIST: usize = 4;

/// Returns true when the listed rooms are the whole building.
pub(crate) fn is_closed(
    wishes: &Wishes,
    tokens: &[Token],
    building: &Building,
    (domain, lives): (&Domain, bool),
) -> bool {
    if building.listed_type && building.list_from > 0 {
        return false;
    }
    let colon = tokens.get(building.list_from).is_some_and(|t| t.mark() == Some(':'));
    is_whole(wishes, colon, (domain, lives))
}

/// Returns true for a list that has all rooms of a building, by what is in it; `colon` where one stands before it.
pub(crate) fn is_whole(wishes: &Wishes, colon: bool, (domain, lives): (&Domain, bool)) -> bool {
    let listed: Vec<_> = wishes.wishes.iter().filter(|w| w.listed).collect();
    let types = listed.len();
    // how many toilets a long list has is no news about its other rooms
    let serves = |w: &Wish| domain.room_type(&w.room_type).is_some_and(|k| k.zone == Zone::Service);
    let long = !lives && types >= LONG_LIST;
    let open = listed.iter().any(|w| !(w.exact || long && serves(w)));
    // "no kitchen, no bathroom" in a list of rooms are items of it
    let items = types + wishes.forbidden.len();
    // "3BHK with a balcony", "four bedrooms and a garage": what every dwelling has goes without saying
    let settled = |id: &String| wishes.wishes.iter().any(|w| &w.room_type == id) || wishes.forbidden.contains(id);
    let whole = !lives || words().dwelling.essential.iter().all(|any| any.iter().any(settled));
    // "each bedroom has an en suite" leaves open how many there are
    let counted = |p: &PerHost| p.host.as_ref().is_none_or(|h| wishes.wishes.iter().any(|w| &w.room_type == h));
    let whole = whole && wishes.per_host.iter().all(counted);
    !open && whole && types >= 1 && (items >= 3 || types >= 2 && colon)
}

/// Returns true for rooms listed behind the name of a building and no colon: these are what it has, and perhaps not all.
/// Behind a colon too where rooms that nobody thinks of serve the others (`served`): an emergency department has its utilities;
/// but not where the prompt says how the rooms lie, for then it has them all in mind.
pub(crate) fn joins_a_name(building: &Building, tokens: &[Token], language: &str, served: bool) -> bool {
    let colon = !served && tokens.iter().any(|t| t.mark() == Some(':'));
    !colon && is_named_first(building, language)
}

/// Returns true for the name of a building before its rooms.
pub(crate) fn is_named_first(building: &Building, language: &str) -> bool {
    // where the name comes last, a list goes with it all the same
    building.head.is_some() && (building.list_from > 0 || matches!(language, "zh" | "ko"))
}

/// Returns true for "only three offices", "exactly 5 rooms", "nothing else": no room may be added.
pub(crate) fn says_only(tokens: &[Token], mentions: &[Mention], spoken: &[&Spoken]) -> bool {
    (0..tokens.len()).any(|i| {
        let Some(end) = tag_end(spoken, tokens, i, Tag::Only) else { return false };
        let from = |m: &Mention| m.from.min(m.span.start);
        let next = mentions.iter().filter(|m| from(m) >= end).min_by_key(|m| from(m));
        let rooms = next.filter(|m| m.room_type().is_some() || m.what == What::Total);
        // "nothing else", but not "for staff only"
        let closes = end > i + 1 && tokens.get(end).is_none_or(Token::is_mark);
        closes || rooms.is_some_and(|m| from(m) <= end + 1)
    })
}

/// Adds to a list of rooms the one the building is for where the list takes it for granted: a laboratory's laboratory,
/// a supermarket's sales floor, the desks of those who work there, in shared offices where the layout is to be cellular. A
/// dwelling has no such room.
pub(crate) fn add_main_room(
    wishes: &mut Wishes,
    program: &Program,
    domain: &Domain,
    (people, desks_told): (&People, u32),
    named: Option<&str>,
    layout: Option<LayoutStyle>,
) -> Option<Note> {
    let heads = &people.occupancy;
    let workers = heads.staff.max(heads.desks);
    let left_out = workers::room_left_out(wishes, program, domain, workers, desks_told);
    let kind = left_out.or_else(|| main_room_left_out(wishes, program, domain, people, named))?;
    let ruled_out = wishes.forbidden.contains(&kind.id);
    let layout = if ruled_out { Some(LayoutStyle::Cellular) } else { layout };
    if let Some(people) = workers.filter(|_| layout == Some(LayoutStyle::Cellular))
        && let Some(seated) = workers::seat_in_listed(wishes, domain, people)
    {
        return Some(seated);
    }
    let laid_out = layout.zip(workers).and_then(|(l, n)| layout::in_place_of(domain, &kind.id, l, n));
    let (kind, count) = laid_out.or((!ruled_out).then_some((kind, 1)))?;
    let label = kind.label.to_lowercase();
    wishes.wishes.insert(0, Wish { count, ..Wish::one(&kind.id, &label) });
    Some(Note::new("main_room", format!("the list of rooms takes the {label} for granted; it was added")))
}

/// Returns the room that a program begins with, where the list has nothing that could stand for it.
fn main_room_left_out<'a>(
    wishes: &Wishes,
    program: &Program,
    domain: &'a Domain,
    people: &People,
    named: Option<&str>,
) -> Option<&'a RoomType> {
    let main = program.rooms.first()?;
    let listed = |id: &str| wishes.wishes.iter().any(|w| w.room_type == id);
    // "a ward with 16 beds in double rooms" has no others
    let slept_in = main.occupants == Occupants::Beds && beds::names_rooms(domain, wishes);
    let ruled_out = wishes.forbidden.contains(&main.room_type);
    if is_dwelling(program) || slept_in || listed(&main.room_type) || ruled_out {
        return None;
    }
    let works = |r: &ProgramRoom| {
        let seat = r.area_per_occupant_m2.is_some() || r.occupants_per_room.is_some_and(|n| n <= MOST_IN_OFFICE);
        r.occupants == Occupants::Staff && seat
    };
    let team =
        |w: &Wish| domain.room_type(&w.room_type).and_then(|k| offer::desks(domain, k)).is_some_and(|d| d[1] > 2);
    let placed = domain.programs.iter().flat_map(|p| &p.rooms).any(|r| works(r) && listed(&r.room_type))
        || wishes.wishes.iter().any(team);
    let size = |id: &str| domain.room_type_or_generic(id).area_m2.target;
    let largest = wishes.wishes.iter().map(|w| size(&w.room_type)).fold(0.0, f64::max);
    let heads = people.occupancy.staff.or(people.occupancy.desks).is_some() && works(main);
    // desks elsewhere stand for the office of the staff, not for the hall of a warehouse
    let placed = placed && works(main);
    let needed = named == Some(main.room_type.as_str())
        || !placed && (heads || size(&main.room_type) > MAIN_ROOM_SHARE * largest);
    needed.then(|| domain.room_type_or_generic(&main.room_type))
}
