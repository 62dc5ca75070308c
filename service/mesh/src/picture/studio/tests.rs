use super::*;
use crate::model3d::{JointKind, Material, Mesh, Visual};
use crate::world3d::Node;

/// A white floor, a red wall at the back, and a lid over all of it on a layer of its own.
fn room() -> World3d {
    let mut world = World3d { name: "room".into(), ..World3d::default() };
    let mut plate = |name: &str, corners: [[f32; 3]; 4], color: [f32; 3], layer: &str| {
        let material = world.material(&Material { name: name.into(), base_color: color, ..Material::default() });
        let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        let visual = Visual { name: name.into(), mesh, material: Some(material) };
        let mesh = world.mesh(name, vec![visual]).expect("it has triangles");
        let mut node = Node::new(name, None).showing(mesh);
        node.layer = layer.into();
        world.node(node)
    };
    let at = |x: f32, y: f32, z: f32| [x, y, z];
    plate("floor", [at(-3., -3., 0.), at(3., -3., 0.), at(3., 3., 0.), at(-3., 3., 0.)], [0.9; 3], "");
    plate("wall", [at(-3., 3., 0.), at(3., 3., 0.), at(3., 3., 3.), at(-3., 3., 3.)], [0.8, 0.05, 0.05], "");
    plate("lid", [at(-3., -3., 3.), at(3., -3., 3.), at(3., 3., 3.), at(-3., 3., 3.)], [0.9; 3], "ceiling");
    world
}

fn camera() -> Camera {
    Camera { eye: [0.0, -2.5, 1.5], target: [0.0, 3.0, 1.2], view_deg: 70.0, size_px: [48, 36] }
}

fn pixel(picture: &Picture, x: usize, y: usize) -> [u8; 3] {
    std::array::from_fn(|k| picture.rgba[(y * picture.width + x) * 4 + k])
}

#[test]
fn a_wall_is_seen_in_its_color_and_the_lid_can_be_taken_off() {
    let effort = Effort { samples: 4, threads: 2 };
    let closed = Studio::new(&room(), &[], &|_| 0.0);
    let picture = closed.picture(&camera(), &Daylight::day(), effort);
    let [r, g, _] = pixel(&picture, 24, 17);
    assert!(r > g + 60, "{r} {g}");
    let open = Studio::new(&room(), &["ceiling"], &|_| 0.0);
    assert_eq!(closed.reach([0.0, 0.0, 1.0], [0.0, 0.0, 9.0]).map(|d| (d * 100.0).round()), Some(200.0));
    assert_eq!(open.reach([0.0, 0.0, 1.0], [0.0, 0.0, 9.0]), None);
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let studio = Studio::new(&room(), &["ceiling"], &|_| 0.0);
    let draw = |threads| studio.picture(&camera(), &Daylight::night(), Effort { samples: 2, threads });
    assert_eq!(draw(1), draw(3));
    assert_eq!(draw(2), draw(2));
}

#[test]
fn what_moves_is_drawn_where_it_is() {
    let mut world = room();
    world.nodes[1].motion = Some(crate::world3d::Motion {
        name: "wall".into(),
        kind: JointKind::Prismatic,
        axis: [0.0, 0.0, 1.0],
        limits: [0.0, 5.0],
    });
    let reach = |open: f64| Studio::new(&world, &[], &|_| open).reach([0.0, 0.0, 1.0], [0.0, 9.0, 1.0]);
    assert_eq!(reach(0.0).map(f64::round), Some(3.0));
    assert_eq!(reach(1.0), None);
}

#[test]
fn an_empty_world_is_a_picture_of_nothing() {
    let picture = Studio::new(&World3d::default(), &[], &|_| 0.0).picture(
        &camera(),
        &Daylight::day(),
        Effort { samples: 1, threads: 1 },
    );
    assert!(picture.rgba.chunks(4).all(|p| p == &picture.rgba[..4]));
}
