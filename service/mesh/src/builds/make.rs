//! A build at a size becomes a model: parts are made, moved, sorted into bodies and fitted to the size.

use d3dgen_model::domain::{Build, ObjectType, Part, Solid};
use d3dgen_model::seed::Stream;

use super::bodies::Bodies;
use super::scope::{Local, Scope};
use super::solids::{self, Detail, Frame, Hull, Made};
use super::tones::{self, Look};
use super::{collide, copies, unwrap};
use crate::affine::Affine;
use crate::error::Error;
use crate::model3d::{Body, Joint, Material, Model3d, Visual};
use crate::surface::Surface;

/// How far a build may miss its size: a share of the extent, and m for thin things.
const MISS: (f64, f64) = (0.02, 0.0005);

/// A part in its place.
struct Piece {
    body: usize,
    look: Look,
    surface: Surface,
    hulls: Vec<(Hull, Affine)>,
}

/// Makes the model.
///
/// # Errors
/// `Build` with the part and field.
pub(super) fn model(
    build: &Build,
    object: &ObjectType,
    size: [f64; 3],
    seed: u64,
    detail: Detail,
) -> Result<Model3d, Error> {
    let scope = Scope::new(build, size, seed)?;
    let bodies = Bodies::new(&scope)?;
    let mut pieces = Vec::new();
    for (p, part) in build.parts.iter().enumerate() {
        let place = if part.id.is_empty() { format!("part {p}") } else { format!("part {p} ({})", part.id) };
        Maker { scope: &scope, bodies: &bodies, object, seed, detail, part, place, number: p }.add(&mut pieces)?;
    }
    let fit = fit(&scope, &pieces)?;
    let total = build.mass_kg.as_ref().map(|m| scope.local(0, 1).value(m, &|| "mass_kg".to_owned())).transpose()?;
    assemble(&scope, object, bodies, pieces, &fit, total)
}

struct Maker<'a> {
    scope: &'a Scope<'a>,
    bodies: &'a Bodies<'a>,
    object: &'a ObjectType,
    seed: u64,
    detail: Detail,
    part: &'a Part,
    place: String,
    number: usize,
}

