//! Things, the models they are instances of, and lamps.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use d3dgen_mesh::{Collision, Model3d, writers};
use d3dgen_model::domain::{Mount, Shape};
use d3dgen_model::occupancy::FLAT_M;
use d3dgen_model::placements::Placement;

use super::ids::Ids;
use super::{Mobility, Place, SimLight, SimModel, SimObject, physics};
use crate::error::Error;
use crate::models::KeptModels;
use crate::used::UsedModels;

/// How far what stands on something may be off its top, m.
const REST_M: f64 = 0.0005;
/// Where near its corners a thing is looked at, as a share of its size, and at how many of five places it must be held.
const CORNER: f64 = 0.15;
const HELD_AT: usize = 3;

/// What stands in a world.
pub(super) struct Things {
    pub models: Vec<SimModel>,
    pub objects: Vec<SimObject>,
    pub lights: Vec<SimLight>,
}

/// Returns the things of a world.
pub(super) fn all(place: &Place<'_>, kept: &dyn KeptModels, ids: &mut Ids) -> Result<Things, Error> {
    let used = UsedModels::of(place.world, place.domain, kept)?;
    let models = models(place, &used, kept)?;
    let placements = &place.world.placements.placements;
    let given: Vec<String> = placements.iter().map(|p| ids.new_id(&p.placement_id)).collect();
    let mut things = Things { models, objects: Vec::new(), lights: Vec::new() };
    for (p, id) in placements.iter().zip(&given) {
        let reference = used.reference(p)?;
        let model = things.models.iter().position(|m| m.reference == reference).unwrap_or_default();
        let own = &things.models[model].model;
        let on = p.support.as_ref().and_then(|s| placements.iter().position(|q| &q.placement_id == s));
        let object = object(place, p, id, model, own, on.map(|k| given[k].clone()));
        if let Some(light) = light(place, p, &object, own, ids) {
            things.lights.push(light);
        }
        things.objects.push(object);
    }
    fix_what_rests_on_nothing(&mut things);
    Ok(things)
}

fn models(place: &Place<'_>, used: &UsedModels, kept: &dyn KeptModels) -> Result<Vec<SimModel>, Error> {
    let mut names = Ids::default();
    let made = used.made(place.domain, kept)?;
    let one = |made: crate::used::Made| {
        writers::check(&made.model).map_err(|source| Error::Asset { asset: made.reference.clone(), source })?;
        Ok(SimModel {
            id: names.new_id(&made.reference),
            reference: made.reference,
            object: made.object,
            is_kept: made.is_kept,
            model: made.model,
        })
    };
    made.into_iter().map(one).collect()
}

fn object(
    place: &Place<'_>,
    p: &Placement,
    id: &str,
    model: usize,
    own: &Model3d,
    support: Option<String>,
) -> SimObject {
    let level = place.level(&p.room_id);
    let kind = place.domain.object(&p.object);
    let mass_kg = own.bodies.iter().map(|b| b.mass_kg).sum();
    let contact = kind.map(physics::contact);
    let has_shapes = own.bodies.first().is_some_and(|b| !b.collisions.is_empty());
    let collides = has_shapes && !(p.mount == Mount::Floor && p.top_m() <= FLAT_M);
    SimObject {
        id: id.to_owned(),
        class: p.object.clone(),
        label: kind.map_or(p.object.as_str(), |k| k.label.as_str()).to_owned(),
        room_id: p.room_id.clone(),
        level,
        model,
        at_m: [p.pose.x, p.pose.y, place.storey(level).elevation_m + p.pose.z],
        yaw_rad: turned(p.pose.yaw_rad),
        support,
        mobility: kind
            .filter(|_| collides)
            .map_or(Mobility::Fixed, |k| physics::mobility(k, p.mount, p.size_m, mass_kg)),
        collides,
        mass_kg,
        friction: contact.map_or(0.5, |c| c.friction),
        restitution: contact.map_or(0.2, |c| c.restitution),
    }
}

