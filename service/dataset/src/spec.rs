//! The spec of a data set: a TOML file that says which worlds are in it. `docs/datasets.md` explains every key.
//!
//! A spec is data that people write: everything wrong with it is reported with its place before anything is made.

use std::collections::BTreeMap;

use d3dgen_export::exporters;
use d3dgen_model::document::{Document, Problem};
use d3dgen_model::robot_body::RobotBody;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::physics;

/// Most worlds a data set has: more is several data sets.
const MAX_TASKS: u64 = 10_000_000;
/// Name of the split that unseen assets are kept for, unless another is named.
const TEST: &str = "test";

/// Which worlds a data set has, and what is written of each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// Name of the data set.
    #[schemars(regex(pattern = "^[a-z0-9][a-z0-9_-]*$"), length(max = 80))]
    pub name: String,
    /// Title of the card; the name when absent.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// What it is for, in Markdown, for the card.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// License of the worlds, as an SPDX id in lower case.
    #[serde(default = "default_license")]
    pub license: String,
    /// How many seeds each prompt has.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub seeds: u64,
    /// The first of them.
    #[serde(default)]
    #[schemars(range(max = 4_294_967_295_u64))]
    pub first_seed: u64,
    /// What to build.
    #[schemars(length(min = 1))]
    pub prompts: Vec<PromptSpec>,
    /// Documents wanted of each world; the whole world and its report when absent.
    #[serde(default = "default_stages")]
    #[schemars(length(min = 1))]
    pub stages: Vec<StageName>,
    /// Files in other programs' formats: names of exporters (`plan`, `nav2`), or one of their files (`plan.svg`).
    #[serde(default)]
    pub formats: Vec<String>,
    /// Measures of `d3dgen eval` that the index has; `all` for every one. They take time: none when absent.
    #[serde(default)]
    pub measures: Vec<String>,
    /// How the worlds are dealt to training and tests.
    #[serde(default)]
    pub splits: Splits,
    /// What a world must hold to be in the data set.
    #[serde(default)]
    pub filters: Vec<Filter>,
    /// Further worlds of the same plan.
    #[serde(default)]
    pub variants: Variants,
    /// Build what contradicts itself too; otherwise such prompts are refused, and listed as such.
    #[serde(default)]
    pub allow_conflicts: bool,
    /// How many worlds of a split a shard is for.
    #[serde(default = "default_per_shard")]
    #[schemars(range(min = 1, max = 100_000))]
    pub worlds_per_shard: u64,
    /// How many worlds the gallery shows, evenly over all.
    #[serde(default = "default_gallery")]
    #[schemars(range(max = 2_000))]
    pub gallery: u32,
}

/// One or several values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Values<T> {
    /// A list: each makes a prompt of its own. Looked for first: a list of numbers would pass for the measures of a robot.
    Many(Vec<T>),
    /// A single one.
    One(T),
}

impl<T> Values<T> {
    /// Returns the values as a list.
    pub fn all(&self) -> &[T] {
        match self {
            Self::One(value) => std::slice::from_ref(value),
            Self::Many(values) => values,
        }
    }
}

/// A prompt or a template of prompts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PromptSpec {
    /// The sentence; `{name}` stands for the values of the key `name`, `{{` for a brace.
    pub text: Values<String>,
    /// Values of the slots; of a key that the text has no slot for, what the request says beside the sentence.
    #[serde(flatten)]
    pub slots: BTreeMap<String, Values<Scalar>>,
}

/// A value of a slot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Scalar {
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// Words.
    Text(String),
    /// The body of a robot.
    Robot(RobotBody),
}

impl Scalar {
    /// Returns it as it stands in a sentence; none for a robot's body, which is no words.
    pub fn in_words(&self) -> Option<String> {
        match self {
            Self::Whole(n) => Some(n.to_string()),
            Self::Number(x) => Some(x.to_string()),
            Self::Text(text) => Some(text.clone()),
            Self::Robot(_) => None,
        }
    }
}

