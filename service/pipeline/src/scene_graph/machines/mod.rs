//! Robots: which the prompt names, what it asks of them, and where they charge.

pub(super) mod charging;
pub(super) mod docks;
pub(super) mod keeps;
pub(super) mod robot_rules;
pub(super) mod robots;
pub(super) mod sizes;
