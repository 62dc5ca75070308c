//! Counts and measures of a world for those who compare worlds.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::Point;
use d3dgen_model::placements::AssetSource;
use d3dgen_model::scenario::Scenario;

use super::context::Context;

/// Returns the figures of a world by name; areas in m^2, shares 0 to 1. `storeys` are those of a world with several.
pub fn measure(c: &Context, storeys: &[Context]) -> BTreeMap<String, f64> {
    let connected = match storeys {
        [] => c.reach().largest_share,
        storeys => storeys.iter().map(|s| s.reach().largest_share).fold(1.0, f64::min),
    };
    let area = |only_circulation: bool| -> f64 {
        let rooms = c.rooms.iter().filter(|r| r.plan.circulation || !only_circulation);
        rooms.map(|r| r.plan.net_area_m2).sum()
    };
    let rooms = c.rooms.iter().filter(|r| !r.plan.circulation).count() as f64;
    let taken: f64 =
        c.objects.iter().filter(|o| o.blocks && o.placement.support.is_none()).map(|o| o.outline.area()).sum();
    let kinds: BTreeSet<&str> = c.objects.iter().map(|o| o.placement.object.as_str()).collect();
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    let l_shaped = c.rooms.iter().filter(|r| r.plan.polygon.corners().len() > 4).count() as f64;
    let figures = [
        ("rooms", rooms),
        ("rooms_with_circulation", c.rooms.len() as f64),
        ("doors", c.plan().doors.len() as f64),
        ("windows", c.plan().windows.len() as f64),
        ("objects", c.objects.len() as f64),
        ("objects_per_room", share(c.objects.len() as f64, c.rooms.len() as f64)),
        ("object_types", kinds.len() as f64),
        ("net_area_m2", area(false)),
        ("circulation_share", share(area(true), area(false))),
        ("floor_covered", share(taken, area(false))),
        ("rooms_not_rectangular", l_shaped),
        ("free_component", connected),
        ("unplaced_wishes", c.world.placements.unplaced.len() as f64),
    ];
    let figures = figures.into_iter().chain(of_scenario(&c.world.scenario));
    // Only where a database of assets has a say: objects that are its assets, and such as are made for want of one.
    let choices = || c.objects.iter().filter_map(|o| o.placement.asset_choice.as_ref());
    let from = |source: AssetSource| choices().filter(|choice| choice.source == source).count() as f64;
    let stock = [
        ("objects_from_database", from(AssetSource::Database)),
        ("objects_made_for_want_of_an_asset", from(AssetSource::Generated)),
    ];
    let levels = ("storeys", storeys.len() as f64);
    let stock = stock.into_iter().chain(std::iter::once(levels));
    let figures = figures.chain(stock.filter(|(_, count)| *count > 0.0));
    // the sum of nothing is -0
    figures.map(|(name, value)| (name.to_owned(), (value * 1000.0).round() / 1000.0 + 0.0)).collect()
}

/// Returns how many people are there and come in, and what robots have to do.
fn of_scenario(scenario: &Scenario) -> [(&'static str, f64); 6] {
    let place = |id: &str| scenario.pois.iter().find(|p| p.poi_id == id).map(|p| Point::new(p.pose.x, p.pose.y));
    let jobs = || scenario.robots.iter().flat_map(|r| &r.jobs);
    [
        ("people", scenario.agents.len() as f64),
        ("people_who_come_per_min", scenario.flows.iter().map(|f| f.people_per_s() * 60.0).sum()),
        ("robots", scenario.robots.len() as f64),
        ("robot_jobs", jobs().count() as f64),
        ("robot_minutes_at_least", jobs().map(|job| job.least_seconds(place) / 60.0).sum()),
        ("conditions", scenario.conditions.len() as f64),
    ]
}
