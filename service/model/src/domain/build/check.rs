//! What can be wrong with a build, whatever the size it is made at.

use std::collections::BTreeSet;

use super::{BASE, Build, BuildJoint, BuildJointKind, Formula, Part, Repeat, Solid};
use crate::document::Problem;
use crate::expression;

/// Names that every formula may use.
const SIZE: [&str; 3] = ["w", "d", "h"];
/// Names that formulas of copies may use.
const COPY: [&str; 2] = ["i", "n"];
/// Most parts and joints of a build, and most points of a list: more is a mistake.
const MOST: usize = 400;

impl Build {
    /// Adds every problem of the build; `path` is where it stands.
    pub fn check(&self, path: &str, problems: &mut Vec<Problem>) {
        let mut checker = Checker { build: self, problems };
        checker.names(path);
        checker.measures(&format!("{path}/let"));
        for (i, part) in self.parts.iter().enumerate() {
            checker.part(&format!("{path}/parts/{i}"), part);
        }
        for (i, joint) in self.joints.iter().enumerate() {
            checker.joint(&format!("{path}/joints/{i}"), joint, i);
        }
        if let Some(mass) = &self.mass_kg {
            checker.formula(&format!("{path}/mass_kg"), mass, false);
        }
    }
}

struct Checker<'a> {
    build: &'a Build,
    problems: &'a mut Vec<Problem>,
}

