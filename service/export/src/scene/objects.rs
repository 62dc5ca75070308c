//! Things, the models they are instances of, and lamps.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use d3dgen_mesh::{Model3d, writers};
use d3dgen_model::domain::Shape;
use d3dgen_model::placements::Placement;

use super::ids::Ids;
use super::{Mobility, Place, SimLight, SimModel, SimObject, physics};
use crate::Error;
use crate::models::KeptModels;
use crate::used::UsedModels;

/// What stands in a world.
pub(super) struct Things {
    pub models: Vec<SimModel>,
    pub objects: Vec<SimObject>,
    pub lights: Vec<SimLight>,
}

/// Returns the things of a world.
pub(super) fn all(place: &Place<'_>, kept: &dyn KeptModels, ids: &mut Ids) -> Result<Things, Error> {
    let used = UsedModels::of(place.world)?;
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
        mobility: kind.map_or(Mobility::Fixed, |k| physics::mobility(k, p.mount, p.size_m, mass_kg)),
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
        down: p.mount == d3dgen_model::domain::Mount::Ceiling,
    })
}
