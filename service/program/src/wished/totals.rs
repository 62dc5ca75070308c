//! How large the building is and how many rooms it has, where the prompt or the request says so.

use d3dgen_model::scene_graph::Note;
use d3dgen_model::stage::Error;

use super::wishes::{self, Text, Wishes};
use crate::named::mention::{Mention, What};
use crate::request::{MANY, MAX_AREA_M2, MAX_ROOMS, Request, refused};

/// Returns the area of the building, m^2.
pub(crate) fn total_area(text: &Text, request: &Request, conflicts: &mut Vec<Note>) -> Option<f64> {
    let named = text.areas.iter().filter(|a| !wishes::is_room_area(text, a)).map(|a| a.value).next();
    let named = named.filter(|&area| {
        let sane = (5.0..=MAX_AREA_M2).contains(&area);
        if !sane {
            conflicts.push(Note::new(
                "impossible_area",
                format!("an area of {area:.1} m2 was left out; 5 to {MAX_AREA_M2} m2 can be planned"),
            ));
        }
        sane
    });
    if let (Some(flag), Some(named)) = (request.area_m2, named)
        && (flag - named).abs() > 0.01
    {
        conflicts.push(Note::new(
            "area_flag",
            format!("the prompt says {named:.1} m2, the request {flag:.1} m2; {flag:.1} m2 was used"),
        ));
    }
    // One third of a millimeter squared of noise from unit factors helps nobody.
    request.area_m2.or(named).map(|a| (a * 100.0).round() / 100.0)
}

/// Returns the number of rooms that the prompt gives the building by its name.
pub(crate) fn said_total(mentions: &[Mention]) -> Option<u32> {
    let said = mentions.iter().find(|m| m.what == What::Total && !m.article && !m.vague && m.count.is_some())?;
    u32::try_from(said.count?).ok().filter(|n| *n > 0)
}

/// Returns how many rooms there are to be, where that is fixed.
///
/// # Errors
/// `Refused` for more than one world has.
pub(crate) fn total_rooms(
    request: &Request,
    mentions: &[Mention],
    wishes: &Wishes,
    conflicts: &mut Vec<Note>,
) -> Result<Option<u32>, Error> {
    let named = mentions.iter().filter(|m| m.what == What::Total && !m.article && !m.vague).find_map(|m| m.count);
    if let Some(n) = named.filter(|n| *n > MANY) {
        return Err(refused(format!(
            "the prompt asks for {n} rooms; one world has {MAX_ROOMS} at most, ask for fewer"
        )));
    }
    let named = named.filter(|&n| {
        if n <= 0 {
            conflicts.push(Note::new(
                "impossible_count",
                format!("{n} rooms cannot be built; the usual number was planned"),
            ));
        }
        n > 0
    });
    let named = named.and_then(|n| u32::try_from(n).ok());
    if let (Some(flag), Some(n)) = (request.rooms, named)
        && flag != n
    {
        conflicts
            .push(Note::new("rooms_flag", format!("the prompt says {n} rooms, the request {flag}; {flag} was used")));
    }
    let total = request.rooms.or(named);
    let listed: u32 = wishes.wishes.iter().map(|w| w.count).fold(0, u32::saturating_add);
    if let Some(n) = total.filter(|n| *n < listed && listed <= MAX_ROOMS) {
        conflicts.push(Note::new(
            "more_rooms_listed",
            format!("{n} rooms were asked for in total, but {listed} are listed; {listed} were planned"),
        ));
        return Ok(Some(listed));
    }
    Ok(total)
}
