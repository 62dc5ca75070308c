//! What the pipeline makes, through its public interface.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

mod briefs;
mod clutter;
mod common;
mod corridors;
mod details;
mod edit;
mod edit_storeys;
mod edit_tasks;
mod fleets;
mod forms;
mod homes;
mod homes_plans;
mod homes_read;
mod hospitals;
mod households;
mod kinds;
mod large;
mod offices;
mod order;
mod people;
mod prompts;
mod review;
mod review_furniture;
mod robots;
mod seats;
mod standing;
mod stop;
mod storeys;
mod style;
mod variety;
mod views;
mod ways;
