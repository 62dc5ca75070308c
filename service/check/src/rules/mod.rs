//! Every hard rule, in the order in which they are checked.
//!
//! The first groups say what the referee of finished worlds says, measured on our documents; the others are what a good
//! building needs beyond that. A new rule is a function in the file of its group and one entry in [`RULES`].

mod building;
mod doors;
mod furniture;
mod graph;
mod navigation;
mod objects;
mod people;
mod robots;
mod rooms;
mod storeys;
mod walls;
mod windows;
mod zones;

use d3dgen_model::report::{RuleResult, Violation};

use super::context::Context;

pub(crate) use rooms::is_cramped;

/// What a rule speaks about, which tells whose fault it is when a brought plan is furnished here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// Rooms, walls, openings and ways: the plan's fault where it is broken with nothing in the rooms, too.
    Plan,
    /// What stands in rooms: the fault of who placed it, except for what a room lacks that is smaller than its type needs.
    Furniture,
}

/// A hard rule.
pub struct Rule {
    /// Snake-case id.
    pub id: &'static str,
    /// What it demands, one sentence.
    pub title: &'static str,
    /// True for rules that look at all storeys at once; the others see one after the other.
    pub whole: bool,
    /// What it speaks about.
    pub about: About,
    pub(crate) check: fn(&Context, &mut Findings),
}

const fn rule(id: &'static str, title: &'static str, check: fn(&Context, &mut Findings)) -> Rule {
    Rule { id, title, whole: false, about: About::Plan, check }
}

const fn whole(id: &'static str, title: &'static str, check: fn(&Context, &mut Findings)) -> Rule {
    Rule { whole: true, ..rule(id, title, check) }
}

const fn furnishing(id: &'static str, title: &'static str, check: fn(&Context, &mut Findings)) -> Rule {
    Rule { about: About::Furniture, ..rule(id, title, check) }
}

/// Every hard rule.
pub const RULES: &[Rule] = &[
    whole("not_finite", "every number is finite", zones::not_finite),
    whole(
        "zone_invalid",
        "room outlines have three corners or more, do not cross themselves and enclose an area",
        zones::invalid,
    ),
    whole("zone_clockwise", "room outlines run counter-clockwise without repeating the first corner", zones::clockwise),
    rule("zone_overlap", "two rooms share no floor", zones::overlap),
    whole("zone_net", "the net outline of a room lies within its outline and has the stated area", zones::net),
    whole("name_duplicate", "every room, door, window and placement id is unique in the world", zones::names),
    rule("wall_gap", "every stretch of a room's outline is a wall, a door or an open passage", walls::gap),
    rule("wall_stray", "every wall lies on the outlines of the rooms it names", walls::stray),
    rule("door_floating", "a door lies on the outlines of its rooms, and no wall crosses it", doors::floating),
    rule("door_unlinked", "a door joins exactly the one or two rooms it touches", doors::unlinked),
    rule("door_narrow", "a door's opening is at least 0.60 m", doors::narrow),
    rule("door_jamb", "a door keeps 0.10 m from the corners of its rooms", doors::jamb),
    rule("door_width", "a door is as wide as its room type, the building rules and the robots need", doors::width),
    rule("door_blocked", "0.5 m in front of each door, its width wide, is free on both sides", doors::blocked),
    rule("door_swing", "a door leaf swings without hitting anything", doors::swing),
    rule("no_entrance", "the building has an entrance, in the room meant for it", doors::entrance),
    rule("window_misplaced", "a window lies in an outer wall of its room", windows::misplaced),
    rule("window_overlap", "windows and doors do not overlap", windows::overlap),
    rule("window_blocked", "nothing taller than its sill stands in front of a window", windows::blocked),
    rule("daylight_missing", "every room that needs daylight has a window", windows::daylight),
    furnishing("object_no_size", "every object has positive extents", objects::size),
    furnishing("object_outside", "an object stands within its room", objects::outside),
    furnishing("object_collision", "two objects do not share space", objects::collision),
    furnishing(
        "object_unsupported",
        "an object stands on the floor or a surface, or hangs on a wall or the ceiling",
        objects::support,
    ),
    furnishing("object_too_high", "an object fits under the ceiling", objects::ceiling),
    rule(
        "unreachable_zone",
        "a person or robot gets from the entrance to at least half of every room's free floor",
        navigation::zones,
    ),
    rule("free_space_split", "at least 96 % of the free floor is connected", navigation::split),
    rule("corridor_narrow", "circulation keeps its clear width from door to door", navigation::corridors),
    whole("graph_room_missing", "the rooms are exactly those of the scene graph", graph::rooms),
    whole("graph_edge_missing", "every required door or passage of the scene graph is there", graph::edges),
    rule("adjacency_missing", "rooms that must be next to each other are", graph::must),
    rule("adjacency_forbidden", "rooms that must be kept apart share no door or wall", graph::must_not),
    whole("room_forbidden", "no room is of a kind that was ruled out", graph::forbidden),
    rule("private_passage", "no room is reached only through a private room", building::private_passage),
    rule(
        "public_path_in_restricted",
        "nobody who visits goes through what is closed to visitors",
        building::public_path_in_restricted,
    ),
    whole(
        "toilet_missing",
        "a building that is no home has a toilet, and one for wheelchairs on each storey that visitors come to",
        building::toilets,
    ),
    whole("room_area", "net areas lie within the range asked for", rooms::area),
    whole("room_dimension", "rooms keep their least clear extent", rooms::dimension),
    rule("room_proportion", "rooms are at most 2.5 times as long as wide", rooms::proportion),
    whole("room_height", "rooms keep their least clear height", rooms::height),
    // what a room needs follows from the rooms of the whole building: a studio has no kitchen of its own where there is one upstairs
    Rule { whole: true, ..furnishing("object_missing", "every room has what makes it that room", furniture::required) },
    furnishing("object_facing", "members of a group face as their use needs", furniture::facing),
    furnishing("object_back", "what belongs against a wall has its back to one", furniture::back),
    furnishing("object_clearance", "objects keep the free floor in front that their use needs", furniture::clearance),
    furnishing("dock_blocked", "docks are clear of doors and furniture", robots::docks),
    Rule {
        whole: true,
        ..furnishing(
            "dock_missing",
            "each robot that charges has a dock of its own, or the world says how many have none",
            robots::dock_missing,
        )
    },
    rule("robot_stuck", "every robot reaches each of its goals from where it starts", robots::tasks),
    rule("pose_taken", "points and people of the scenario stand on free floor of their room", robots::poses),
    whole("person_access", "nobody goes to rooms that are closed to them", people::access),
    rule("person_station", "what people use affords it and can be stood before", people::stations),
    whole("person_pace", "people walk as fast, and in groups as large, as people do", people::pace),
    rule("robot_job", "what robots are to do is at points that they get to, and done with one charge", people::jobs),
    rule("region_outside", "regions of the scenario lie in their room", robots::regions),
];

