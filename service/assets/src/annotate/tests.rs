//! Whole annotations of small models.

use d3dgen_mesh::Material;
use d3dgen_model::Document;

use super::*;
use crate::annotation::FrontAxis;
use crate::measure::tests::boxes;
use crate::sample;

fn subject<'a>(model: &'a Model3d, stem: &'a str, around: &'a Surroundings) -> Subject<'a> {
    let declared = Declared {
        format: "glb".into(),
        up_axis: Some('Y'),
        up_axis_authored: true,
        unit_authored: true,
        unit_beside: None,
        simulator: around.simulator,
    };
    let origin = Origin::Ingested { path: format!("{stem}.glb"), hash: "00".into() };
    Subject { model, declared, stem, around, domain: None, origin }
}

fn chair() -> Model3d {
    let mut model = boxes(&[[[0.0, 0.0, 0.0], [0.44, 0.5, 0.45]], [[0.0, 0.45, 0.45], [0.44, 0.5, 0.9]]]);
    model.materials = vec![Material { name: "oak_wood".into(), base_color: [0.15, 0.06, 0.02], ..Material::default() }];
    model
}

#[test]
fn a_chair_is_known_by_name_and_size() {
    let (model, around) = (chair(), Surroundings::default());
    let a = annotate(&subject(&model, "SM_DiningChair_01a", &around), sample::catalog()).expect("it has triangles");
    assert_eq!(a.check(), []);
    assert_eq!((a.asset_id.as_str(), a.name.as_str()), ("Common/SM_DiningChair_01a", "Dining chair"));
    assert_eq!((a.object.as_deref(), a.kind.as_str(), a.mount), (Some("dining_chair"), "chair", Mount::Floor));
    assert_eq!((a.front.axis, a.affordances[0].as_str()), (FrontAxis::MinusY, "sit"));
    assert_eq!((a.materials.as_slice(), a.palette[0].name.as_str()), (&["wood".to_owned()][..], "brown"));
    assert_eq!(a.bounding_box_m, [[-0.22, 0.22], [-0.25, 0.25], [0.0, 0.9]]);
    assert_eq!((a.triangle_count, a.changes.len()), (24, 0));
    assert!(a.room_types.iter().any(|r| r == "dining_room"), "{:?}", a.room_types);
    assert!(a.description.contains("0.44 m wide, 0.50 m deep, 0.90 m high"), "{}", a.description);
    let mass = a.mass.as_ref().expect("it has a surface");
    assert!((3.0..12.0).contains(&mass.mass_kg) && mass.inertia_kg_m2[..3].iter().all(|i| *i > 0.0), "{mass:?}");
    assert_eq!(a.basis["front"], Basis::Guessed);
    assert_eq!(Annotation::from_json(&a.to_json()).expect("its own form"), a);
}

#[test]
fn metadata_wins_over_guesses() {
    let model = chair();
    let metadata = crate::annotation::asa::read(
        "name: Throne\ndesc: The seat of a king.\nface: +x\ntags: [domain::museum, kind::structure, hoi::see, mount::floor, room::hall, old]\n",
    );
    let around = Surroundings { metadata: Some(metadata.expect("sound")), ..Surroundings::default() };
    let a = annotate(&subject(&model, "SM_DiningChair_01a", &around), sample::catalog()).expect("it has triangles");
    assert_eq!((a.asset_id.as_str(), a.name.as_str(), a.kind.as_str()), ("Museum/Throne", "Throne", "structure"));
    assert_eq!((a.front.axis, a.affordances.as_slice()), (FrontAxis::PlusX, &["see".to_owned()][..]));
    assert_eq!((a.domains.as_slice(), a.room_types.as_slice()), (&["museum".to_owned()][..], &["hall".to_owned()][..]));
    assert!(a.description.starts_with("The seat of a king. "));
    assert_eq!([a.basis["front"], a.basis["kind"], a.basis["description"]], [Basis::Given; 3]);
    let again = crate::annotation::asa::read(&crate::annotation::asa::write(&a)).expect("our own form");
    assert_eq!((again.face, again.bounding_box_m), (Some(FrontAxis::PlusX), Some(a.bounding_box_m)));
    assert_eq!(again.values("kind").collect::<Vec<_>>(), ["structure"]);
}

#[test]
fn things_without_a_name_are_described_by_what_is_seen() {
    let model = boxes(&[[[0.0, 0.0, 0.0], [0.9, 0.03, 0.6]]]);
    let around = Surroundings::default();
    let a = annotate(&subject(&model, "scene", &around), sample::catalog()).expect("it has triangles");
    assert_eq!((a.object.as_deref(), a.mount, a.asset_id.as_str()), (None, Mount::Wall, "Common/scene"));
    assert_eq!(annotate(&subject(&Model3d::default(), "empty", &around), sample::catalog()), None);
}