/// A stage whose document is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StageName {
    /// Rooms and relations.
    SceneGraph,
    /// The plan.
    Floorplan,
    /// The furniture.
    Placement,
    /// Robots and people.
    Scenario,
    /// The whole world, checked, with its report.
    World,
}

/// How the worlds are dealt to training and tests: by prompt, so that no sentence is in two splits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Splits {
    /// `prompt`; with `asset` beside it, one split alone has some of the assets.
    #[serde(default = "by_prompt")]
    pub by: Values<String>,
    /// Share of the assets that come in several sizes which only `held_out_for` has; counts with `asset` in `by`.
    #[serde(default = "default_held_out")]
    pub held_out_assets: f64,
    /// Split that unseen assets are kept for.
    #[serde(default = "default_held_out_for")]
    pub held_out_for: String,
    /// Name and share of each split.
    #[serde(flatten)]
    pub shares: BTreeMap<String, f64>,
}

impl Default for Splits {
    fn default() -> Self {
        Self {
            by: by_prompt(),
            held_out_assets: default_held_out(),
            held_out_for: default_held_out_for(),
            shares: BTreeMap::from([("train".to_owned(), 1.0)]),
        }
    }
}

impl Splits {
    /// Returns true when some assets are kept for one split.
    pub fn by_asset(&self) -> bool {
        self.by.all().iter().any(|b| b == "asset")
    }
}

/// What a world must hold: a measure in a range, or a rule kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Filter {
    /// A measure: a figure of the report, or one of `d3dgen eval`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measure: Option<String>,
    /// Least value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Most value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// A constraint, by id or name, that must not be violated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rule: Option<String>,
}

/// Further worlds of the same plan: plans once, furnished ten ways, five scenarios each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Variants {
    /// How many ways each plan is furnished.
    #[schemars(range(min = 1, max = 1_000))]
    pub placement: u32,
    /// How many scenarios each furnished plan has.
    #[schemars(range(min = 1, max = 1_000))]
    pub scenario: u32,
}

impl Default for Variants {
    fn default() -> Self {
        Self { placement: 1, scenario: 1 }
    }
}

fn default_license() -> String {
    "cc-by-4.0".into()
}
fn default_stages() -> Vec<StageName> {
    vec![StageName::World]
}
fn default_per_shard() -> u64 {
    1000
}
fn default_gallery() -> u32 {
    120
}
fn by_prompt() -> Values<String> {
    Values::One("prompt".into())
}
fn default_held_out() -> f64 {
    0.2
}
fn default_held_out_for() -> String {
    TEST.into()
}

impl Spec {
    /// Reads a spec; `file` is how it is called in errors.
    ///
    /// # Errors
    /// `Spec` with the line that is no TOML, or with every problem and its place.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, Error> {
        let refused = |reason: String| Error::Spec { file: file.to_owned(), reason };
        let value: serde_json::Value = toml::from_str(text).map_err(|e| refused(e.to_string().trim().to_owned()))?;
        let spec = Self::from_value(value).map_err(|e| refused(e.to_string()))?;
        crate::tasks::Tasks::of(&spec).map_err(refused)?;
        Ok(spec)
    }

    /// Returns the last stage that is wanted: those after it are not run.
    pub fn last_stage(&self) -> StageName {
        self.stages.iter().copied().max().unwrap_or(StageName::World)
    }

    /// Returns the names of the measures of `d3dgen eval` that are needed, in its order.
    pub fn evaluated(&self) -> Vec<&'static str> {
        let asked = |name: &str| self.measures.iter().any(|m| m == "all") || self.wants(name);
        d3dgen_eval::figures::FIGURES.iter().map(|f| f.name).filter(|name| asked(name)).collect()
    }

    /// Returns the names of the measures that a physics engine takes and that are needed: only those that are named.
    pub fn stepped(&self) -> Vec<&'static str> {
        physics::MEASURES.iter().copied().filter(|name| self.wants(name)).collect()
    }

    /// Returns true for a measure that becomes a column or that a filter goes by.
    fn wants(&self, measure: &str) -> bool {
        let filtered = self.filters.iter().any(|f| f.measure.as_deref() == Some(measure));
        filtered || self.measures.iter().any(|m| m == measure)
    }
}

