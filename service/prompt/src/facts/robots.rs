//! Robots and their work.

use std::ops::Range;
use std::rc::Rc;

use d3dgen_model::brief::{AskedTask, Fact, RobotsAsk, Subject};

use super::values::{count, kind_of_work, measure, number, several, sides, work_of};
use super::{Around, Maker};
use crate::node::Node;

impl Maker<'_> {
    /// States robots of several kinds: "2 cleaning and 3 delivery robots".
    pub(super) fn fleet(&mut self, node: &Node) {
        let mut n = None;
        for (name, part) in &node.fields {
            match &**name {
                "n" => n = number(part),
                "kind" => {
                    let named = part.values("robot").next().or_else(|| part.values("task").next().map(kind_of_work));
                    let (kind, count) = (named.unwrap_or("service").to_owned(), n.take().unwrap_or_default());
                    self.say(node, Fact::Robots(RobotsAsk { kind, count, ..RobotsAsk::default() }));
                }
                _ => {}
            }
        }
    }

    pub(super) fn robots(&mut self, node: &Node) {
        let kinds = node.all("robot").flat_map(|r| {
            r.values("robot").chain(r.values("task").map(kind_of_work)).map(str::to_owned).collect::<Vec<_>>()
        });
        let mut kinds: Vec<String> = kinds.collect();
        kinds.sort_by_key(|k| k == "any");
        let mut tasks: Vec<AskedTask> = node.all("does").filter_map(|d| self.task(d)).collect();
        if let Some(verb) = tasks.last().map(|t| t.verb.clone()) {
            tasks.extend(node.all("more").map(|d| self.task_of(&verb, d)));
        }
        if let Some(verb) = node.field("work_at").and_then(|_| kinds.first()).and_then(|k| work_of(k)) {
            let to = node.all("work_at").map(|n| self.subject(n)).collect();
            tasks.push(AskedTask { verb: verb.to_owned(), to, ..AskedTask::default() });
        }
        let is_empty = |t: &AskedTask| t.what.is_none() && t.from.is_none() && t.to.is_empty();
        // "fährt nicht in die Zimmer": it drives, and carries nothing
        tasks.retain(|t| node.field("keep_out").is_none() || t.verb != "bring" || !is_empty(t));
        let verb = tasks.first().map(|t| t.verb.clone());
        let mut kind = kinds.into_iter().next().unwrap_or_else(|| "any".to_owned());
        if kind == "any" {
            // a robot is what it does
            kind = verb.map_or_else(|| "service".to_owned(), |v| kind_of_work(&v).to_owned());
        }
        let side = |which: &str| {
            node.all("size")
                .find(|s| s.field("which").is_some_and(|w| w.is("dimension", Some(which))))
                .and_then(|s| measure(s, "length"))
        };
        let bare = node.all("size").find(|s| s.field("which").is_none()).and_then(|s| measure(s, "length"));
        let round = side("diameter").or(side("radius").map(|r| 2.0 * r));
        let sides = sides(node);
        // "a robot vacuums the hall": a verb, no plural
        let several = || several(node, &["robot"]).filter(|_| node.field("work_at").is_none());
        let asked = count(node).or_else(several).unwrap_or_default();
        let keep_out =
            node.all("keep_out").flat_map(|k| k.all("item").map(|n| self.subject(n)).collect::<Vec<_>>()).collect();
        self.say(
            node,
            Fact::Robots(RobotsAsk {
                kind,
                count: asked,
                width_m: side("width").or(round).or(sides.map(|s| s[0])).or(bare),
                length_m: side("length").or(round).or(sides.map(|s| s[1])),
                height_m: side("height"),
                tasks,
                keep_out,
            }),
        );
        let works = node.all("does").chain(node.all("more"));
        let ends = works
            .flat_map(|d| d.all("from").chain(d.all("to")).chain(d.all("at")).cloned().collect::<Vec<_>>())
            .chain(node.all("work_at").cloned());
        let kept = node.all("keep_out").flat_map(|k| k.all("item").cloned().collect::<Vec<_>>());
        for end in ends.chain(kept).collect::<Vec<_>>() {
            self.mention(&end, Around::default());
        }
    }

    /// States work that stands apart from its robots: that of those named last, else only what it names.
    pub(super) fn more_work(&mut self, node: &Node) {
        let somewhere = ["from", "to", "at"].iter().any(|f| node.field(f).is_some());
        let task = self.task(node).filter(|_| somewhere);
        if let (Some(task), Some(robots)) = (task, self.robots_before()) {
            robots.tasks.push(task);
            self.spoken_of.push(node.tokens.clone());
        }
        for (_, part) in node.fields.iter().filter(|(name, _)| ["what", "from", "to", "at"].contains(&&**name)) {
            self.mention_or_state(part, somewhere);
        }
    }

    /// States rooms that the robots named last stay out of.
    pub(super) fn more_kept_out(&mut self, node: &Node) {
        let rooms: Vec<Subject> = node.all("item").map(|n| self.subject(n)).collect();
        let Some(robots) = self.robots_before() else { return self.other(node) };
        robots.keep_out.extend(rooms);
        self.spoken_of.push(node.tokens.clone());
        for room in node.all("item").cloned().collect::<Vec<_>>() {
            self.mention(&room, Around::default());
        }
    }

    fn mention_or_state(&mut self, part: &Rc<Node>, mention: bool) {
        if mention && self.robots_before().is_some() {
            self.mention(part, Around::default());
        } else {
            self.state(part, Around::default());
        }
    }

    /// Returns the robots that were stated last.
    fn robots_before(&mut self) -> Option<&mut RobotsAsk> {
        self.facts
            .iter_mut()
            .rev()
            .find_map(|f| if let Fact::Robots(robots) = &mut f.fact { Some(robots) } else { None })
    }

    fn task(&self, node: &Node) -> Option<AskedTask> {
        let verb = node.field("verb")?.values("task").next()?;
        Some(self.task_of(verb, node))
    }

    fn task_of(&self, verb: &str, node: &Node) -> AskedTask {
        let what: Vec<Range<usize>> = node.all("what").map(|w| w.tokens.clone()).collect();
        let what = what.into_iter().reduce(|a, b| a.start..b.end).map(|t| self.reading.written(t).to_owned());
        let to = node.all("to").chain(node.all("at")).map(|n| self.subject(n)).collect();
        AskedTask { verb: verb.to_owned(), what, from: node.field("from").map(|n| self.subject(n)), to }
    }
}
