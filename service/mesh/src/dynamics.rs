//! What holds a joint: a spring that balances most of the weight on it, as gas springs and counterweights do, friction that
//! bears the rest anywhere in its range, and damping that lets it move at the pace of furniture. All follow from masses and
//! arms, so a dishwasher's door stays where it is left as a drawer does.

use std::collections::BTreeSet;

use crate::affine::{Vec3, add, cross, dot, scale, sub};
use crate::mass::{Inertia, inertia};
use crate::model3d::{Joint, JointKind, Model3d};

/// Gravity, m/s^2.
const GRAVITY: f64 = 9.81;
/// How much more than the weight friction bears.
const SAFETY: f64 = 1.1;
/// Friction of a joint that bears no weight, as a share of the weight of what moves at a tenth of its arm, and at least,
/// N m or N.
const ROLLING: f64 = 0.02;
const LEAST: f64 = 0.01;
/// Inertia that engines add to a joint that turns by 1 rad or goes 1 m: kg m^2 or kg.
const ARMATURE: f64 = 0.015;
/// Least damping of a drive that turns something, N m s/rad: the smallest lids, pushed as hard as a door, stop at their limit.
const LEAST_TURNING: f64 = 0.2;
/// How many ranges long a spring is drawn that pulls evenly.
const FLAT: f64 = 50.0;
/// How long what moves goes on by itself, s.
const SLOWS_S: f64 = 1.0;
/// Positions of its range at which the weight on a joint is looked at.
const POSITIONS: usize = 33;
/// An axis nearer to upright than this (cosine) does not tilt what it turns.
const UPRIGHT: f64 = 0.999;
/// How far a joint is looked at that has no limits: rad, and m.
const ALL_ROUND: [f64; 2] = [0.0, std::f64::consts::TAU];

/// How far above the floor a part of a thing still stands on it, m.
const STANDS_M: f64 = 0.005;
/// Most joints above and below one whose ends are looked at together.
const RELATED: usize = 4;

/// How a joint resists.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dynamics {
    /// What moves it against its direction is borne up to this: N m, or N for a prismatic joint.
    pub friction: f64,
    /// The same where a counterweight bears all that a spring would.
    pub idle: f64,
    /// N m s/rad, or N s/m.
    pub damping: f64,
    /// What balances the weight; none where there is next to none.
    pub spring: Option<Spring>,
}

/// A spring of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// N m/rad, or N/m.
    pub stiffness: f64,
    /// Position without force, which may be beyond the range: rad, or m.
    pub reference: f64,
}

/// How a joint resists whose engine knows drives, and no springs with an end beyond the range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// N m, or N, along the joint at any position: a counterweight on a rope.
    pub push: f64,
    /// As of [`Dynamics`].
    pub friction: f64,
    /// As of [`Dynamics`].
    pub damping: f64,
}

/// A model whose lids, flaps and lifts are borne without springs.
#[derive(Debug, Clone, PartialEq)]
pub struct Borne {
    /// How each body resists being moved: what hangs on a hinge has its counterweight in it, so that its center of mass lies on
    /// the axis and it stays where it is left.
    pub bodies: Vec<Inertia>,
    /// How each joint resists.
    pub joints: Vec<Drive>,
}

/// Returns a model with counterweights: in the bodies themselves of what turns, as an even push on what slides.
pub fn borne(model: &Model3d) -> Borne {
    let mut bodies: Vec<Inertia> = model.bodies.iter().map(inertia).collect();
    let mut joints: Vec<&Joint> = model.joints.iter().filter(|j| j.kind == JointKind::Revolute).collect();
    joints.sort_by_key(|joint| bodies_moved(model, joint).len());
    for joint in joints {
        let weight = Weight::of(model, joint, &bodies);
        if joint.limits.is_some() && weight.left(|_| 0.0) > weight.idle {
            counterweigh(&mut bodies, model, joint);
        }
    }
    let joints = model.joints.iter().map(|joint| drive(&Weight::of(model, joint, &bodies), joint)).collect();
    Borne { bodies, joints }
}

