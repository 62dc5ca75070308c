//! Records as their users see them: folders, processes, crashes, damage. One binary, run with every built-in backend.
#![allow(clippy::unwrap_used, reason = "what fails in a test should stop it")]

mod common;
mod damage;
mod full_disk;
mod kill;
mod open;
mod processes;
mod snapshots;
mod upgrade;
