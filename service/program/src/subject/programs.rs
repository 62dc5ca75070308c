//! Which program of its domain a building has.

use d3dgen_model::domain::{Domain, Program};

use crate::tokens::words::{ByBedrooms, words};
use crate::wished::wishes::Wishes;

/// Most people of a room to work in: one for more is there to meet or wash in.
pub(crate) const MOST_IN_OFFICE: u32 = 4;

/// Returns true for programs of buildings that people live in.
pub(crate) fn is_dwelling(program: &Program) -> bool {
    let d = &words().dwelling;
    let first = program.rooms.first().is_some_and(|r| r.room_type == d.studio);
    first || program.rooms.iter().any(|r| r.room_type == d.bedroom || r.room_type == d.living)
}

/// Returns the program of a building type, else the first of the domain.
pub(crate) fn program_of<'a>(domain: &'a Domain, building_type: Option<&str>) -> &'a Program {
    building_type
        .and_then(|id| domain.building_type(id))
        .and_then(|b| domain.program(&b.program))
        .or_else(|| domain.programs.first())
        .expect("a domain's check demands a program")
}

/// Returns the program of a home with as many bedrooms as the prompt gives it.
pub(crate) fn program_by_bedrooms<'a>(domain: &'a Domain, program: &'a Program, wishes: &Wishes) -> &'a Program {
    let bedrooms = wishes.wishes.iter().find(|w| w.exact && w.room_type == words().dwelling.bedroom).map(|w| w.count);
    let own = |b: &&ByBedrooms| b.programs.contains(&program.id) && Some(b.bedrooms) == bedrooms;
    let other = words().dwelling.by_bedrooms.iter().find(own).and_then(|b| domain.program(&b.program));
    other.unwrap_or(program)
}

/// Returns true for programs of offices: rooms that serve all grow with those who work there.
pub(crate) fn is_office(program: &Program) -> bool {
    !is_dwelling(program) && program.rooms.iter().any(|e| e.area_per_person_m2.is_some())
}