impl Document for Spec {
    const KIND: &'static str = "dataset_spec";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        check_prompts(self, &mut problems);
        check_splits(&self.splits, &mut problems);
        check_names(self, &mut problems);
        for (i, filter) in self.filters.iter().enumerate() {
            let place = format!("/filters/{i}");
            match (&filter.measure, &filter.rule) {
                (Some(_), None) if filter.min.is_none() && filter.max.is_none() => {
                    problems.push(Problem::new(place, "has neither min nor max: it keeps every world"));
                }
                (Some(_), None) | (None, Some(_)) => {}
                _ => problems.push(Problem::new(place, "names either a measure with min or max, or a rule")),
            }
        }
        let v = self.variants;
        if v != Variants::default() && self.last_stage() != StageName::World {
            problems.push(Problem::new("/variants", "are worlds: they need \"world\" in stages"));
        }
        problems
    }
}

fn check_prompts(spec: &Spec, problems: &mut Vec<Problem>) {
    let mut tasks = spec.seeds.saturating_mul(u64::from(spec.variants.placement) * u64::from(spec.variants.scenario));
    let mut prompts = 0_u64;
    for (i, prompt) in spec.prompts.iter().enumerate() {
        if prompt.text.all().is_empty() {
            problems.push(Problem::new(format!("/prompts/{i}/text"), "is an empty list"));
        }
        for (name, values) in &prompt.slots {
            if values.all().is_empty() {
                problems
                    .push(Problem::new(format!("/prompts/{i}/{name}"), "is an empty list: no prompt would be left"));
            }
        }
        let lengths = prompt.slots.values().map(|v| v.all().len() as u64);
        prompts = prompts.saturating_add(lengths.fold(prompt.text.all().len() as u64, u64::saturating_mul));
    }
    tasks = tasks.saturating_mul(prompts);
    if tasks > MAX_TASKS {
        let message = format!("come to {tasks} worlds with the seeds, more than {MAX_TASKS}; make several data sets");
        problems.push(Problem::new("/prompts", message));
    }
}

fn check_splits(splits: &Splits, problems: &mut Vec<Problem>) {
    for by in splits.by.all().iter().filter(|b| *b != "prompt" && *b != "asset") {
        let why = if by == "seed" { ": worlds of one prompt are alike, so a split by seed leaks" } else { "" };
        problems.push(Problem::new("/splits/by", format!("`{by}` is not known{why}; known are prompt and asset")));
    }
    if !splits.by.all().iter().any(|b| b == "prompt") {
        problems.push(Problem::new("/splits/by", "needs \"prompt\": the same sentence must not be in two splits"));
    }
    let sum: f64 = splits.shares.values().sum();
    for (name, share) in &splits.shares {
        let place = || format!("/splits/{name}");
        if !name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_') || name == "models" {
            problems.push(Problem::new(place(), "a split's name has only a-z, 0-9 and _, and is not `models`"));
        }
        if !(*share > 0.0 && *share <= 1.0) {
            problems.push(Problem::new(place(), format!("is {share}; a share is above 0 and at most 1")));
        }
    }
    if (sum - 1.0).abs() > 1e-6 {
        problems.push(Problem::new("/splits", format!("the shares add up to {sum}, not to 1")));
    }
    if splits.by_asset() {
        if !splits.shares.contains_key(&splits.held_out_for) {
            let message = format!("there is no split `{}` to keep unseen assets for", splits.held_out_for);
            problems.push(Problem::new("/splits/held_out_for", message));
        }
        if !(splits.held_out_assets > 0.0 && splits.held_out_assets < 1.0) {
            problems.push(Problem::new("/splits/held_out_assets", "is a share between 0 and 1"));
        }
    }
}

