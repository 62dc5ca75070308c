//! Rigid bodies and joints of a build, with their copies.

use std::collections::BTreeMap;

use d3dgen_model::domain::{BASE, BuildJoint, BuildJointKind, Mirror, Repeat};

use super::copies;
use super::scope::Scope;
use crate::affine::{Affine, Vec3, scale, unit};
use crate::error::Error;
use crate::model3d::JointKind;

/// The copies of a moving body.
pub(super) struct Moving<'a> {
    /// Its own, or those of its parent.
    pub repeat: Option<&'a Repeat>,
    pub mirror: Option<Mirror>,
    pub repeats: Vec<Affine>,
    pub mirrors: Vec<Affine>,
    /// Indices of its copies in [`Bodies::list`]: copy `i` mirrored by `k` is at `i * mirrors + k`.
    pub indices: Vec<usize>,
}

/// One rigid body before its parts are made.
pub(super) struct Planned {
    pub name: String,
    pub joint: Option<PlannedJoint>,
}

/// How a body moves, in the frame of the build.
pub(super) struct PlannedJoint {
    pub kind: JointKind,
    pub parent: usize,
    pub origin: Vec3,
    pub axis: Vec3,
    pub limits: Option<[f64; 2]>,
}

/// All bodies of a build at a size.
pub(super) struct Bodies<'a> {
    pub list: Vec<Planned>,
    moving: BTreeMap<&'a str, Moving<'a>>,
    /// Bodies whose joint is left out -> the body they are part of.
    fixed: BTreeMap<&'a str, &'a str>,
}

impl<'a> Bodies<'a> {
    /// Works out every joint.
    ///
    /// # Errors
    /// `Build` with the joint and field.
    pub fn new(scope: &'a Scope<'a>) -> Result<Self, Error> {
        let mut bodies = Self {
            list: vec![Planned { name: BASE.to_owned(), joint: None }],
            moving: BTreeMap::new(),
            fixed: BTreeMap::new(),
        };
        for (j, joint) in scope.build.joints.iter().enumerate() {
            bodies.add(scope, joint, &format!("joint {j} ({})", joint.body))?;
        }
        Ok(bodies)
    }

    /// Returns the copies of a body by its name in the build; none for the base.
    pub fn moving(&self, name: &str) -> Option<&Moving<'a>> {
        let mut name = name;
        while let Some(parent) = self.fixed.get(name) {
            name = parent;
        }
        self.moving.get(name)
    }

    fn add(&mut self, scope: &'a Scope<'a>, joint: &'a BuildJoint, place: &str) -> Result<(), Error> {
        if let Some(when) = &joint.when
            && scope.local(0, 1).value(when, &|| format!("{place}, when"))? <= 0.0
        {
            self.fixed.insert(&joint.body, &joint.parent);
            return Ok(());
        }
        let parent = self.moving(&joint.parent);
        let own = joint.repeat.is_some() || joint.mirror.is_some();
        let (repeat, mirror) = match parent {
            Some(parent) if !own => (parent.repeat, parent.mirror),
            _ => (joint.repeat.as_ref(), joint.mirror),
        };
        let repeats = copies::repeats(scope, repeat, place)?;
        let mirrors = copies::mirrors(scope, mirror);
        let count = repeats.len() * mirrors.len();
        let parents: Vec<usize> = match parent {
            None => vec![0; count],
            Some(p) if p.indices.len() == count => p.indices.clone(),
            Some(p) if p.indices.len() == 1 => vec![p.indices[0]; count],
            Some(p) => {
                let reason = format!("makes {count} copies, its parent has {}", p.indices.len());
                return Err(scope.error(format!("{place}, repeat"), reason));
            }
        };
        let mut indices = Vec::new();
        for (i, repeated) in repeats.iter().enumerate() {
            let local = scope.local(i, repeats.len());
            let at = |field: &'static str| move || format!("{place}, {field}");
            let origin = local.values(&joint.at, &at("at"))?;
            let limits = joint.limits.as_ref().map(|l| local.values(l, &at("limits"))).transpose()?;
            if limits.is_some_and(|[low, high]| low > high) {
                return Err(scope.error(at("limits")(), "the first is above the second"));
            }
            for mirrored in &mirrors {
                let map = mirrored.after(repeated);
                let number = indices.len();
                let name = if count == 1 { joint.body.clone() } else { format!("{}_{number}", joint.body) };
                indices.push(self.list.len());
                self.list.push(Planned {
                    name,
                    joint: Some(PlannedJoint {
                        kind: kind(joint.kind),
                        parent: parents[number],
                        origin: map.point(origin),
                        axis: axis(joint, &map),
                        limits: limits
                            .map(|l| if joint.kind == BuildJointKind::Revolute { l.map(f64::to_radians) } else { l }),
                    }),
                });
            }
        }
        self.moving.insert(&joint.body, Moving { repeat, mirror, repeats, mirrors, indices });
        Ok(())
    }
}

fn kind(kind: BuildJointKind) -> JointKind {
    match kind {
        BuildJointKind::Revolute => JointKind::Revolute,
        BuildJointKind::Prismatic => JointKind::Prismatic,
        BuildJointKind::Continuous => JointKind::Continuous,
    }
}

/// Returns the axis of a copy; a mirror turns the sense of a turn around.
fn axis(joint: &BuildJoint, map: &Affine) -> Vec3 {
    let axis = unit(map.vector(unit(joint.axis)));
    let turns = joint.kind != BuildJointKind::Prismatic;
    let axis = if turns && map.mirrors() { scale(axis, -1.0) } else { axis };
    axis.map(|v| if v.abs() < 1e-12 { 0.0 } else { v })
}