/// Hard rules of buildings with several storeys, beside the others.
pub const STOREY_RULES: &[Rule] = &[
    whole("stairs_missing", "every storey has stairs to the one below, or above it from a basement", storeys::stairs),
    whole("link_offset", "stairs and elevators lie above each other, within 0.05 m", storeys::offset),
    whole("link_closed", "one gets into stairs and elevators on every storey", storeys::closed),
    whole("elevator_missing", "buildings that need an elevator have one that stops at every storey", storeys::elevator),
    whole(
        "storey_in_the_air",
        "a storey juts out over the one below by a tenth of its floor at most",
        storeys::overhang,
    ),
    whole("storey_cut_off", "one gets from the entrance to every room, by stairs where need be", storeys::reach),
];

/// What a rule has looked at and found.
pub struct Findings {
    rule: &'static str,
    checked: u32,
    violations: Vec<Violation>,
}

impl Findings {
    pub(crate) fn new(rule: &'static str) -> Self {
        Self { rule, checked: 0, violations: Vec::new() }
    }

    /// Counts one thing looked at.
    pub(crate) fn look(&mut self) {
        self.checked += 1;
    }

    /// Notes that something breaks the rule.
    pub(crate) fn add(&mut self, subject: impl Into<String>, message: impl Into<String>) {
        self.push(subject.into(), message.into(), None, None, "");
    }

    /// Notes that something breaks the rule by a figure.
    pub(crate) fn add_figure(
        &mut self,
        subject: impl Into<String>,
        message: impl Into<String>,
        measured: f64,
        required: f64,
        unit: &str,
    ) {
        self.push(subject.into(), message.into(), Some(measured), Some(required), unit);
    }

    fn push(&mut self, subject: String, message: String, measured: Option<f64>, required: Option<f64>, unit: &str) {
        let round = |v: f64| (v * 10_000.0).round() / 10_000.0;
        self.violations.push(Violation {
            code: self.rule.to_owned(),
            subject,
            measured: measured.map(round),
            required,
            unit: unit.to_owned(),
            message,
            given: false,
        });
    }

    pub(crate) fn into_result(self, title: &str) -> RuleResult {
        RuleResult {
            rule: self.rule.to_owned(),
            title: title.to_owned(),
            checked: self.checked,
            violations: self.violations,
        }
    }
}
