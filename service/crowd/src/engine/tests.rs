//! Two who meet where there is floor for one, and lines with more people than places.

use d3dgen_model::Pose;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::Placements;
use d3dgen_model::scenario::PERSON_RADIUS_M;
use serde_json::{Value, json};

use super::*;

const SECONDS: f64 = 120.0;

fn rectangle([x0, y0, x1, y1]: [f64; 4]) -> Value {
    json!([{"x": x0, "y": y0}, {"x": x1, "y": y0}, {"x": x1, "y": y1}, {"x": x0, "y": y1}])
}

/// Returns a room of 12 x 6 m with blocks in it.
fn hall(blocks: &[[f64; 4]]) -> Space {
    let room = [0.0, 0.0, 12.0, 6.0];
    let blocks = blocks.iter().enumerate().map(|(i, block)| {
        json!({"obstacle_id": format!("obstacle_{i}"), "kind": "column", "outline": rectangle(*block), "room_id": "hall"})
    });
    let plan = json!({
        "version": 1, "seed": 1, "scheme": "given", "walls": [], "doors": [], "windows": [],
        "rooms": [{
            "room_id": "hall", "room_type": "hall", "name": "Hall", "polygon": rectangle(room), "net_polygon": rectangle(room),
            "net_area_m2": 72.0, "ceiling_height_m": 3.0, "materials": {"floor": "a", "wall": "b", "ceiling": "c"},
        }],
        "obstacles": blocks.collect::<Vec<_>>(),
    });
    let plan: Floorplan = serde_json::from_value(plan).expect("a plan");
    let placements: Placements =
        serde_json::from_value(json!({"version": 1, "seed": 1, "placements": []})).expect("no objects");
    Space::new(0, &plan, &placements)
}

fn task(at: Point, act: Act, seconds: f64) -> Task {
    Task { level: 0, room: 0, at, act, seconds, station: None, job: None }
}

fn walker(id: &str, from: Point, tasks: Vec<Task>) -> Mover {
    let mut mover = Mover::new(id.into(), "visitor".into(), PERSON_RADIUS_M, 1.3, 0, from);
    mover.tasks = tasks;
    mover.repeats = false;
    mover
}

/// Runs them and returns them; none of them called more than half of its time a pause.
fn moved(space: Space, stations: Vec<(usize, usize, Station)>, movers: Vec<Mover>) -> Vec<Mover> {
    let spaces = [space];
    let mut engine = Engine::new(&spaces, &[], stations, SECONDS);
    engine.access = vec![vec![vec![true]]];
    engine.movers = movers;
    assert!(engine.run(&mut |_| true));
    for m in &engine.movers {
        // who never found the door free was not there
        let Some(end) = m.samples().last().map(|s| s.t) else { continue };
        let stood: f64 = m.pauses.iter().map(|p| p.to.min(end) - p.from).sum();
        let there = end - m.samples()[0].t;
        assert!(stood <= 0.5 * there, "{} calls {stood:.1} s of {there:.1} s a pause", m.id);
    }
    engine.movers
}

fn apart(movers: &[Mover]) -> f64 {
    let mut least = f64::MAX;
    for (i, a) in movers.iter().enumerate() {
        for b in &movers[i + 1..] {
            for (s, t) in a.samples().iter().zip(b.samples()) {
                least = least.min(s.at.distance(t.at));
            }
        }
    }
    least
}

#[test]
fn those_who_meet_in_an_aisle_for_one_get_past_each_other() {
    // an aisle of 0.6 m between two blocks, 6 m long; nobody passes another one there
    let blocks = [[3.0, 0.0, 9.0, 2.7], [3.0, 3.3, 9.0, 6.0]];
    for crowd in 1..=3 {
        let mut movers = Vec::new();
        for k in 0..crowd {
            let y = 2.0 + f64::from(k);
            let (left, right) = (Point::new(1.0, y), Point::new(11.0, y));
            movers.push(walker(&format!("east_{k}"), left, vec![task(right, Act::Stand, 1.0)]));
            movers.push(walker(&format!("west_{k}"), right, vec![task(left, Act::Stand, 1.0)]));
        }
        let movers = moved(hall(&blocks), Vec::new(), movers);
        for m in &movers {
            assert_eq!((m.done.len(), m.missed), (1, 0), "{} of {crowd} gets there", m.id);
        }
        assert!(apart(&movers) > 2.0 * PERSON_RADIUS_M - 0.11, "{} m", apart(&movers));
    }
}

#[test]
fn of_two_wide_ones_who_come_to_an_aisle_at_once_one_goes_first() {
    // an aisle of 1 m; both are 0.8 m wide, on their way to the same place, and each has the other before it
    let blocks = [[3.0, 0.0, 9.0, 2.5], [3.0, 3.5, 9.0, 6.0]];
    for apart_m in [1.0, 1.2, 1.6, 2.4] {
        let robot = |id: &str, y: f64, end: f64| {
            let mut mover = walker(id, Point::new(1.0, y), vec![task(Point::new(11.0, end), Act::Stand, 1.0)]);
            mover.radius = 0.4;
            mover
        };
        let (low, high) = (3.0 - apart_m / 2.0, 3.0 + apart_m / 2.0);
        let movers = moved(hall(&blocks), Vec::new(), vec![robot("low", low, 2.0), robot("high", high, 4.0)]);
        for m in &movers {
            assert_eq!((m.done.len(), m.missed), (1, 0), "{} of those {apart_m} m apart gets there", m.id);
        }
    }
}

