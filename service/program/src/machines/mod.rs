//! Robots: which the prompt names, what it asks of them, and where they charge.

pub(crate) mod charging;
pub(crate) mod docks;
pub(crate) mod keeps;
pub(crate) mod robot_rules;
pub(crate) mod robots;
pub(crate) mod sizes;