impl Checker<'_> {
    fn add(&mut self, path: &str, message: impl Into<String>) {
        self.problems.push(Problem::new(path, message));
    }

    fn names(&mut self, path: &str) {
        let build = self.build;
        for (field, name) in [("id", &build.id), ("kind", &build.kind)] {
            if !is_name(name) {
                self.add(&format!("{path}/{field}"), format!("`{name}` is no snake-case word"));
            }
        }
        for (field, count) in [("parts", build.parts.len()), ("joints", build.joints.len())] {
            if count > MOST {
                self.add(&format!("{path}/{field}"), format!("has {count} entries, the limit is {MOST}; use `repeat`"));
            }
        }
        if build.parts.is_empty() {
            self.add(&format!("{path}/parts"), "is empty; a build needs at least one part");
        }
        for name in build.measures.keys().chain(build.choices.keys()) {
            if !is_name(name) || SIZE.contains(&name.as_str()) || COPY.contains(&name.as_str()) {
                self.add(&format!("{path}/let/{name}"), format!("`{name}` cannot be a name: w d h i n are taken"));
            }
        }
        for (name, values) in &build.choices {
            if values.is_empty() || values.iter().any(|v| !v.is_finite()) {
                self.add(&format!("{path}/choices/{name}"), "needs at least one figure");
            }
            if build.measures.contains_key(name) {
                self.add(&format!("{path}/choices/{name}"), format!("`{name}` is a measure too"));
            }
        }
    }

    /// Checks that every measure is a formula of known names and that none needs itself.
    fn measures(&mut self, path: &str) {
        let build = self.build;
        let mut known: BTreeSet<&str> = SIZE.into_iter().chain(build.choices.keys().map(String::as_str)).collect();
        loop {
            let ready: Vec<&str> = build
                .measures
                .iter()
                .filter(|(name, formula)| !known.contains(name.as_str()) && fails(formula, &known).is_none())
                .map(|(name, _)| name.as_str())
                .collect();
            if ready.is_empty() {
                break;
            }
            known.extend(ready);
        }
        for (name, formula) in build.measures.iter().filter(|(name, _)| !known.contains(name.as_str())) {
            let all: BTreeSet<&str> = known.iter().copied().chain(build.measures.keys().map(String::as_str)).collect();
            let reason = fails(formula, &all).unwrap_or_else(|| format!("`{formula}` needs itself"));
            self.add(&format!("{path}/{name}"), reason);
        }
    }

    fn formula(&mut self, path: &str, formula: &Formula, copies: bool) {
        let build = self.build;
        let known: BTreeSet<&str> = SIZE
            .into_iter()
            .chain(COPY.into_iter().filter(|_| copies))
            .chain(build.measures.keys().chain(build.choices.keys()).map(String::as_str))
            .collect();
        if let Some(reason) = fails(formula, &known) {
            self.add(path, reason);
        }
    }

    fn formulas<'f>(&mut self, path: &str, formulas: impl IntoIterator<Item = &'f Formula>) {
        for (i, formula) in formulas.into_iter().enumerate() {
            self.formula(&format!("{path}/{i}"), formula, true);
        }
    }

    fn part(&mut self, path: &str, part: &Part) {
        let single = [
            ("when", &part.when),
            ("bevel", &part.bevel),
            ("round", &part.round),
            ("top", &part.top),
            ("radius", &part.radius),
            ("wall", &part.wall),
            ("bottom", &part.bottom),
            ("count", &part.count),
        ];
        for (field, formula) in single {
            if let Some(formula) = formula {
                self.formula(&format!("{path}/{field}"), formula, true);
            }
        }
        let ranges = [("x", &part.x), ("y", &part.y), ("z", &part.z), ("at", &part.at), ("stretch", &part.stretch)];
        for (field, range) in ranges {
            self.formulas(&format!("{path}/{field}"), range.iter().flatten());
        }
        for (j, point) in part.path.iter().enumerate() {
            self.formulas(&format!("{path}/path/{j}"), point);
        }
        for (field, points) in [("profile", &part.profile), ("outline", &part.outline)] {
            for (j, point) in points.iter().enumerate() {
                self.formulas(&format!("{path}/{field}/{j}"), point);
            }
        }
        if let Some(tilt) = &part.tilt {
            self.formula(&format!("{path}/tilt/deg"), &tilt.deg, true);
            self.formulas(&format!("{path}/tilt/at"), &tilt.at);
        }
        self.repeat(path, part.repeat.as_ref());
        self.fields(path, part);
        if part.color.as_deref().is_some_and(|c| !is_color(c)) {
            self.add(&format!("{path}/color"), "is not of the form #rrggbb");
        }
        if part.body != BASE && !self.build.joints.iter().any(|j| j.body == part.body) {
            self.add(&format!("{path}/body"), format!("no joint moves the body `{}`", part.body));
        }
    }

    /// Checks that the fields its solid needs are there.
    fn fields(&mut self, path: &str, part: &Part) {
        let axis = part.axis.unwrap_or_default().index();
        let needed: &[(&str, bool)] = match part.solid {
            Solid::Tube => &[("path", part.path.len() >= 2), ("radius", part.radius.is_some())],
            Solid::Lathe => &[("profile", part.profile.len() >= 2), ("at", part.at.is_some())],
            Solid::Prism => &[
                ("outline", part.outline.len() >= 3),
                (["x", "y", "z"][axis], [part.x.is_some(), part.y.is_some(), part.z.is_some()][axis]),
            ],
            _ => &[
                ("x", part.x.is_some()),
                ("y", part.y.is_some()),
                ("z", part.z.is_some()),
                ("radius", part.solid != Solid::Torus || part.radius.is_some()),
                ("wall", part.solid != Solid::Shell || part.wall.is_some()),
                ("count", part.solid != Solid::Leaves || part.count.is_some()),
                ("top", part.solid != Solid::Cone || part.top.is_some()),
            ],
        };
        for (field, _) in needed.iter().filter(|(_, given)| !given) {
            self.add(
                &format!("{path}/{field}"),
                format!("is missing or too short for the solid {:?}", part.solid).to_lowercase(),
            );
        }
        for (field, count) in
            [("path", part.path.len()), ("profile", part.profile.len()), ("outline", part.outline.len())]
        {
            if count > MOST {
                self.add(&format!("{path}/{field}"), format!("has {count} points, the limit is {MOST}"));
            }
        }
    }

    fn repeat(&mut self, path: &str, repeat: Option<&Repeat>) {
        let Some(repeat) = repeat else { return };
        self.formula(&format!("{path}/repeat/count"), &repeat.count, false);
        self.formulas(&format!("{path}/repeat/step"), repeat.step.iter().flatten());
        self.formulas(&format!("{path}/repeat/around"), repeat.around.iter().flatten());
        for (field, formula) in [("start_deg", &repeat.start_deg), ("span_deg", &repeat.span_deg)] {
            if let Some(formula) = formula {
                self.formula(&format!("{path}/repeat/{field}"), formula, false);
            }
        }
    }

    fn joint(&mut self, path: &str, joint: &BuildJoint, index: usize) {
        self.formulas(&format!("{path}/at"), &joint.at);
        self.formulas(&format!("{path}/limits"), joint.limits.iter().flatten());
        if let Some(when) = &joint.when {
            self.formula(&format!("{path}/when"), when, true);
        }
        self.repeat(path, joint.repeat.as_ref());
        if !is_name(&joint.body) || joint.body == BASE {
            self.add(&format!("{path}/body"), format!("`{}` cannot be a moving body", joint.body));
        }
        if self.build.joints[..index].iter().any(|j| j.body == joint.body) {
            self.add(&format!("{path}/body"), format!("`{}` is moved by an earlier joint; use `repeat`", joint.body));
        }
        if !self.build.parts.iter().any(|p| p.body == joint.body) {
            self.add(&format!("{path}/body"), format!("no part belongs to the body `{}`", joint.body));
        }
        // Parents come first, so that no chain of bodies closes on itself.
        if joint.parent != BASE && !self.build.joints[..index].iter().any(|j| j.body == joint.parent) {
            self.add(
                &format!("{path}/parent"),
                format!("`{}` is neither {BASE} nor moved by an earlier joint", joint.parent),
            );
        }
        let length = joint.axis.iter().map(|v| v * v).sum::<f64>();
        if !length.is_finite() || length < 1e-6 {
            self.add(&format!("{path}/axis"), "has no direction");
        }
        if (joint.kind == BuildJointKind::Continuous) == joint.limits.is_some() {
            self.add(&format!("{path}/limits"), "are for revolute and prismatic joints, and needed there");
        }
    }
}