#[test]
fn who_has_just_come_calls_no_long_standing_a_pause() {
    let mut late = walker("late", Point::new(1.0, 1.0), Vec::new());
    late.sample(100.0, &[0]);
    assert!(!late.may_stand(102.0, YIELD_S), "10 of 12 s at the end");
    assert!(late.may_stand(112.0, YIELD_S), "10 of 22 s");
    late.begin_pause(112.0, "yield");
    late.end_pause(122.0);
    assert!(!late.may_stand(123.0, YIELD_S), "20 of 33 s");
    assert!(late.may_stand(145.0, YIELD_S), "20 of 55 s");
}

#[test]
fn who_stands_in_a_dead_end_lets_out_who_is_behind_it() {
    // a dead end of 0.6 m: two stand in it, one behind the other, and the inner one leaves
    let blocks = [[3.0, 0.0, 12.0, 2.7], [3.0, 3.3, 12.0, 6.0]];
    let inner = walker("inner", Point::new(11.0, 3.0), vec![task(Point::new(1.0, 3.0), Act::Stand, 1.0)]);
    let at = Point::new(8.0, 3.0);
    let outer = walker("outer", at, vec![task(at, Act::Stand, 100.0)]);
    let middle = Point::new(6.0, 3.0);
    let first = walker("first", middle, vec![task(middle, Act::Stand, 100.0)]);
    let movers = moved(hall(&blocks), Vec::new(), vec![inner, outer, first]);
    assert_eq!(movers[0].done.len(), 1, "it gets out");
    assert!(movers[1].at.distance(at) < 1.0, "it is back where it stood");
}

#[test]
fn all_of_a_crowd_are_served_though_the_line_has_three_places() {
    let at = |x: f64, y: f64| Pose { x, y, z: 0.0, yaw_rad: 0.0 };
    let counter = Station {
        station_id: "counter".into(),
        room_id: "hall".into(),
        placement_id: "counter_1".into(),
        act: Act::Queue,
        before: at(6.0, 0.5),
        at: at(6.0, 0.5),
        queue: vec![Point::new(6.0, 1.25), Point::new(6.0, 2.0)],
    };
    let away = Point::new(1.0, 5.0);
    let crowd = (0..12).map(|k| {
        let from = Point::new(2.0 + 0.7 * f64::from(k), 5.0);
        let tasks = vec![task(Point::new(6.0, 0.5), Act::Queue, 3.0), task(away, Act::Stand, 1.0)];
        walker(&format!("guest_{k}"), from, tasks)
    });
    let movers = moved(hall(&[]), vec![(0, 0, counter)], crowd.collect());
    for m in &movers {
        assert_eq!((m.done.len(), m.missed), (2, 0), "{} is served", m.id);
    }
}

#[test]
fn who_stands_behind_somebody_without_floor_to_give_says_so() {
    // a dead end of 0.6 m, in which somebody stands who cannot be asked
    let blocks = [[1.5, 0.0, 12.0, 2.7], [1.5, 3.3, 12.0, 6.0]];
    let out = Point::new(0.7, 3.0);
    let mut inner = walker("inner", Point::new(11.5, 3.0), Vec::new());
    inner.exit = Some((0, out));
    let mut outer = walker("outer", Point::new(10.8, 3.0), vec![task(out, Act::Stand, 1.0)]);
    outer.state = State::Busy { until: 50.0 };
    outer.skips = true;
    let movers = moved(hall(&blocks), Vec::new(), vec![inner, outer]);
    let ends: Vec<f64> = movers[0].pauses.iter().flat_map(|p| [p.from, p.to]).take_while(|t| *t < 50.0).collect();
    let longest = [0.0].iter().chain(&ends).zip(ends.iter().chain(&[50.0])).map(|(a, b)| b - a).fold(0.0, f64::max);
    assert!(longest < 20.0, "{longest} s without a word: {ends:?}");
}

#[test]
fn nobody_comes_into_a_room_that_is_full() {
    // 12 m2 of floor: three people with room to walk
    let spaces = [hall(&[[0.0, 0.0, 12.0, 5.0]])];
    let mut engine = Engine::new(&spaces, &[], Vec::new(), SECONDS);
    engine.access = vec![vec![vec![true]]];
    let door = Point::new(0.7, 5.5);
    engine.sources.push(Source {
        id: "visitors".into(),
        role: "visitor".into(),
        speed: 1.2,
        level: 0,
        at: door,
        per_min: 20.0,
        most: 12,
        group: [1, 3],
        itineraries: vec![vec![task(Point::new(8.0, 5.5), Act::Talk, 40.0)]],
        access: 0,
        stream: Stream::new(1, "visitors"),
        next: 0.0,
        count: 0,
        waiting: Vec::new(),
    });
    assert!(engine.run(&mut |_| true));
    let there = |t: f64| {
        let at = |m: &&Mover| m.samples().first().is_some_and(|s| s.t <= t) && m.done.is_empty();
        engine.movers.iter().filter(at).count()
    };
    assert!(engine.movers.len() > 3, "others come when some have left: {}", engine.movers.len());
    assert!(engine.movers.iter().filter(|m| m.samples().first().is_some_and(|s| s.t < 40.0)).count() <= 3);
    assert!(there(30.0) <= 3);
}
