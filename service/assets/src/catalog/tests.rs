//! Names of real models against the shipped objects.

use super::*;
use crate::sample;

#[track_caller]
fn first(name: &str) -> Option<String> {
    sample::catalog().match_name(&words::split(name)).first().map(|m| m.object.object_id.clone())
}

#[test]
fn every_shipped_object_has_words_and_finds_itself() {
    let catalog = sample::catalog();
    for object in catalog.objects() {
        assert!(!object.purpose.is_empty(), "{} has no line in data/words_*.txt", object.object_id);
        let name = words::split(&object.object_id);
        let found = catalog.match_name(&name);
        assert!(found.iter().any(|m| m.object.object_id == object.object_id), "{name:?}");
        assert!(found.iter().all(|m| (0.0..=1.0).contains(&m.coverage)));
    }
}

#[test]
fn names_of_models_mean_objects() {
    for (name, object) in [
        ("lampSquareFloor", "floor_lamp"),
        ("tableCoffee", "coffee_table"),
        ("aws_robomaker_Refrigerator_01_visual", "fridge"),
        ("trashcan", "waste_bin"),
        ("IVStand", "iv_stand"),
        ("basemesh_office_chair", "swivel_chair"),
        ("Bücherregal_03", "bookshelf"),
        ("night_stand", "nightstand"),
        ("toiletSquare", "toilet"),
        ("washing-machine", "washing_machine"),
    ] {
        assert_eq!(first(name).as_deref(), Some(object), "{name}");
    }
    for name in ["", "xyzzy", "material_01", "SM_white_A", "test_cube", "purpose"] {
        assert_eq!(first(name), None, "{name}");
    }
}

#[test]
fn objects_know_their_rooms_and_domains() {
    let catalog = sample::catalog();
    let bed = catalog.object("hospital_bed").expect("shipped");
    assert!(bed.room_types.iter().any(|r| r == "patient_room"), "{:?}", bed.room_types);
    assert_eq!(bed.domains, ["hospital"]);
    let sofa = catalog.object("sofa").expect("shipped");
    assert!(sofa.domains.len() > 1 && sofa.names.contains(&"couch".to_owned()));
}
