use super::*;
use crate::model3d::{Body, Material, Mesh, Texture, Visual};

/// A square plate upright at the front, and one behind it to the right.
fn plates() -> Model3d {
    let plate = |x: f32, y: f32| Mesh {
        positions: vec![[x, y, 0.0], [x + 1.0, y, 0.0], [x + 1.0, y, 1.0], [x, y, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let visual = |name: &str, mesh, material| Visual { name: name.into(), mesh, material: Some(material) };
    let color = |base_color| Material { base_color, ..Material::default() };
    Model3d {
        name: "plates".into(),
        bodies: vec![Body {
            name: "base".into(),
            visuals: vec![visual("red", plate(0.0, 0.0), 0), visual("blue", plate(0.0, 1.0), 1)],
            ..Body::default()
        }],
        materials: vec![color([0.8, 0.0, 0.0]), color([0.0, 0.0, 0.8])],
        ..Model3d::default()
    }
}

#[test]
fn what_is_in_front_hides_what_is_behind() {
    let view = View { right_deg: 0.0, above_deg: 0.0, ground: Ground::White };
    let picture = render(&plates(), 64, &view);
    let middle = &picture.rgba[(32 * 64 + 32) * 4..][..4];
    assert!(middle[0] > middle[2] + 90, "{middle:?} is not red");
    let back = render(&plates(), 64, &View { right_deg: 180.0, ..view });
    let middle = &back.rgba[(32 * 64 + 32) * 4..][..4];
    assert!(middle[2] > middle[0] + 90, "{middle:?} is not blue");
    assert_eq!(&picture.rgba[..4], &[255; 4], "the corner is paper");
}

#[test]
fn a_thumbnail_fills_its_square_and_is_clear_around() {
    let picture = thumbnail(&plates(), 96);
    let covered: Vec<usize> = (0..96 * 96).filter(|i| picture.rgba[i * 4 + 3] > 0).collect();
    let (low, high) = (covered.iter().map(|i| i % 96).min().unwrap(), covered.iter().map(|i| i % 96).max().unwrap());
    let (top, bottom) = (covered[0] / 96, covered[covered.len() - 1] / 96);
    assert!((high - low).max(bottom - top) > 80, "{low}..{high} {top}..{bottom}");
    assert_eq!(picture.rgba[3], 0);
    assert_eq!(picture, thumbnail(&plates(), 96));
}

#[test]
fn broken_models_give_a_picture_too() {
    for mesh in [
        Mesh::default(),
        Mesh { triangles: vec![[0, 1, 9]], positions: vec![[0.0; 3]; 2], ..Mesh::default() },
        Mesh { triangles: vec![[0, 1, 2]], positions: vec![[f32::NAN; 3]; 3], ..Mesh::default() },
    ] {
        let mut model = plates();
        model.bodies[0].visuals[0].mesh = mesh;
        assert_eq!(thumbnail(&model, 16).rgba.len(), 16 * 16 * 4);
        model.bodies[0].visuals.truncate(1);
        assert_eq!(thumbnail(&model, 16).rgba.len(), 16 * 16 * 4);
    }
}

#[test]
fn a_sheet_holds_every_tile_and_is_a_png() {
    let tiles = vec![thumbnail(&plates(), 20); 5];
    let sheet = sheet(&tiles, 3, 4);
    assert_eq!((sheet.width, sheet.height), (3 * 24 + 4, 2 * 24 + 4));
    let bytes = sheet.png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, sheet.rgba);
}

#[test]
fn surfaces_wear_their_pictures() {
    let mut model = plates();
    let mut bytes = Vec::new();
    // Green above, blue below.
    let mut encoder = png::Encoder::new(&mut bytes, 1, 2);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut w| w.write_image_data(&[0, 200, 0, 0, 0, 200])).expect("a picture");
    model.textures = vec![Texture { path: "two.png".into(), bytes: Some(bytes) }];
    model.materials[0].texture = Some(0);
    model.bodies[0].visuals.truncate(1);
    model.bodies[0].visuals[0].mesh.uvs = vec![[0.0, 0.01], [1.0, 0.01], [1.0, 0.99], [0.0, 0.99]];
    let view = View { right_deg: 0.0, above_deg: 0.0, ground: Ground::White };
    let picture = render(&model, 64, &view);
    let at = |row: usize| picture.rgba[(row * 64 + 32) * 4..][..3].to_vec();
    assert!(at(20)[1] > at(20)[2] + 90 && at(20)[1] > at(20)[0] + 90, "{:?} is not green", at(20));
    assert!(at(44)[2] > at(44)[1] + 90, "{:?} is not blue", at(44));
    model.textures[0].bytes = Some(b"\x89PNG is none".to_vec());
    let plain = render(&model, 64, &view);
    assert!(plain.rgba[(20 * 64 + 32) * 4] > 120, "what cannot be decoded has its plain color");
}
