//! The tasks of a spec: one world each, in an order and under ids that depend on nothing but the spec.
//!
//! The order is seeds, then prompts, then variants: a data set with more seeds begins with the tasks of the one with fewer.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::style::{Clutter, Style};
use d3dgen_pipeline::scene_graph::Request;
use serde_json::json;

use crate::digest::sha256;
use crate::spec::{PromptSpec, Scalar, Spec, Splits};

/// Keys of a prompt that say something beside the sentence where it has no slot for them, with how each is set.
const FLAGS: &[(&str, SetFlag)] = &[
    ("area_m2", |request, value| number(value).map(|v| request.area_m2 = Some(v))),
    ("clutter", set_clutter),
    ("country", |request, value| words(value).map(|v| request.country = Some(v))),
    ("kind", |request, value| words(value).map(|v| request.domain = Some(v))),
    ("robot_radius_m", |request, value| number(value).map(|v| request.robot_radius_m = Some(v))),
    ("robots", set_robots),
    ("rooms", set_rooms),
    ("style", set_style),
];

type SetFlag = fn(&mut Request, &Scalar) -> Result<(), String>;

/// Id of a task: the first 8 bytes of the digest of what it asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TaskId(pub u64);

impl std::fmt::Display for TaskId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl TaskId {
    /// Reads an id as it is printed.
    pub fn parse(text: &str) -> Option<Self> {
        (text.len() == 16).then(|| u64::from_str_radix(text, 16).ok().map(Self)).flatten()
    }
}

/// A prompt with its slots filled.
#[derive(Debug, Clone, PartialEq)]
pub struct Prompt {
    /// What is asked for, without a seed.
    pub request: Request,
    /// The value of each slot and flag.
    pub slots: BTreeMap<String, String>,
    /// Split that its worlds are in.
    pub split: String,
}

/// One world to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct Task<'t> {
    /// Place in the order, from 0.
    pub number: u64,
    /// What tells it from every other.
    pub id: TaskId,
    /// The prompt.
    pub prompt: &'t Prompt,
    /// Seed of the plan.
    pub seed: u64,
    /// Which way of furnishing the plan, from 0.
    pub placement: u32,
    /// Which scenario of the furnished plan, from 0.
    pub scenario: u32,
}

/// All tasks of a spec.
#[derive(Debug, Clone)]
pub struct Tasks {
    prompts: Vec<Prompt>,
    seeds: u64,
    first_seed: u64,
    placements: u32,
    scenarios: u32,
}

impl Tasks {
    /// Returns the tasks of a spec.
    ///
    /// # Errors
    /// A sentence with the place in the spec, for slots without values and values that cannot be used.
    pub fn of(spec: &Spec) -> Result<Self, String> {
        let mut prompts = Vec::new();
        for (i, prompt) in spec.prompts.iter().enumerate() {
            expand(prompt, &mut prompts).map_err(|(key, why)| format!("/prompts/{i}/{key}: {why}"))?;
        }
        deal(&mut prompts, &spec.splits);
        let (placements, scenarios) = (spec.variants.placement, spec.variants.scenario);
        Ok(Self { prompts, seeds: spec.seeds, first_seed: spec.first_seed, placements, scenarios })
    }

    /// Returns how many there are.
    pub fn len(&self) -> u64 {
        self.seeds * self.prompts.len() as u64 * u64::from(self.placements) * u64::from(self.scenarios)
    }

    /// Returns true when there is none; a spec that was read has some.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the prompts in order.
    pub fn prompts(&self) -> &[Prompt] {
        &self.prompts
    }

    /// Returns a task by its place in the order; none past the end.
    pub fn get(&self, number: u64) -> Option<Task<'_>> {
        if number >= self.len() {
            return None;
        }
        let (scenarios, placements) = (u64::from(self.scenarios), u64::from(self.placements));
        let (rest, scenario) = (number / scenarios, (number % scenarios) as u32);
        let (rest, placement) = (rest / placements, (rest % placements) as u32);
        let count = self.prompts.len() as u64;
        let (seed, prompt) = (self.first_seed + rest / count, &self.prompts[(rest % count) as usize]);
        let asked = asked(&prompt.request, [seed, placement.into(), scenario.into()]);
        let digest = sha256(asked.to_string().as_bytes());
        let id = TaskId(u64::from_str_radix(&digest[..16], 16).expect("a digest is hexadecimal"));
        Some(Task { number, id, prompt, seed, placement, scenario })
    }

    /// Returns all tasks in order.
    pub fn iter(&self) -> impl Iterator<Item = Task<'_>> {
        (0..self.len()).filter_map(|n| self.get(n))
    }
}

