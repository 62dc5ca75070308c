//! Who lives, works, sleeps and is treated in the building, and the rooms, beds, desks and seats that follow from it.

pub(crate) mod apiece;
pub(crate) mod beds;
pub(crate) mod counted;
pub(crate) mod dwelling;
pub(crate) mod ensuites;
pub(crate) mod groups;
pub(crate) mod heads;
pub(crate) mod held;
pub(crate) mod homes;
pub(crate) mod seated;
pub(crate) mod seats;
pub(crate) mod sharing;
pub(crate) mod short_form;
pub(crate) mod stations;
pub(crate) mod stays;