/// Puts into the body of a hinge what balances all that hangs on it.
fn counterweigh(bodies: &mut [Inertia], model: &Model3d, joint: &Joint) {
    let off_axis = |way: Vec3| sub(way, scale(joint.axis, dot(way, joint.axis)));
    let moment = |b: usize| {
        let body = bodies.get(b)?;
        Some(scale(off_axis(sub(body.center_m, joint.origin)), body.mass_kg))
    };
    let hanging = bodies_moved(model, joint).into_iter().filter_map(moment).fold([0.0; 3], add);
    let Some(own) = bodies.get_mut(joint.child).filter(|b| b.mass_kg > 0.0) else { return };
    let arm = off_axis(sub(own.center_m, joint.origin));
    let square = dot(arm, arm);
    for i in 0..3 {
        for j in 0..3 {
            // Its inertia about the axis stays what it was.
            own.tensor[i][j] += own.mass_kg * (if i == j { square } else { 0.0 } - arm[i] * arm[j]);
        }
    }
    own.center_m = sub(own.center_m, scale(hanging, 1.0 / own.mass_kg));
}

/// Returns how a joint resists that bears a weight.
fn drive(weight: &Weight, joint: &Joint) -> Drive {
    let loads = || weight.alone.iter().map(|l| l.1);
    let even = -(loads().fold(f64::MAX, f64::min) + loads().fold(f64::MIN, f64::max)) / 2.0;
    let none = weight.left(|_| 0.0);
    let is_pushed = joint.limits.is_some() && none > weight.idle && weight.left(|_| even) < none;
    let push = if is_pushed { even } else { 0.0 };
    let least = if joint.kind == JointKind::Prismatic { LEAST } else { LEAST_TURNING };
    Drive { push, friction: weight.friction(weight.left(|_| push)), damping: weight.damping.max(least) }
}

/// Returns the inertia that engines add to a joint with these limits, kg m^2 or kg: levers and lids, pushed as hard as a door,
/// stay within what a step of theirs can follow. The shorter the way, the sooner its end is there.
pub fn armature(limits: Option<[f64; 2]>) -> f64 {
    let range = limits.map_or(1.0, |[low, high]| (high - low).clamp(0.01, 1.0));
    ARMATURE / range
}

/// Returns how a joint of a model resists.
pub fn of(model: &Model3d, joint: &Joint) -> Dynamics {
    let bodies: Vec<Inertia> = model.bodies.iter().map(inertia).collect();
    let weight = Weight::of(model, joint, &bodies);
    let pull = |spring: Spring| move |at: f64| spring.stiffness * (spring.reference - at);
    let none = weight.left(|_| 0.0);
    let spring =
        spring(&weight.alone).filter(|s| joint.limits.is_some() && none > weight.idle && weight.left(pull(*s)) < none);
    let left = spring.map_or(none, |s| weight.left(pull(s)));
    Dynamics { friction: weight.friction(left), idle: weight.idle, damping: weight.damping, spring }
}

/// Returns the bodies of a model that bear it where it stands: its root, wheels, and what reaches as far down as it does. All
/// others are lids, drawers, lifts and the like, which need not meet the floor and the walls.
pub fn bearing(model: &Model3d) -> BTreeSet<usize> {
    let lowest = |bodies: &[usize]| {
        let shapes = bodies.iter().filter_map(|b| model.bodies.get(*b)).flat_map(|b| &b.collisions);
        shapes.map(|s| s.bounds()[0][2]).fold(f64::MAX, f64::min)
    };
    let floor = lowest(&(0..model.bodies.len()).collect::<Vec<_>>());
    let bears = |j: &&Joint| j.limits.is_none() || lowest(&bodies_moved(model, j)) < floor + STANDS_M;
    std::iter::once(0).chain(model.joints.iter().filter(bears).map(|j| j.child)).collect()
}

/// Returns the bodies of a model whose weight springs balance, for engines that take weight away.
pub fn balanced(model: &Model3d) -> BTreeSet<usize> {
    let sprung = model.joints.iter().filter(|joint| of(model, joint).spring.is_some());
    sprung.flat_map(|joint| bodies_moved(model, joint)).collect()
}

