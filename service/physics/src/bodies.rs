//! The bodies of a scene, in the engine's terms.

use d3dgen_export::scene::{Mobility, SimBox, SimObject, SimScene, SimShape};
use d3dgen_mesh::Collision;
use rapier3d::prelude::{
    AngVector, ColliderBuilder, Matrix, PhysicsWorld, Pose, RigidBody, RigidBodyBuilder, RigidBodyHandle, Rotation,
    Vector,
};

/// Sliding friction of floors and walls; as in the MuJoCo worlds.
const BUILDING_FRICTION: f64 = 0.8;
/// Thickness of the floor that stands for the ground, m: no thing falls through it within a step.
const GROUND_M: f64 = 1.0;

/// Puts walls, floors, ceilings, door frames and leaves into the world, as one body that stands still.
pub(crate) fn building(world: &mut PhysicsWorld, scene: &SimScene) {
    let body = world.insert_body(RigidBodyBuilder::fixed());
    let walls = scene.walls.iter().flat_map(|w| &w.pieces).filter_map(|p| solid(&p.shape));
    let rooms = scene.rooms.iter().flat_map(|r| r.floor.iter().chain(&r.ceiling)).filter_map(solid);
    let boxes = scene.doors.iter().flat_map(|d| d.frame.iter().chain(d.leaves.iter().map(|l| &l.closed)));
    let windows = scene.windows.iter().flat_map(|w| w.frame.iter().chain([&w.glass]));
    let all: Vec<ColliderBuilder> = walls.chain(rooms).chain(boxes.chain(windows).map(cuboid)).collect();
    for collider in all.into_iter().chain([ground(scene)]) {
        world.insert_collider(collider.friction(BUILDING_FRICTION), Some(body));
    }
}

/// Puts a thing, by its index, with all its parts into the world as one body; none for what lies flat on the floor.
pub(crate) fn thing(world: &mut PhysicsWorld, scene: &SimScene, index: usize) -> Option<RigidBodyHandle> {
    let object = scene.objects.get(index)?;
    let model = &scene.models.get(object.model)?.model;
    let shapes: Vec<&Collision> = model.bodies.iter().flat_map(|b| &b.collisions).collect();
    if !object.collides || shapes.is_empty() {
        return None;
    }
    let kind = if object.mobility == Mobility::Fixed { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() };
    let turn = Rotation::from_rotation_z(object.yaw_rad);
    let body = world
        .insert_body(kind.pose(Pose::from_parts(Vector::from_array(object.at_m), turn)).user_data(index as u128 + 1));
    let volume: f64 = shapes.iter().map(|s| volume_m3(s)).sum();
    for shape in shapes {
        let collider = collider(shape)
            .density(object.mass_kg / volume.max(f64::EPSILON))
            .friction(object.friction)
            .restitution(object.restitution);
        world.insert_collider(collider, Some(body));
    }
    Some(body)
}

/// Returns the thing that a body is; none for the building.
pub(crate) fn thing_of<'s>(body: &RigidBody, scene: &'s SimScene) -> Option<&'s SimObject> {
    usize::try_from(body.user_data).ok()?.checked_sub(1).and_then(|index| scene.objects.get(index))
}

/// Returns the ground below the lowest storey, under the whole building.
fn ground(scene: &SimScene) -> ColliderBuilder {
    const FAR_M: f64 = 1000.0;
    let lowest = scene.rooms.iter().map(|r| r.floor_m).fold(f64::INFINITY, f64::min);
    let top = if lowest.is_finite() { lowest } else { 0.0 };
    ColliderBuilder::cuboid(FAR_M, FAR_M, GROUND_M / 2.0).translation(Vector::new(0.0, 0.0, top - GROUND_M / 2.0))
}

fn solid(shape: &SimShape) -> Option<ColliderBuilder> {
    match shape {
        SimShape::Box(b) => Some(cuboid(b)),
        SimShape::Prism { outline, z_m } => {
            let corners: Vec<Vector> = outline.iter().flat_map(|p| z_m.map(|z| Vector::new(p.x, p.y, z))).collect();
            ColliderBuilder::convex_hull(&corners)
        }
    }
}

fn cuboid(b: &SimBox) -> ColliderBuilder {
    let [x, y, z] = b.half_m;
    let pose = Pose::from_parts(Vector::from_array(b.center_m), Rotation::from_rotation_z(b.yaw_rad));
    ColliderBuilder::cuboid(x, y, z).position(pose)
}

fn collider(shape: &Collision) -> ColliderBuilder {
    match shape {
        Collision::Box { min, max } => {
            let (min, max) = (Vector::from_array(*min), Vector::from_array(*max));
            let half = (max - min) / 2.0;
            ColliderBuilder::cuboid(half.x, half.y, half.z).translation((min + max) / 2.0)
        }
        Collision::Cylinder { center, radius, length, axis } => {
            // the engine's cylinders stand along y
            let turn = match axis {
                0 => AngVector::new(0.0, 0.0, std::f64::consts::FRAC_PI_2),
                1 => AngVector::ZERO,
                _ => AngVector::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0),
            };
            let pose = Pose::from_parts(Vector::from_array(*center), Rotation::from_scaled_axis(turn));
            ColliderBuilder::cylinder(length / 2.0, *radius).position(pose)
        }
        Collision::TurnedBox { center, half, axes } => {
            let axes = Matrix::from_cols_array_2d(axes);
            let pose = Pose::from_parts(Vector::from_array(*center), Rotation::from_mat3(&axes));
            ColliderBuilder::cuboid(half[0], half[1], half[2]).position(pose)
        }
        Collision::Sphere { center, radius } => ColliderBuilder::ball(*radius).translation(Vector::from_array(*center)),
    }
}

fn volume_m3(shape: &Collision) -> f64 {
    match shape {
        Collision::Box { min, max } => (0..3).map(|i| max[i] - min[i]).product(),
        Collision::Cylinder { radius, length, .. } => std::f64::consts::PI * radius * radius * length,
        Collision::TurnedBox { half, .. } => 8.0 * half.iter().product::<f64>(),
        Collision::Sphere { radius, .. } => 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3),
    }
}
