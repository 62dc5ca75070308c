//! People who fill the scene, by the roles of the domain.

use d3dgen_model::domain::Role;
use d3dgen_model::scenario::Agent;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;

use super::floor::{Floor, Room, looking_at};

/// Rooms for each person in the scene.
const ROOMS_PER_PERSON: usize = 3;
/// Fewest and most people.
const PEOPLE: (usize, usize) = (1, 8);
/// Radius of a person, m.
const PERSON_RADIUS_M: f64 = 0.25;
/// Most rooms a person walks between.
const MOST_WAYPOINTS: usize = 4;

/// Returns a few people, in a home as many as live there: one of each role that has rooms to visit here, then more of the first roles.
pub(crate) fn all(floor: &mut Floor, graph: &SceneGraph) -> Vec<Agent> {
    let domain = floor.domain;
    let walkable =
        |role: &&Role| floor.rooms.iter().any(|r| role.visits.contains(&r.plan.room_type) && floor.spots(r) > 0);
    let roles: Vec<&Role> = domain.roles.iter().filter(walkable).collect();
    // those who live there are at home
    let told = graph.occupancy.residents.map(|n| n as usize);
    let usual = || (floor.rooms.len() / ROOMS_PER_PERSON).clamp(PEOPLE.0, PEOPLE.1);
    let wanted = told.map_or_else(usual, |n| n.min(PEOPLE.1));
    let mut out: Vec<Agent> = Vec::new();
    for role in roles.iter().cycle().take(if roles.is_empty() { 0 } else { wanted }) {
        let number = out.iter().filter(|a| a.role == role.id).count() + 1;
        let agent_id = format!("{}_{number}", role.id);
        let mut stream = Stream::new(graph.seed, &format!("scenario/{agent_id}"));
        out.extend(person(floor, role, agent_id, &mut stream));
    }
    out
}

fn person(floor: &mut Floor, role: &Role, agent_id: String, stream: &mut Stream) -> Option<Agent> {
    // most frequent room types come first; of several rooms of a type the seed picks one
    let mut waypoints = Vec::new();
    for visit in &role.visits {
        let rooms: Vec<&Room> =
            floor.rooms.iter().filter(|r| &r.plan.room_type == visit && floor.spots(r) > 0).collect();
        waypoints.extend(stream.pick(&rooms).map(|r| r.plan.room_id.clone()));
    }
    waypoints.truncate(MOST_WAYPOINTS);
    stream.shuffle(&mut waypoints);
    let home = floor.rooms.iter().find(|r| Some(&r.plan.room_id) == waypoints.first())?;
    let spot = floor.spot(home, stream.below(floor.spots(home)))?;
    let start = looking_at(spot, home.plan.net_polygon.bounds().center());
    floor.take(spot, PERSON_RADIUS_M);
    Some(Agent {
        agent_id,
        role: role.id.clone(),
        model: role.model.clone(),
        speed_m_s: role.speed_m_s,
        start,
        waypoints,
        level: 0,
    })
}
