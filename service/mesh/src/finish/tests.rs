use super::*;

fn decoded(bytes: &[u8]) -> image::RgbImage {
    image::load_from_memory(bytes).expect("a picture").to_rgb8()
}

#[test]
fn every_finish_is_complete_and_small() {
    let mut ids = std::collections::BTreeSet::new();
    for finish in all() {
        assert!(ids.insert(&finish.id), "{} is there twice", finish.id);
        for color in finish.colors.iter().chain(&finish.joint) {
            assert!(srgb(color).is_some(), "{}: {color} is no color", finish.id);
        }
        let pictures = finish.pictures();
        assert!(pictures.color.len() < 40_000, "{}: {} bytes of color", finish.id, pictures.color.len());
        let normal = pictures.normal.as_ref().map_or(0, Vec::len);
        assert!(normal < 120_000, "{}: {normal} bytes of normals", finish.id);
        assert_eq!(decoded(&pictures.color).dimensions(), (SIDE as u32, SIDE as u32));
    }
}

#[test]
fn pictures_go_on_across_their_edges() {
    for finish in all().iter().filter(|f| f.is_drawn()) {
        let picture = decoded(&finish.pictures().color);
        let step = |a: (u32, u32), b: (u32, u32)| {
            let (p, q) = (picture.get_pixel(a.0, a.1), picture.get_pixel(b.0, b.1));
            (0..3).map(|k| f64::from(p[k].abs_diff(q[k]))).sum::<f64>()
        };
        let last = SIDE as u32 - 1;
        let rows = |x: u32, next: u32| (0..=last).map(|y| step((x, y), (next, y))).sum::<f64>() / f64::from(last);
        let columns = |y: u32, next: u32| (0..=last).map(|x| step((x, y), (x, next))).sum::<f64>() / f64::from(last);
        // Joints lie on the edge of some: what crosses it may differ as much as what crosses any line of the picture.
        let most = |across: &dyn Fn(u32, u32) -> f64| (0..last).map(|i| across(i, i + 1)).fold(0.0, f64::max);
        assert!(rows(last, 0) <= 1.2 * most(&rows) + 1.0, "{}: a seam from left to right", finish.id);
        assert!(columns(last, 0) <= 1.2 * most(&columns) + 1.0, "{}: a seam from top to bottom", finish.id);
    }
}

#[test]
fn every_name_of_a_surface_has_a_finish() {
    for (name, id) in [
        ("Oak_Planks", "Oak_Planks"),
        ("Walnut_Parquet", "Oak_Planks"),
        ("Gray_Carpet_Tiles", "Carpet_Loop"),
        ("Something_Else", "Plaster_Wall"),
        ("", "Plaster_Wall"),
    ] {
        assert_eq!(named(name).id, id, "{name}");
    }
}

#[test]
fn a_surface_keeps_its_color_under_a_grain() {
    let grain = get("Wood_Grain").expect("there");
    assert!(grain.tints);
    let material = Material { base_color: [0.4, 0.3, 0.2], finish: Some(grain.id.clone()), ..Material::default() };
    let factor = material.factor();
    let seen: Vec<f32> = (0..3).map(|k| factor[k] * grain.mean()[k]).collect();
    for (seen, wanted) in seen.iter().zip(material.base_color) {
        assert!((seen - wanted).abs() < 0.01, "{seen} is not {wanted}");
    }
}
