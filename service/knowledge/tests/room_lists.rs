//! Which building a list of room labels is of, on lists in six languages.

use d3dgen_knowledge::classify::{Classified, classify, ties};
use d3dgen_model::domain::Domain;
use d3dgen_plugins::Registry;

const LISTS: &str = include_str!("room_lists.txt");
/// Share of the lists that are read right at least: 57 of 60.
const RIGHT: f64 = 0.95;

fn read(registry: &Registry, labels: &str) -> Vec<Classified> {
    let domains: Vec<&Domain> = registry.iter().map(|p| p.domain()).collect();
    let labels: Vec<String> = labels.split(',').map(|l| l.trim().to_owned()).collect();
    classify(&labels, &domains)
}

#[test]
fn lists_of_rooms_are_of_their_building() {
    let registry = Registry::builtin();
    let lists = LISTS.lines().filter(|l| !l.starts_with('#') && !l.is_empty());
    let (mut all, mut wrong) = (0, Vec::new());
    for line in lists {
        let [_, domain, labels] = line.split(" | ").collect::<Vec<_>>()[..] else { panic!("{line}") };
        let best = read(&registry, labels).swap_remove(0);
        all += 1;
        if best.domain != domain {
            wrong.push(format!("{labels}: {} ({:.2}) for {domain}", best.domain, best.score));
        }
    }
    assert!(all >= 90, "{all} lists");
    let right = (all - wrong.len()) as f64 / all as f64;
    assert!(right >= RIGHT, "{right:.3} of {all}:\n{}", wrong.join("\n"));
}

#[test]
fn lists_that_were_read_as_homes() {
    let registry = Registry::builtin();
    for (labels, domain) in [
        ("operating room", "hospital"),
        ("meeting room, conference room", "office"),
        ("classroom, gym, staff room", "school"),
        ("office, waiting room, consultation room", "hospital"),
        ("patient room, ensuite, corridor", "hospital"),
        ("patient room, Flur, staff WC", "hospital"),
        ("patientroom, operatingroom", "hospital"),
        ("meetingroom, conferenceroom", "office"),
        ("ICU, ward", "hospital"),
    ] {
        let found = read(&registry, labels);
        assert_eq!(found[0].domain, domain, "{labels}: {:?}", &found[..2]);
        assert!(found[0].rooms.iter().all(|(_, room_type)| room_type.is_some()), "{labels}: {:?}", found[0].rooms);
    }
}

#[test]
fn rooms_of_no_kind_say_nothing_and_ties_are_told() {
    let registry = Registry::builtin();
    for labels in ["room", "Room 101, Room 102", "12, 13", "???"] {
        assert!(read(&registry, labels).iter().all(|r| r.score == 0.0), "{labels}");
    }
    let plain = read(&registry, "operating room");
    let with_rooms = read(&registry, "operating room, room, Room 2");
    assert_eq!(plain[0].domain, with_rooms[0].domain);
    assert!((plain[0].score - with_rooms[0].score).abs() < 1e-9, "a room of no kind changes nothing");
    // every building has these
    assert!(!ties(&read(&registry, "corridor, toilet")).is_empty());
    assert!(ties(&read(&registry, "patient room, nurse station, corridor")).is_empty());
    assert!(ties(&[]).is_empty());
}

#[test]
fn one_domain_reads_alone() {
    let registry = Registry::builtin();
    let domain = registry.get("hospital").expect("a shipped domain").domain();
    let found = classify(&["ward".to_owned(), "xyzzy".to_owned()], &[domain]);
    assert!(found[0].score > 0.0);
    assert_eq!(found[0].rooms[1].1, None, "what nobody knows is left out");
}