/// The weight on a joint.
struct Weight {
    /// Over its range, with all other joints at zero: position, and N m or N.
    alone: Vec<(f64, f64)>,
    /// The same in the poses that others can take.
    posed: Vec<(f64, f64)>,
    /// Friction where nothing pulls, N m or N.
    idle: f64,
    damping: f64,
}

impl Weight {
    fn of(model: &Model3d, joint: &Joint, bodies: &[Inertia]) -> Self {
        let moved = moved(model, joint, bodies);
        let mass: f64 = moved.iter().map(|b| b.0.mass_kg).sum();
        let (resists, idle) = match joint.kind {
            JointKind::Prismatic => (mass, mass * GRAVITY),
            JointKind::Revolute | JointKind::Continuous => {
                let about = moved.iter().map(|b| about_axis(&b.0, joint)).sum::<f64>();
                let arm = if mass > 0.0 { (about / mass).sqrt() } else { 0.0 };
                (about, mass * GRAVITY * arm * 0.1)
            }
        };
        let posed = poses(model, joint).iter().flat_map(|pose| loads(&moved, joint, pose)).collect();
        Self {
            alone: loads(&moved, joint, &Pose::default()),
            posed,
            idle: (ROLLING * idle).max(LEAST),
            damping: (resists / SLOWS_S).max(LEAST),
        }
    }

    /// Returns the largest load that is left beside what pulls at each position.
    fn left(&self, pull: impl Fn(f64) -> f64) -> f64 {
        self.alone.iter().chain(&self.posed).map(|(at, load)| (load + pull(*at)).abs()).fold(0.0, f64::max)
    }

    /// Returns the friction that bears a load at any position.
    fn friction(&self, left: f64) -> f64 {
        (SAFETY * left).max(self.idle)
    }
}

/// Returns the spring that balances loads best: the line along them that leaves least of the largest, as steep as a spring can
/// be; the slope is that of least squares or that from end to end.
fn spring(loads: &[(f64, f64)]) -> Option<Spring> {
    let count = loads.len() as f64;
    let mean = |value: &dyn Fn(&(f64, f64)) -> f64| loads.iter().map(value).sum::<f64>() / count;
    let (at, load) = (mean(&|l| l.0), mean(&|l| l.1));
    let spread = mean(&|l| (l.0 - at).powi(2));
    let (first, last) = (*loads.first()?, *loads.last()?);
    if spread <= 0.0 {
        return None;
    }
    let squares = mean(&|l| (l.0 - at) * (l.1 - load)) / spread;
    let ends = (last.1 - first.1) / (last.0 - first.0);
    let line = |slope: f64| {
        let stiffness = slope.max(load.abs() / (FLAT * (last.0 - first.0)));
        let left = loads.iter().map(|(at, load)| load - stiffness * at);
        let (low, high) = left.fold((f64::MAX, f64::MIN), |b, v| (b.0.min(v), b.1.max(v)));
        (stiffness > 0.0).then(|| (high - low, Spring { stiffness, reference: -(low + high) / 2.0 / stiffness }))
    };
    let lines = [squares, ends].into_iter().filter_map(line);
    lines.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, spring)| spring)
}

/// Positions of joints beside the one looked at: those above it from the root, then those of each moved body.
#[derive(Default)]
struct Pose<'a> {
    above: Vec<(&'a Joint, f64)>,
    below: Vec<(&'a Joint, f64)>,
}

/// Returns poses in which the joints above and below one are at their ends and at zero, in all ways for those nearest to it.
///
/// Of those above only what turns what hangs on it counts.
fn poses<'a>(model: &'a Model3d, joint: &Joint) -> Vec<Pose<'a>> {
    let mut above: Vec<&Joint> = Vec::new();
    let mut at = joint.parent;
    while let Some(next) = model.joints.iter().find(|j| j.child == at).filter(|_| above.len() < RELATED) {
        above.push(next);
        at = next.parent;
    }
    above.retain(|j| j.kind == JointKind::Revolute && j.axis[2].abs() < UPRIGHT);
    let reach = bodies_moved(model, joint);
    let mut below: Vec<&Joint> =
        model.joints.iter().filter(|j| j.limits.is_some() && reach.contains(&j.parent)).collect();
    below.truncate(RELATED - above.len());
    let mut poses = vec![Pose::default()];
    for (own, is_above) in above.into_iter().map(|j| (j, true)).chain(below.into_iter().map(|j| (j, false))) {
        let [low, high] = own.limits.unwrap_or(ALL_ROUND);
        let with = |pose: Pose<'a>| {
            [low, 0.0_f64.clamp(low, high), high].map(|position| {
                let mut longer = Pose { above: pose.above.clone(), below: pose.below.clone() };
                if is_above {
                    longer.above.push((own, position))
                } else {
                    longer.below.push((own, position))
                }
                longer
            })
        };
        poses = poses.into_iter().flat_map(with).collect();
    }
    poses
}