/// Returns what a task asks for; what is not said has no key, so that a later release with more to say gives the same ids.
fn asked(request: &Request, [seed, placement, scenario]: [u64; 3]) -> serde_json::Value {
    let Request { prompt, domain, country, rooms, area_m2, robot_radius_m, robot, style, .. } = request;
    let mut value = json!({
        "prompt": prompt, "domain": domain, "country": country, "rooms": rooms, "area_m2": area_m2,
        "robot_radius_m": robot_radius_m, "robot": robot, "style": style, "seed": seed,
        "placement": placement, "scenario": scenario,
    });
    if let Some(object) = value.as_object_mut() {
        object.retain(|_, value| !value.is_null() && value.as_object().is_none_or(|o| !o.is_empty()));
    }
    value
}

/// A place in the spec, and what is wrong there.
type Problem = (String, String);

/// Adds the prompts of a template, the last slot by name varying fastest.
fn expand(spec: &PromptSpec, prompts: &mut Vec<Prompt>) -> Result<(), Problem> {
    for text in spec.text.all() {
        let parts = parts(text).map_err(|why| ("text".to_owned(), why))?;
        let used: BTreeSet<&str> = parts.iter().filter_map(|p| p.slot()).collect();
        if let Some(slot) = used.iter().find(|slot| !spec.slots.contains_key(**slot)) {
            let why = format!(
                "`{{{slot}}}` has no values; add `{slot} = [...]`, or write {{{{{slot}}}}} for the word in braces"
            );
            return Err(("text".into(), why));
        }
        let mut chosen: Vec<(&str, &Scalar)> = Vec::new();
        choose(spec, &mut chosen, &mut |chosen| {
            let prompt = fill(&parts, &used, chosen)?;
            prompts.push(prompt);
            Ok(())
        })?;
    }
    Ok(())
}

/// A slot with the value chosen for it.
type Choice<'s> = (&'s str, &'s Scalar);

