//! Who lives, works, sleeps and is treated in the building, and the rooms, beds, desks and seats that follow from it.

pub(super) mod apiece;
pub(super) mod beds;
pub(super) mod counted;
pub(super) mod dwelling;
pub(super) mod ensuites;
pub(super) mod groups;
pub(super) mod heads;
pub(super) mod held;
pub(super) mod homes;
pub(super) mod seated;
pub(super) mod seats;
pub(super) mod sharing;
pub(super) mod short_form;
pub(super) mod stations;
pub(super) mod stays;