impl Maker<'_> {
    /// Adds every copy of the part.
    fn add(&self, pieces: &mut Vec<Piece>) -> Result<(), Error> {
        let (scope, part) = (self.scope, self.part);
        let look = tones::look(part.tone, part.color.as_deref(), self.object);
        let own = copies::repeats(scope, part.repeat.as_ref(), &self.place)?;
        let Some(moving) = self.bodies.moving(&part.body) else {
            for (i, repeated) in own.iter().enumerate() {
                let maps: Vec<Affine> = copies::mirrors(scope, part.mirror).iter().map(|m| m.after(repeated)).collect();
                self.copies(scope.local(i, own.len()), &look, &maps.map_to(0), pieces)?;
            }
            return Ok(());
        };
        // A part that repeats as its body does goes with it, one copy each; else every body has all its copies.
        let together = part.repeat.is_some() && moving.repeat.is_some() && own.len() == moving.repeats.len();
        let mirrors =
            if moving.mirror.is_some() { vec![Affine::IDENTITY] } else { copies::mirrors(scope, part.mirror) };
        for (i, outer) in moving.repeats.iter().enumerate() {
            let inner: Vec<(usize, usize, Affine)> = if together {
                vec![(i, own.len(), own[i])]
            } else if part.repeat.is_some() {
                own.iter().enumerate().map(|(r, m)| (r, own.len(), outer.after(m))).collect()
            } else {
                vec![(i, moving.repeats.len(), *outer)]
            };
            for (number, count, map) in inner {
                let mut maps = Vec::new();
                for (k, mirrored) in moving.mirrors.iter().enumerate() {
                    let body = moving.indices[i * moving.mirrors.len() + k];
                    maps.extend(mirrors.iter().map(|m| (body, mirrored.after(&m.after(&map)))));
                }
                self.copies(scope.local(number, count), &look, &maps, pieces)?;
            }
        }
        Ok(())
    }

    /// Makes the solid once and puts it at each place.
    fn copies(
        &self,
        local: Local<'_>,
        look: &Look,
        maps: &[(usize, Affine)],
        pieces: &mut Vec<Piece>,
    ) -> Result<(), Error> {
        let at = |field: &'static str| move || format!("{}, {field}", self.place);
        if let Some(when) = &self.part.when
            && local.value(when, &at("when"))? <= 0.0
        {
            return Ok(());
        }
        let made = self.solid(local)?;
        let tilt = match &self.part.tilt {
            None => Affine::IDENTITY,
            Some(tilt) => {
                let deg = local.value(&tilt.deg, &at("tilt/deg"))?;
                Affine::turn(tilt.axis.index(), deg, local.values(&tilt.at, &at("tilt/at"))?)
            }
        };
        for (body, map) in maps {
            let map = map.after(&tilt);
            pieces.push(Piece {
                body: *body,
                look: look.clone(),
                hulls: if self.part.collide { made.hulls.iter().map(|h| (*h, map)).collect() } else { Vec::new() },
                surface: made.surface.clone().moved(&map),
            });
        }
        Ok(())
    }

    fn solid(&self, local: Local<'_>) -> Result<Made, Error> {
        let part = self.part;
        let number = |formula: &Option<_>, field: &'static str, other: f64| match formula {
            Some(formula) => local.value(formula, &|| format!("{}, {field}", self.place)),
            None => Ok(other),
        };
        let wrong = |reason: String| self.scope.error(self.place.as_str(), reason);
        let axis = part.axis.unwrap_or_default().index();
        let bevel = number(&part.bevel, "bevel", 0.0)?.max(0.0);
        let made = match part.solid {
            Solid::Box => solids::upright_box(&self.frame(local)?, bevel),
            Solid::Cushion => {
                let frame = self.frame(local)?;
                let least = frame.size().into_iter().fold(f64::MAX, f64::min);
                solids::cushion(&frame, number(&part.round, "round", (0.4 * least).min(0.05))?, self.detail)
            }
            Solid::Cylinder => solids::cone(&self.frame(local)?, axis, 1.0, bevel, self.detail),
            Solid::Cone => {
                let top = number(&part.top, "top", 1.0)?;
                if top < 0.0 {
                    return Err(wrong(format!("top is {top}, which is below 0")));
                }
                solids::cone(&self.frame(local)?, axis, top, bevel, self.detail)
            }
            Solid::Sphere => solids::sphere(&self.frame(local)?, self.detail),
            Solid::Torus => {
                let radius = number(&part.radius, "radius", 0.01)?;
                solids::torus(&self.frame(local)?, radius, axis, self.detail).map_err(wrong)?
            }
            Solid::Shell => {
                let wall = number(&part.wall, "wall", 0.01)?;
                let bottom = number(&part.bottom, "bottom", wall)?;
                solids::shell(&self.frame(local)?, wall, bottom, part.open.unwrap_or_default()).map_err(wrong)?
            }
            Solid::Leaves => {
                let count = number(&part.count, "count", 20.0)?;
                let label = format!("{}/{}/{}", self.scope.build.id, self.number, local.i);
                solids::leaves(
                    &self.frame(local)?,
                    count.max(0.0) as usize,
                    &mut Stream::new(self.seed, &label),
                    self.detail,
                )
            }
            Solid::Tube => {
                let path = self.points(local, &part.path, "path")?;
                let radius = number(&part.radius, "radius", 0.01)?;
                solids::tube(&path, radius, part.smooth, part.closed, self.detail).map_err(wrong)?
            }
            Solid::Lathe => {
                let profile = self.points(local, &part.profile, "profile")?;
                let pair = |values: &Option<_>, field: &'static str, other| match values {
                    Some(values) => local.values(values, &|| format!("{}, {field}", self.place)),
                    None => Ok(other),
                };
                let (at, stretch) = (pair(&part.at, "at", [0.0; 2])?, pair(&part.stretch, "stretch", [1.0; 2])?);
                solids::lathe(&profile, at, stretch, axis, self.detail).map_err(wrong)?
            }
            Solid::Prism => {
                let outline = self.points(local, &part.outline, "outline")?;
                let range = self.range(local, axis)?;
                solids::prism(&outline, axis, range).map_err(wrong)?
            }
        };
        Ok(made)
    }

    fn points<const N: usize>(
        &self,
        local: Local<'_>,
        points: &[[d3dgen_model::domain::Formula; N]],
        field: &'static str,
    ) -> Result<Vec<[f64; N]>, Error> {
        let value = |(j, point)| local.values(point, &|| format!("{}, {field}/{j}", self.place));
        points.iter().enumerate().map(value).collect()
    }

    fn range(&self, local: Local<'_>, axis: usize) -> Result<[f64; 2], Error> {
        let (name, range) = [("x", &self.part.x), ("y", &self.part.y), ("z", &self.part.z)][axis];
        let place = || format!("{}, {name}", self.place);
        let Some(range) = range else { return Err(self.scope.error(place(), "is missing")) };
        let [low, high] = local.values(range, &place)?;
        if high - low < 1e-5 {
            let reason = format!("runs from {low:.4} to {high:.4} m; the second must be larger");
            return Err(self.scope.error(place(), reason));
        }
        Ok([low, high])
    }

    fn frame(&self, local: Local<'_>) -> Result<Frame, Error> {
        let (x, y, z) = (self.range(local, 0)?, self.range(local, 1)?, self.range(local, 2)?);
        Ok(Frame { min: [x[0], y[0], z[0]], max: [x[1], y[1], z[1]] })
    }
}

/// Maps of parts that belong to one body.
trait MapTo {
    fn map_to(self, body: usize) -> Vec<(usize, Affine)>;
}

impl MapTo for Vec<Affine> {
    fn map_to(self, body: usize) -> Vec<(usize, Affine)> {
        self.into_iter().map(|m| (body, m)).collect()
    }
}

