//! Things as bodies: fixed ones part of the world, others on free joints, each with the joints of its model.

use std::collections::BTreeSet;

use d3dgen_mesh::writers::number::{n, small};
use d3dgen_mesh::writers::quaternion;
use d3dgen_mesh::{Collision, Joint, JointKind, dynamics, mass};

use super::meshes::{self, Look};
use super::{Rest, about_z, list};
use crate::scene::{Mobility, SimModel, SimObject, SimScene};
use crate::xml::Xml;

/// Writes a thing.
pub(super) fn thing(xml: &mut Xml, scene: &SimScene, object: &SimObject, rest: &mut Rest) {
    let Some(model) = scene.models.get(object.model) else { return };
    let own = &model.model;
    let (balanced, bearing) = (dynamics::balanced(own), dynamics::bearing(own));
    let thing = Thing { object, model, looks: meshes::looks(model), balanced, bearing };
    thing.body(xml, 0, None, rest);
    let count = if thing.is_free() { model.model.bodies.len() } else { 0 };
    // The parts of one thing do not meet each other: those of a fixed thing by their class, these one by one.
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    rest.excludes.extend(pairs.map(|(a, b)| [thing.name(a), thing.name(b)]));
}

/// Writes which doors and drawers pass what stands in their way.
pub(super) fn passes(scene: &SimScene, rest: &mut Rest) {
    let thing = |object: usize| {
        let object = scene.objects.get(object)?;
        let (balanced, bearing) = (BTreeSet::new(), BTreeSet::new());
        Some(Thing { object, model: scene.models.get(object.model)?, looks: Vec::new(), balanced, bearing })
    };
    for pass in &scene.passes {
        let (Some(own), Some(other)) = (thing(pass.object), thing(pass.other)) else { continue };
        let Some(body) = own.model.model.bodies.iter().position(|b| b.name == pass.body) else { continue };
        rest.excludes.extend((0..other.model.model.bodies.len()).map(|b| [own.name(body), other.name(b)]));
    }
}

struct Thing<'a> {
    object: &'a SimObject,
    model: &'a SimModel,
    looks: Vec<Vec<Look<'a>>>,
    /// Bodies that gas springs and counterweights bear; the engine knows them as bodies without weight.
    balanced: BTreeSet<usize>,
    /// Bodies that stand on the floor.
    bearing: BTreeSet<usize>,
}

