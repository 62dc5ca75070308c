use super::*;
use crate::models::NothingKept;
use crate::sample;

fn xml() -> String {
    let scene = SimScene::of(&sample::world(), &sample::domain(), &NothingKept).unwrap();
    document(&scene)
}

/// Values of an attribute of all elements of a name.
fn all<'a>(xml: &'a str, element: &str, attribute: &str) -> Vec<&'a str> {
    let (begin, key) = (format!("<{element} "), format!(" {attribute}=\""));
    let lines = xml.lines().map(str::trim_start).filter(|l| l.starts_with(&begin));
    lines.filter_map(|l| l.split_once(&key)?.1.split('"').next()).collect()
}

#[test]
fn every_thing_is_a_body_and_every_reference_is_there() {
    let (xml, world) = (xml(), sample::world());
    let bodies = all(&xml, "body", "name");
    for id in world.placements.placements.iter().map(|p| p.placement_id.as_str()) {
        assert!(bodies.contains(&id), "{id}");
    }
    let [meshes, materials] = ["mesh", "material"].map(|kind| all(&xml, kind, "name"));
    assert!(all(&xml, "geom", "mesh").iter().all(|m| meshes.contains(m)));
    assert!(all(&xml, "geom", "material").iter().all(|m| materials.contains(m)));
    for pair in ["body1", "body2"] {
        assert!(all(&xml, "exclude", pair).iter().all(|b| bodies.contains(b)));
    }
    let mut names = all(&xml, "geom", "name");
    names.sort_unstable();
    assert!(names.windows(2).all(|w| w[0] != w[1]), "geoms have names of their own");
}

#[test]
fn key_frames_have_a_position_for_every_joint() {
    let xml = xml();
    let needed = all(&xml, "freejoint", "name").len() * 7 + all(&xml, "joint", "name").len();
    let given: Vec<usize> = all(&xml, "key", "qpos").iter().map(|q| q.split(' ').count()).collect();
    assert!(needed > 60 && given == [needed, needed], "{needed} {given:?}");
}

#[test]
fn joints_stop_hard_and_the_shorter_their_way_the_more_inertia_they_are_given() {
    let xml = xml();
    let lines = xml.lines().map(str::trim_start).filter(|l| l.starts_with("<joint name="));
    let value = |line: &str, key: &str| {
        line.split_once(&format!(" {key}=\"")).and_then(|(_, v)| v.split('"').next().map(str::to_owned))
    };
    let mut given: Vec<(f64, f64)> = lines
        .filter_map(|line| {
            let range = value(line, "range")?;
            let (low, high) = range.split_once(' ')?;
            let span = high.parse::<f64>().ok()? - low.parse::<f64>().ok()?;
            Some((span, value(line, "armature").expect("every joint has one").parse().ok()?))
        })
        .collect();
    given.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(given.len() > 10 && given.windows(2).all(|w| w[0].1 >= w[1].1 - 1e-9), "{given:?}");
    assert!(xml.contains(&format!("solreflimit=\"{HARD_STOP}\"")));
}