/// Returns what is wrong with a formula over these names.
fn fails(formula: &Formula, known: &BTreeSet<&str>) -> Option<String> {
    match formula {
        Formula::Number(value) => (!value.is_finite()).then(|| format!("{value} is no figure")),
        Formula::Text(text) => expression::check(text, &|name| known.contains(name)).err(),
    }
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_lowercase())
        && text.len() <= 60
        && text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

fn is_color(text: &str) -> bool {
    text.strip_prefix('#').is_some_and(|hex| hex.len() == 6 && hex.chars().all(|c| c.is_ascii_hexdigit()))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn problems(build: Value) -> Vec<String> {
        let build: Build = serde_json::from_value(build).unwrap();
        let mut problems = Vec::new();
        build.check("/builds/0", &mut problems);
        problems.iter().map(ToString::to_string).collect()
    }

    fn good() -> Value {
        json!({
            "id": "crate", "kind": "container", "let": {"t": "min(0.02, s)", "s": "w/10"}, "choices": {"lid": [1, 0]},
            "parts": [
                {"solid": "shell", "x": [0, "w"], "y": [0, "d"], "z": [0, "h - t"], "wall": "t"},
                {"solid": "box", "x": [0, "w"], "y": [0, "d"], "z": ["h - t", "h"], "body": "lid", "when": "lid"}
            ],
            "joints": [{"body": "lid", "kind": "revolute", "at": [0, "d", "h"], "axis": [1, 0, 0], "limits": [0, 90]}]
        })
    }

    #[test]
    fn a_good_build_has_no_problem() {
        assert_eq!(problems(good()), Vec::<String>::new());
    }

    #[test]
    fn every_problem_is_named_with_its_place() {
        let cases: &[(&str, Value, &str)] = &[
            ("/id", json!("Crate"), "/builds/0/id: `Crate`"),
            ("/let/t", json!("t + 1"), "/builds/0/let/t: `t + 1` needs itself"),
            ("/let/t", json!("q + 1"), "/builds/0/let/t: `q + 1` names `q`"),
            ("/parts/0/x/1", json!("w +"), "/builds/0/parts/0/x/1: `w +` is no formula"),
            ("/parts/0/wall", Value::Null, "/builds/0/parts/0/wall: is missing"),
            ("/parts/0/color", json!("red"), "/builds/0/parts/0/color"),
            ("/parts/0/body", json!("door"), "/builds/0/parts/0/body: no joint moves"),
            ("/joints/0/axis", json!([0, 0, 0]), "/builds/0/joints/0/axis"),
            ("/joints/0/parent", json!("lid"), "/builds/0/joints/0/parent"),
            ("/joints/0/limits", Value::Null, "/builds/0/joints/0/limits"),
            ("/joints/0/body", json!("base"), "/builds/0/joints/0/body"),
            ("/choices/lid", json!([]), "/builds/0/choices/lid"),
        ];
        for (place, value, expected) in cases {
            let mut build = good();
            let (parent, key) = place.rsplit_once('/').unwrap();
            let parent = build.pointer_mut(parent).unwrap();
            match parent {
                Value::Array(list) => list[key.parse::<usize>().unwrap()] = value.clone(),
                parent => parent[key] = value.clone(),
            }
            let found = problems(build);
            assert!(found.iter().any(|p| p.starts_with(expected)), "{place}: {found:?}");
        }
    }
}