/// Returns the map from the frame of the build to that of the model, which makes the bounds the size exactly.
fn fit(scope: &Scope<'_>, pieces: &[Piece]) -> Result<Affine, Error> {
    let size = scope.size;
    let bounds = pieces
        .iter()
        .map(|p| p.surface.bounds())
        .reduce(|a, b| [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]);
    let Some([low, high]) = bounds else {
        return Err(scope.error("parts", "none is left at this size"));
    };
    for (k, (name, ends)) in
        [("x", "left and right"), ("y", "front and back"), ("z", "underside and top")].iter().enumerate()
    {
        let miss = low[k].abs().max((high[k] - size[k]).abs());
        if miss > MISS.0 * size[k] + MISS.1 {
            let reason = format!(
                "the parts span {name} {:.4} to {:.4} m; they must touch {ends}, 0 and {:.4} m",
                low[k], high[k], size[k]
            );
            return Err(scope.error("parts", reason));
        }
    }
    let factors: [f64; 3] = std::array::from_fn(|k| size[k] / (high[k] - low[k]));
    let middle = [size[0] / 2.0, size[1] / 2.0, 0.0];
    Ok(Affine::stretch(factors, std::array::from_fn(|k| -low[k] * factors[k] - middle[k])))
}

/// Sorts the pieces into bodies and materials.
fn assemble(
    scope: &Scope<'_>,
    object: &ObjectType,
    bodies: Bodies<'_>,
    pieces: Vec<Piece>,
    fit: &Affine,
    total_kg: Option<f64>,
) -> Result<Model3d, Error> {
    let mut model = Model3d { name: object.id.clone(), ..Model3d::default() };
    let mut surfaces: Vec<Vec<(usize, Surface)>> = bodies.list.iter().map(|_| Vec::new()).collect();
    let mut shapes: Vec<Vec<crate::model3d::Collision>> = bodies.list.iter().map(|_| Vec::new()).collect();
    let mut masses = vec![0.0; bodies.list.len()];
    for piece in pieces {
        let material = match model.materials.iter().position(|m| *m == piece.look.material) {
            Some(index) => index,
            None => {
                model.materials.push(piece.look.material.clone());
                model.materials.len() - 1
            }
        };
        let (volume, area) = (piece.surface.volume(), piece.surface.area());
        masses[piece.body] += piece.look.density * volume.min(area * piece.look.wall);
        shapes[piece.body].extend(piece.hulls.iter().map(|(hull, map)| collide::moved(hull, &fit.after(map))));
        match surfaces[piece.body].iter_mut().find(|(m, _)| *m == material) {
            Some((_, surface)) => surface.append(&piece.surface),
            None => surfaces[piece.body].push((material, piece.surface)),
        }
    }
    if surfaces[0].is_empty() {
        return Err(scope.error("parts", "none belongs to the base"));
    }
    let sum: f64 = masses.iter().sum();
    let factor = match total_kg {
        Some(total) if total > 0.0 && sum > 0.0 => total / sum,
        Some(total) => return Err(scope.error("mass_kg", format!("is {total} kg"))),
        None => 1.0,
    };
    // Bodies without parts at this size are left out, with their joints.
    let mut kept: Vec<Option<usize>> = Vec::new();
    for (b, ((planned, surfaces), shapes)) in bodies.list.into_iter().zip(surfaces).zip(shapes).enumerate() {
        if surfaces.is_empty() {
            kept.push(None);
            continue;
        }
        let index = model.bodies.len();
        kept.push(Some(index));
        if let Some(joint) = planned.joint {
            model.joints.push(Joint {
                name: format!("{}_joint", planned.name),
                kind: joint.kind,
                parent: kept.get(joint.parent).copied().flatten().unwrap_or(0),
                child: index,
                origin: fit.point(joint.origin),
                axis: joint.axis,
                limits: joint.limits,
            });
        }
        let visuals = surfaces.into_iter().map(|(material, surface)| Visual {
            name: model.materials[material].name.to_lowercase(),
            mesh: unwrap::mesh(&surface.moved(fit), has_grain(&model.materials[material])),
            material: Some(material),
        });
        let mass_kg = ((masses[b] * factor).max(0.005) * 1e4).round() / 1e4;
        model.bodies.push(Body {
            name: planned.name,
            visuals: visuals.collect(),
            collisions: collide::merged(shapes),
            mass_kg,
        });
    }
    unique_names(&mut model);
    Ok(model)
}

/// Returns whether a material has a direction, as wood has.
fn has_grain(material: &Material) -> bool {
    material.worn().is_some_and(|finish| finish.pattern.has_grain())
}

/// Gives materials of one name numbers.
fn unique_names(model: &mut Model3d) {
    for i in 0..model.materials.len() {
        let same = model.materials[..i].iter().filter(|m| m.name == model.materials[i].name).count();
        if same > 0 {
            model.materials[i].name = format!("{}_{same}", model.materials[i].name);
        }
    }
    for body in &mut model.bodies {
        for visual in &mut body.visuals {
            if let Some(material) = visual.material {
                visual.name = model.materials[material].name.to_lowercase();
            }
        }
    }
}