fn check_names(spec: &Spec, problems: &mut Vec<Problem>) {
    let known: Vec<&str> = exporters::all().iter().map(|e| e.name()).collect();
    for (i, format) in spec.formats.iter().enumerate() {
        let name = format.split('.').next().unwrap_or_default();
        if !known.contains(&name) {
            let message = format!("`{format}` is not known; there are {}", known.join(", "));
            problems.push(Problem::new(format!("/formats/{i}"), message));
        }
    }
    if !spec.formats.is_empty() && spec.last_stage() != StageName::World {
        problems.push(Problem::new("/formats", "are files of worlds: they need \"world\" in stages"));
    }
    if !physics::HERE && !spec.stepped().is_empty() {
        let message = format!("{} needs a program built with `--features physics`", spec.stepped().join(", "));
        problems.push(Problem::new("/measures", message));
    }
    let evaluated = d3dgen_eval::figures::FIGURES.iter().map(|f| f.name);
    let measures: Vec<&str> = evaluated.chain(physics::MEASURES.iter().copied()).collect();
    for (i, measure) in spec.measures.iter().enumerate() {
        if measure != "all" && !measures.contains(&measure.as_str()) {
            let message = format!("`{measure}` is not known; there are all, {}", measures.join(", "));
            problems.push(Problem::new(format!("/measures/{i}"), message));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The spec of the issue that asked for data sets, as it stands there.
    const WARDS: &str = r#"
name = "wards"
seeds = 20
[[prompts]]
text = "hospital ward with {rooms} rooms in {country}"
rooms = [6, 9]
country = ["Germany", "Japan"]
"#;

    fn refused(text: &str) -> String {
        Spec::from_toml(text, "spec.toml").unwrap_err().to_string()
    }

    #[test]
    fn the_smallest_spec_is_read() {
        let spec = Spec::from_toml(WARDS, "spec.toml").unwrap();
        assert_eq!((spec.seeds, spec.prompts.len(), spec.license.as_str()), (20, 1, "cc-by-4.0"));
        assert_eq!(spec.last_stage(), StageName::World);
    }

    #[test]
    fn problems_name_their_place() {
        let with = |line: &str| refused(&WARDS.replace("seeds = 20", line));
        let cases = [
            (with("seeds = 0"), "/seeds"),
            (with("seeds = 20\nformats = [\"plan\", \"obj\"]"), "/formats/1: `obj` is not known"),
            (with("seeds = 20\nmeasures = [\"beauty\"]"), "/measures/0: `beauty` is not known"),
            (with("seeds = 20\nstages = [\"world\", \"paint\"]"), "/stages/1"),
            (with("seeds = 20\nsplits = { train = 0.8, test = 0.1 }"), "/splits: the shares add up to 0.9"),
            (with("seeds = 20\nsplits = { by = \"seed\", train = 1.0 }"), "a split by seed leaks"),
            (with("seeds = 20\nfilters = [{ measure = \"objects\" }]"), "/filters/0: has neither min nor max"),
            (with("seeds = 20\nspeed = 3"), "speed"),
            (with("seeds = "), "line 3"),
            (refused(&WARDS.replace("[6, 9]", "[]")), "/prompts/0/rooms: is an empty list"),
            (refused(&WARDS.replace("{rooms}", "{room}")), "/prompts/0/text: `{room}` has no values"),
            (refused(&WARDS.replace("{country}", "{country")), "/prompts/0/text: `{country` is not closed"),
            (refused(&WARDS.replace("rooms = [6, 9]", "rooms = [6, 9]\ncolor = \"red\"")), "/prompts/0/color"),
            (with("seeds = 1000000\nvariants = { placement = 100 }"), "more than 10000000"),
        ];
        for (said, expected) in cases {
            assert!(said.contains(expected), "{expected:?} is not in: {said}");
        }
    }
}