/// Calls `found` for every choice of one value a slot.
fn choose<'s>(
    spec: &'s PromptSpec,
    chosen: &mut Vec<Choice<'s>>,
    found: &mut dyn FnMut(&[Choice<'s>]) -> Result<(), Problem>,
) -> Result<(), Problem> {
    let Some((name, values)) = spec.slots.iter().nth(chosen.len()) else { return found(chosen) };
    for value in values.all() {
        chosen.push((name, value));
        choose(spec, chosen, found)?;
        chosen.pop();
    }
    Ok(())
}

fn fill(parts: &[Part], used: &BTreeSet<&str>, chosen: &[(&str, &Scalar)]) -> Result<Prompt, Problem> {
    let mut request = Request::default();
    let mut slots = BTreeMap::new();
    for (name, value) in chosen {
        let at = |why: String| ((*name).to_owned(), why);
        let said = match value {
            Scalar::Robot(body) => serde_json::to_string(body).map_err(|e| at(e.to_string()))?,
            value => value.in_words().unwrap_or_default(),
        };
        slots.insert((*name).to_owned(), said);
        if used.contains(name) {
            value.in_words().ok_or_else(|| at("a robot's body is no words: it cannot stand in the text".into()))?;
            continue;
        }
        let Some((_, set)) = FLAGS.iter().find(|(flag, _)| flag == name) else {
            let known: Vec<&str> = FLAGS.iter().map(|f| f.0).collect();
            let why = format!(
                "the text has no `{{{name}}}`; without a place in the text only these count: {}",
                known.join(", ")
            );
            return Err(at(why));
        };
        set(&mut request, value).map_err(at)?;
    }
    let word = |part: &Part| match part {
        Part::Text(text) => text.clone(),
        Part::Slot(slot) => slots.get(slot).cloned().unwrap_or_default(),
    };
    let sentence: String = parts.iter().map(word).collect();
    request.prompt = sentence + &request.prompt; // what flags add comes after it
    Ok(Prompt { request, slots, split: String::new() })
}

/// A piece of a template.
enum Part {
    Text(String),
    Slot(String),
}

impl Part {
    fn slot(&self) -> Option<&str> {
        match self {
            Self::Slot(name) => Some(name),
            Self::Text(_) => None,
        }
    }
}

/// Returns the pieces of a template.
fn parts(text: &str) -> Result<Vec<Part>, String> {
    let (mut parts, mut plain, mut rest) = (Vec::new(), String::new(), text);
    while let Some(at) = rest.find(['{', '}']) {
        plain += &rest[..at];
        let brace = &rest[at..=at];
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix(brace) {
            plain += brace;
            rest = after;
        } else if brace == "}" {
            return Err("a `}` closes nothing; write }} for a brace".into());
        } else {
            let end = rest.find(['{', '}']).filter(|&end| rest[end..].starts_with('}'));
            let end = end.ok_or_else(|| format!("`{{{rest}` is not closed; write {{{{ for a brace"))?;
            parts.extend([Part::Text(std::mem::take(&mut plain)), Part::Slot(rest[..end].trim().to_owned())]);
            rest = &rest[end + 1..];
        }
    }
    parts.push(Part::Text(plain + rest));
    Ok(parts)
}

fn number(value: &Scalar) -> Result<f64, String> {
    match value {
        Scalar::Whole(n) => Ok(*n as f64),
        Scalar::Number(x) => Ok(*x),
        _ => Err("is a number".into()),
    }
}

fn words(value: &Scalar) -> Result<String, String> {
    match value {
        Scalar::Text(text) => Ok(text.clone()),
        _ => Err("is words".into()),
    }
}

fn set_rooms(request: &mut Request, value: &Scalar) -> Result<(), String> {
    let Scalar::Whole(n) = value else { return Err("is a whole number".into()) };
    request.rooms = Some(u32::try_from(*n).map_err(|_| format!("{n} is no number of rooms"))?);
    Ok(())
}

fn set_clutter(request: &mut Request, value: &Scalar) -> Result<(), String> {
    let name = words(value)?;
    let clutter =
        Clutter::of(&name).ok_or_else(|| format!("clutter `{name}` is not known; known are low, normal, high"))?;
    request.style.clutter = Some(clutter);
    Ok(())
}

fn set_style(request: &mut Request, value: &Scalar) -> Result<(), String> {
    let text = words(value)?;
    let style = Style::of_words(text.split(',').map(str::trim).filter(|w| !w.is_empty()))?;
    request.style = request.style.or(style);
    Ok(())
}

fn set_robots(request: &mut Request, value: &Scalar) -> Result<(), String> {
    match value {
        Scalar::Robot(body) => request.robot = RobotBody { ..*body },
        Scalar::Text(text) => request.prompt = format!(", for {text}"),
        _ => return Err("is words (\"two delivery robots\") or a body ({ width_m = 0.5, length_m = 0.7 })".into()),
    }
    Ok(())
}

/// Deals the prompts to the splits: in the order of their digests, by the shares, each split at least one prompt where there
/// are enough. The same sentence is in one split, whatever is said beside it.
fn deal(prompts: &mut [Prompt], splits: &Splits) {
    let sentences: BTreeSet<String> = prompts.iter().map(|p| p.request.prompt.clone()).collect();
    let mut order: Vec<(String, String)> = sentences.into_iter().map(|s| (sha256(s.as_bytes()), s)).collect();
    order.sort();
    let mut shares: Vec<(&String, f64)> = splits.shares.iter().map(|(name, share)| (name, *share)).collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(b.0)));
    let counts = counts(order.len(), &shares.iter().map(|s| s.1).collect::<Vec<_>>());
    let names = shares.iter().zip(counts).flat_map(|((name, _), n)| std::iter::repeat_n((*name).clone(), n));
    let split: BTreeMap<String, String> = order.into_iter().map(|(_, sentence)| sentence).zip(names).collect();
    for prompt in prompts {
        prompt.split = split.get(&prompt.request.prompt).cloned().unwrap_or_default();
    }
}