/// Returns the moments, or forces, of gravity about a joint over its range, in a pose of the others: each with the position,
/// N m or N.
fn loads(moved: &[(Inertia, Vec<usize>)], joint: &Joint, pose: &Pose<'_>) -> Vec<(f64, f64)> {
    let [low, high] = joint.limits.unwrap_or(ALL_ROUND);
    let at = |step: usize| low + (high - low) * step as f64 / (POSITIONS - 1) as f64;
    // What turns the joint turns gravity the other way as the joint sees it.
    let down = pose.above.iter().rev().fold([0.0, 0.0, -1.0], |v, (j, position)| turned(v, j.axis, -position));
    let placed: Vec<(f64, Vec3)> = moved
        .iter()
        .map(|(body, held_by)| {
            let mine = pose.below.iter().rev().filter(|(j, _)| held_by.contains(&j.child));
            (body.mass_kg, mine.fold(body.center_m, |p, (j, position)| moved_by(j, *position, p)))
        })
        .collect();
    let load = |position: f64| -> f64 {
        let one = |(mass, center): &(f64, Vec3)| {
            let weight = scale(down, GRAVITY * mass);
            match joint.kind {
                JointKind::Prismatic => dot(joint.axis, weight),
                JointKind::Revolute | JointKind::Continuous => {
                    let way = turned(sub(*center, joint.origin), joint.axis, position);
                    dot(joint.axis, cross(way, weight))
                }
            }
        };
        placed.iter().map(one).sum()
    };
    (0..POSITIONS).map(at).map(|position| (position, load(position))).collect()
}

/// Returns where a joint at a position takes a point.
pub(crate) fn moved_by(joint: &Joint, position: f64, p: Vec3) -> Vec3 {
    match joint.kind {
        JointKind::Prismatic => add(p, scale(joint.axis, position)),
        JointKind::Revolute | JointKind::Continuous => {
            add(joint.origin, turned(sub(p, joint.origin), joint.axis, position))
        }
    }
}

/// Returns the indices of the bodies that a joint moves: its own, and those that other joints hold to it.
pub(crate) fn bodies_moved(model: &Model3d, joint: &Joint) -> Vec<usize> {
    let mut bodies = vec![joint.child];
    let mut next = 0;
    while let Some(&body) = bodies.get(next) {
        for below in model.joints.iter().filter(|j| j.parent == body).map(|j| j.child) {
            if !bodies.contains(&below) {
                bodies.push(below);
            }
        }
        next += 1;
    }
    bodies
}

/// Returns the bodies that a joint moves, each with the bodies from it up to the joint's own.
fn moved(model: &Model3d, joint: &Joint, bodies: &[Inertia]) -> Vec<(Inertia, Vec<usize>)> {
    let up = |body: usize| {
        let mut chain = vec![body];
        while let Some(&last) = chain.last().filter(|b| **b != joint.child && chain.len() <= model.bodies.len()) {
            match model.joints.iter().find(|j| j.child == last) {
                Some(held) => chain.push(held.parent),
                None => break,
            }
        }
        chain
    };
    bodies_moved(model, joint).into_iter().filter_map(|b| bodies.get(b).map(|body| (*body, up(b)))).collect()
}