impl Thing<'_> {
    /// Returns the name of a body: the root has the id of the thing.
    fn name(&self, body: usize) -> String {
        match body {
            0 => self.object.id.clone(),
            _ => format!("{}_{}", self.object.id, self.model.model.bodies[body].name),
        }
    }

    fn is_free(&self) -> bool {
        self.object.mobility != Mobility::Fixed
    }

    /// Writes a body and those that joints hold to it; all are in the frame of the model.
    fn body(&self, xml: &mut Xml, index: usize, joint: Option<&Joint>, rest: &mut Rest) {
        let name = self.name(index);
        let mut attributes = vec![("name", name.clone())];
        if index == 0 {
            attributes.push(("pos", list(&self.object.at_m)));
            attributes.push(("quat", list(&about_z(self.object.yaw_rad))));
        }
        if self.balanced.contains(&index) {
            attributes.push(("gravcomp", "1".to_owned()));
        }
        xml.begin("body", &attributes);
        if index == 0 && self.is_free() {
            xml.leaf("freejoint", &[("name", format!("{name}_free"))]);
            let at: Vec<f64> = self.object.at_m.into_iter().chain(about_z(self.object.yaw_rad)).collect();
            rest.closed.extend(&at);
            rest.open.extend(&at);
        }
        if let Some(joint) = joint {
            self.joint(xml, joint, rest);
        }
        if index > 0 || self.is_free() {
            self.inertial(xml, index);
        }
        for look in self.looks.get(index).into_iter().flatten() {
            let mut geom = vec![("class", "visual".to_owned()), ("mesh", look.name.clone())];
            geom.extend(look.material.map(|m| ("material", meshes::material(self.model, m))));
            xml.leaf("geom", &geom);
        }
        if self.object.collides {
            self.collisions(xml, index);
        }
        for joint in self.model.model.joints.iter().filter(|j| j.parent == index) {
            if !self.is_free() {
                // The engine does not tell what stands still from the world, and excludes no parent of that kind by itself.
                rest.excludes.push([name.clone(), self.name(joint.child)]);
            }
            self.body(xml, joint.child, Some(joint), rest);
        }
        xml.end();
    }

    fn inertial(&self, xml: &mut Xml, index: usize) {
        let inertia = mass::inertia(&self.model.model.bodies[index]);
        let (moments, axes) = inertia.principal();
        let attributes = [
            ("pos", list(&inertia.center_m)),
            ("quat", list(&quaternion(axes))),
            ("mass", small(inertia.mass_kg)),
            ("diaginertia", physical(moments).map(small).join(" ")),
        ];
        xml.leaf("inertial", &attributes);
    }

    fn joint(&self, xml: &mut Xml, joint: &Joint, rest: &mut Rest) {
        let resists = dynamics::of(&self.model.model, joint);
        let kind = if joint.kind == JointKind::Prismatic { "slide" } else { "hinge" };
        let mut attributes = vec![
            ("name", format!("{}_{}", self.object.id, joint.name)),
            ("class", "articulable".to_owned()),
            ("type", kind.to_owned()),
            ("pos", list(&joint.origin)),
            ("axis", list(&joint.axis)),
            ("armature", n(dynamics::armature(joint.limits))),
            ("damping", n(resists.damping)),
            ("frictionloss", n(if resists.spring.is_some() { resists.idle } else { resists.friction })),
        ];
        attributes.extend(joint.limits.map(|l| ("range", list(&l))));
        xml.leaf("joint", &attributes);
        let rest_at = joint.limits.map_or(0.0, |[low, high]| 0.0_f64.clamp(low, high));
        rest.closed.push(rest_at);
        rest.open.push(rest_at);
    }

    fn collisions(&self, xml: &mut Xml, index: usize) {
        let class = match (index, self.is_free()) {
            (0, false) => "structural",
            // What stands free is carried by its wheels too.
            (_, true) if self.bearing.contains(&index) => "dynamic",
            (_, _) => "articulable",
        };
        for (k, shape) in self.model.model.bodies[index].collisions.iter().enumerate() {
            let mut attributes =
                vec![("name", format!("{}_collision_{k}", self.name(index))), ("class", class.to_owned())];
            if class == "structural" {
                attributes.push(("group", "3".to_owned()));
            }
            attributes.extend(geometry(shape));
            let rolls = matches!(shape, Collision::Sphere { .. } | Collision::Cylinder { .. });
            let friction = self.object.friction;
            if rolls && class == "dynamic" {
                attributes.push(("condim", "6".to_owned()));
                attributes.push(("friction", list(&[friction, 0.01, 0.01])));
            } else {
                attributes.push(("friction", list(&[friction, 0.005, 0.0001])));
            }
            xml.leaf("geom", &attributes);
        }
    }
}

/// Returns moments that a body can have: none above the sum of the others, which rounding makes of thin plates.
fn physical(moments: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| moments[i].min((moments[(i + 1) % 3] + moments[(i + 2) % 3]) * (1.0 - 1e-6)).max(1e-9))
}

fn geometry(shape: &Collision) -> Vec<(&'static str, String)> {
    match shape {
        Collision::Box { min, max } => {
            let half: [f64; 3] = std::array::from_fn(|i| (max[i] - min[i]) / 2.0);
            let center: [f64; 3] = std::array::from_fn(|i| (max[i] + min[i]) / 2.0);
            vec![("pos", list(&center)), ("size", list(&half))]
        }
        Collision::TurnedBox { center, half, axes } => {
            vec![("pos", list(center)), ("size", list(half)), ("quat", list(&quaternion(*axes)))]
        }
        Collision::Sphere { center, radius } => {
            vec![("type", "sphere".to_owned()), ("pos", list(center)), ("size", n(*radius))]
        }
        Collision::Cylinder { center, radius, length, axis } => {
            let along: [f64; 3] = std::array::from_fn(|i| if i == *axis { 1.0 } else { 0.0 });
            vec![
                ("type", "cylinder".to_owned()),
                ("pos", list(center)),
                ("size", list(&[*radius, length / 2.0])),
                ("zaxis", list(&along)),
            ]
        }
    }
}