/// Returns how many of `n` things each share gets, by the largest remainder; at least one each where there are enough.
fn counts(n: usize, shares: &[f64]) -> Vec<usize> {
    let exact: Vec<f64> = shares.iter().map(|s| s * n as f64).collect();
    let least = usize::from(n >= shares.len());
    let mut counts: Vec<usize> = exact.iter().map(|x| ((x + 1e-9).floor() as usize).max(least)).collect();
    while counts.iter().sum::<usize>() != n {
        let short = counts.iter().sum::<usize>() < n;
        let lack = |i: &usize| exact[*i] - counts[*i] as f64;
        let indices = 0..shares.len();
        let at = if short {
            indices.max_by(|a, b| lack(a).total_cmp(&lack(b)).then(b.cmp(a)))
        } else {
            indices.filter(|i| counts[*i] > least).min_by(|a, b| lack(a).total_cmp(&lack(b)).then(a.cmp(b)))
        };
        let Some(at) = at else { break };
        if short {
            counts[at] += 1;
        } else {
            counts[at] -= 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tasks(text: &str) -> Tasks {
        Tasks::of(&Spec::from_toml(text, "spec.toml").unwrap()).unwrap()
    }

    const OFFICES: &str = r#"
name = "offices"
seeds = 3
[[prompts]]
text = ["office with {rooms} rooms", "Büro mit {rooms} {{Räumen}}"]
rooms = [4, 6]
country = ["Germany", "Japan"]
robots = "two delivery robots"
style = ["compact", "open, generous"]
"#;

    #[test]
    fn slots_are_filled_and_what_has_no_slot_is_said_beside() {
        let tasks = tasks(OFFICES);
        assert_eq!((tasks.prompts().len(), tasks.len()), (16, 48));
        let first = &tasks.prompts()[0].request;
        assert_eq!(first.prompt, "office with 4 rooms, for two delivery robots");
        assert_eq!((first.country.as_deref(), first.rooms), (Some("Germany"), None));
        assert!(tasks.prompts().iter().any(|p| p.request.prompt.starts_with("Büro mit 6 {Räumen}")));
        assert!(!tasks.prompts()[1].request.style.is_plain());
    }

    #[test]
    fn ids_are_distinct_and_stay_when_seeds_are_added() {
        let few = tasks(OFFICES);
        let ids: BTreeSet<TaskId> = few.iter().map(|t| t.id).collect();
        assert_eq!(ids.len() as u64, few.len());
        let many = tasks(&OFFICES.replace("seeds = 3", "seeds = 5"));
        assert!(few.iter().zip(many.iter()).all(|(a, b)| (a.id, a.number, a.seed) == (b.id, b.number, b.seed)));
        let id = ids.first().unwrap();
        assert_eq!(TaskId::parse(&id.to_string()), Some(*id));
    }

    #[test]
    fn variants_share_their_plan() {
        let tasks = tasks(&format!("variants = {{ placement = 2, scenario = 3 }}\n{OFFICES}"));
        assert_eq!(tasks.len(), 48 * 6);
        let of = |n| tasks.get(n).map(|t| (t.seed, t.placement, t.scenario, t.prompt.request.prompt.clone())).unwrap();
        assert_eq!((of(0).1, of(0).2, of(5).1, of(5).2), (0, 0, 1, 2));
        assert_eq!((of(0).0, &of(0).3), (of(5).0, &of(5).3));
    }

    #[test]
    fn a_sentence_is_in_one_split_and_every_split_has_some() {
        let tasks = tasks(&format!("{OFFICES}\n[splits]\ntrain = 0.8\nval = 0.1\ntest = 0.1\n"));
        let mut of: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for prompt in tasks.prompts() {
            of.entry(&prompt.request.prompt).or_default().insert(&prompt.split);
        }
        assert!(of.values().all(|splits| splits.len() == 1));
        let all: BTreeSet<&str> = of.values().flatten().copied().collect();
        assert_eq!(all, BTreeSet::from(["test", "train", "val"]));
        assert_eq!(counts(10, &[0.8, 0.1, 0.1]), [8, 1, 1]);
        assert_eq!(counts(4, &[0.8, 0.1, 0.1]), [2, 1, 1]);
        assert_eq!(counts(2, &[0.8, 0.1, 0.1]), [2, 0, 0]);
        assert_eq!(counts(7, &[0.5, 0.5]).iter().sum::<usize>(), 7);
    }
}