/// Returns the heading of a model's x, whose front is its -y where that of a placement is its x: a quarter turn more.
fn turned(yaw_rad: f64) -> f64 {
    let turned = (yaw_rad + FRAC_PI_2).rem_euclid(TAU);
    if turned > PI + 1e-9 { turned - TAU } else { turned }
}

fn light(place: &Place<'_>, p: &Placement, object: &SimObject, own: &Model3d, ids: &mut Ids) -> Option<SimLight> {
    place.domain.object(&p.object).filter(|kind| kind.shape == Shape::Lamp)?;
    let (lamp, at) = physics::light(own, p.mount)?;
    let (sin, cos) = object.yaw_rad.sin_cos();
    let [x, y, z] = object.at_m;
    Some(SimLight {
        id: ids.new_id(&format!("{}_light", object.id)),
        object: object.id.clone(),
        room_id: p.room_id.clone(),
        at_m: [x + cos * at[0] - sin * at[1], y + sin * at[0] + cos * at[1], z + at[2]],
        lumens: lamp.lumens,
        kelvin: lamp.kelvin,
        down: p.mount == Mount::Ceiling,
    })
}

/// Fixes what cannot rest where the plan has it: a cup over the bowl of a basin, a thing that stands on a curved top. What
/// stands on a shape of its support at most half a millimeter off, at its middle or near most of its corners, may move.
fn fix_what_rests_on_nothing(things: &mut Things) {
    let rests = |object: &SimObject| {
        let support = object.support.as_ref().and_then(|id| things.objects.iter().find(|o| o.id == *id));
        support.is_none_or(|support| {
            let tops = tops_below(object, support, &things.models);
            let is_held = |top: &&f64| (object.at_m[2] - **top).abs() <= REST_M;
            tops.iter().all(|top| *top <= object.at_m[2] + REST_M) && tops.iter().filter(is_held).count() >= HELD_AT
        })
    };
    let loose: Vec<usize> = (0..things.objects.len()).filter(|&i| !rests(&things.objects[i])).collect();
    for i in loose {
        things.objects[i].mobility = Mobility::Fixed;
    }
}

/// Returns how high a support reaches below the middle of a thing and near its corners, m.
fn tops_below(object: &SimObject, support: &SimObject, models: &[SimModel]) -> Vec<f64> {
    let [own, under] = [object, support].map(|o| &models[o.model].model);
    let Some([min, max]) = own.bounds() else { return Vec::new() };
    let (sin, cos) = object.yaw_rad.sin_cos();
    let (back_sin, back_cos) = support.yaw_rad.sin_cos();
    let shapes: Vec<[[f64; 3]; 2]> = under.bodies.iter().flat_map(|b| &b.collisions).map(Collision::bounds).collect();
    let points =
        [[0.5, 0.5], [CORNER, CORNER], [1.0 - CORNER, CORNER], [1.0 - CORNER, 1.0 - CORNER], [CORNER, 1.0 - CORNER]];
    let top = |[u, v]: [f64; 2]| {
        let [x, y] = [min[0] + (max[0] - min[0]) * u, min[1] + (max[1] - min[1]) * v];
        let [dx, dy] = [object.at_m[0] - support.at_m[0], object.at_m[1] - support.at_m[1]];
        let [wx, wy] = [dx + cos * x - sin * y, dy + sin * x + cos * y];
        let p = [back_cos * wx + back_sin * wy, back_cos * wy - back_sin * wx];
        let holds = |b: &&[[f64; 3]; 2]| (0..2).all(|i| b[0][i] <= p[i] && p[i] <= b[1][i]);
        // What hangs over the thing, a shelf or a screen, is not what it stands on.
        let below = shapes.iter().filter(holds).filter(|b| support.at_m[2] + b[0][2] < object.at_m[2] - REST_M);
        below.map(|b| support.at_m[2] + b[1][2]).fold(f64::MIN, f64::max)
    };
    points.into_iter().map(top).collect()
}