/// Returns the inertia of a body about the axis of a joint, kg m^2.
fn about_axis(body: &Inertia, joint: &Joint) -> f64 {
    let a = joint.axis;
    let own: f64 = (0..9).map(|k| a[k / 3] * body.tensor[k / 3][k % 3] * a[k % 3]).sum();
    let way = sub(body.center_m, joint.origin);
    let off = sub(way, scale(a, dot(way, a)));
    own + body.mass_kg * dot(off, off)
}

/// Turns a vector about a unit axis by an angle, rad.
pub(crate) fn turned(v: Vec3, axis: Vec3, angle: f64) -> Vec3 {
    let (sin, cos) = angle.sin_cos();
    let (across, along) = (cross(axis, v), scale(axis, dot(axis, v) * (1.0 - cos)));
    std::array::from_fn(|i| v[i] * cos + across[i] * sin + along[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model3d::{Body, Collision};

    fn flap(kind: JointKind, axis: Vec3, limits: Option<[f64; 2]>) -> (Model3d, Joint) {
        let body = |min: Vec3, max: Vec3, mass_kg| Body {
            collisions: vec![Collision::Box { min, max }],
            mass_kg,
            ..Body::default()
        };
        let joint = Joint { name: "j".into(), kind, parent: 0, child: 1, origin: [0.0; 3], axis, limits };
        let bodies = vec![body([-1.0; 3], [0.0; 3], 9.0), body([0.0, -0.3, 0.0], [0.0, 0.3, 0.5], 4.0)];
        (Model3d { bodies, joints: vec![joint.clone()], ..Model3d::default() }, joint)
    }

    /// Returns the largest load that spring and friction do not hold, over the range: below zero when all is held.
    fn not_held(model: &Model3d, joint: &Joint) -> f64 {
        let Dynamics { friction, spring, .. } = of(model, joint);
        let pull = |at: f64| spring.map_or(0.0, |s| s.stiffness * (s.reference - at));
        let all: Vec<(f64, f64)> = poses(model, joint)
            .iter()
            .flat_map(|pose| loads(&moved(model, joint, &plain(model)), joint, pose))
            .collect();
        all.iter().map(|(at, load)| (load + pull(*at)).abs() - friction).fold(f64::MIN, f64::max)
    }

    /// Returns the bodies of a model as they are.
    fn plain(model: &Model3d) -> Vec<Inertia> {
        model.bodies.iter().map(inertia).collect()
    }

    #[test]
    fn a_flap_with_its_counterweight_weighs_nothing_and_a_lift_is_pushed() {
        let (model, joint) = flap(JointKind::Revolute, [0.0, 1.0, 0.0], Some([-0.2, 1.6]));
        let found = borne(&model);
        let weight = Weight::of(&model, &joint, &found.bodies);
        assert!(weight.left(|_| 0.0) < 1e-9 && found.joints[0].push == 0.0, "{found:?}");
        assert!((found.joints[0].friction - weight.idle).abs() < 1e-12 && found.bodies[1].mass_kg == 4.0);
        let about = |bodies: &[Inertia]| about_axis(&bodies[1], &joint);
        assert!((about(&found.bodies) - about(&plain(&model))).abs() < 1e-9, "it swings as before");
        let (model, joint) = flap(JointKind::Prismatic, [0.0, 0.0, 1.0], Some([0.0, 0.3]));
        let found = borne(&model);
        assert!((found.joints[0].push - 4.0 * GRAVITY).abs() < 1e-9 && found.joints[0].friction < 4.0, "{found:?}");
        assert_eq!(found.bodies, plain(&model), "what slides stays as it is: {}", joint.name);
        let (model, _) = flap(JointKind::Revolute, [0.0, 0.0, 1.0], Some([0.0, 1.6]));
        assert_eq!(borne(&model).bodies, plain(&model), "a door about an upright axis bears nothing");
    }

    #[test]
    fn a_lamp_of_two_arms_holds_however_both_stand() {
        // The second arm hangs on the first: what the first one does tilts the second.
        let (mut model, first) = flap(JointKind::Revolute, [0.0, 1.0, 0.0], Some([-0.7, 0.7]));
        let second = Joint {
            name: "k".into(),
            parent: 1,
            child: 2,
            origin: [0.0, 0.0, 0.5],
            limits: Some([-1.0, -0.5]),
            ..first.clone()
        };
        let tip = Collision::Box { min: [0.0, -0.1, 0.5], max: [0.3, 0.1, 0.6] };
        model.bodies.push(Body { collisions: vec![tip], mass_kg: 1.0, ..Body::default() });
        model.joints.push(second.clone());
        for joint in [&first, &second] {
            assert!(not_held(&model, joint) < 0.0, "{} {:?}", joint.name, of(&model, joint));
        }
        let upright = poses(&model, &second);
        assert_eq!((upright.len(), poses(&model, &first).len()), (3, 3));
        let straight = |pose: &&Pose<'_>| pose.above.iter().all(|(_, at)| *at == 0.0);
        let alone = loads(
            &moved(&model, &second, &plain(&model)),
            &second,
            upright.iter().find(straight).expect("one is at zero"),
        );
        let most = |loads: &[(f64, f64)]| loads.iter().map(|l| l.1).fold(f64::MIN, f64::max);
        let tilted = upright
            .iter()
            .map(|pose| most(&loads(&moved(&model, &second, &plain(&model)), &second, pose)))
            .fold(f64::MIN, f64::max);
        assert!(tilted > most(&alone) * 1.05, "tilted it weighs more: {tilted}, {}", most(&alone));
    }

    #[test]
    fn what_reaches_the_floor_bears_a_model_and_lids_do_not() {
        let (mut model, lid) = flap(JointKind::Revolute, [0.0, 1.0, 0.0], Some([0.0, 1.6]));
        assert_eq!(bearing(&model), BTreeSet::from([0]));
        let wheel = Body { collisions: vec![Collision::Sphere { center: [0.0; 3], radius: 0.1 }], ..Body::default() };
        model.bodies.extend([wheel.clone(), wheel]);
        model.joints.push(Joint { child: 2, kind: JointKind::Continuous, limits: None, ..lid.clone() });
        model.joints.push(Joint { child: 3, ..lid });
        assert_eq!(bearing(&model), BTreeSet::from([0, 2]), "a wheel bears it wherever it is");
        model.bodies[3].collisions = vec![Collision::Box { min: [0.0, 0.0, -1.0], max: [0.1; 3] }];
        assert_eq!(bearing(&model), BTreeSet::from([0, 2, 3]), "and a leg that folds");
    }

    #[test]
    fn the_shorter_the_way_the_more_inertia_a_joint_is_given() {
        let [button, lid, drawer] = [0.003, 1.4, 0.4].map(|range| armature(Some([0.0, range])));
        assert!(button > drawer && drawer > lid && lid == armature(None), "{button} {drawer} {lid}");
    }

    #[test]
    fn spring_and_friction_bear_the_weight_anywhere_in_the_range() {
        // A door hinged below, upright at zero: it weighs most on its hinge where it lies, 0.25 m from it.
        let (model, joint) = flap(JointKind::Revolute, [0.0, 1.0, 0.0], Some([0.0, 1.6]));
        let open = 4.0 * GRAVITY * 0.25;
        let found = of(&model, &joint);
        assert!(not_held(&model, &joint) < 0.0 && found.friction < 0.3 * open, "{found:?}, {open} N m");
        assert!((found.damping - (4.0 * 0.25 / 12.0 + 4.0 * 0.0625) / SLOWS_S).abs() < 1e-9, "{found:?}");
        let (model, joint) = flap(JointKind::Prismatic, [0.0, 0.0, 1.0], Some([0.0, 0.3]));
        assert!(not_held(&model, &joint) < 0.0 && of(&model, &joint).friction < 4.0, "{:?}", of(&model, &joint));
        let (model, joint) = flap(JointKind::Continuous, [0.0, 1.0, 0.0], None);
        assert!(not_held(&model, &joint) < 0.0 && of(&model, &joint).spring.is_none());
        let (model, joint) = flap(JointKind::Revolute, [0.0, 0.0, 1.0], Some([0.0, 1.6]));
        let found = of(&model, &joint);
        assert!(found.friction < 0.1 * open && found.spring.is_none(), "a door about an upright axis bears nothing");
    }
}
