//! Applies the rules, step by step: the heaviest set of matches that do not overlap.

use std::rc::Rc;
use std::sync::Arc;

use crate::grammar::{Grammar, Level, Makes, Order, Rule};
use crate::node::Node;
use crate::pattern::Fit;

/// A rule that took words.
#[derive(Debug, Clone)]
pub(crate) struct Applied {
    pub rule: usize,
    pub node: Rc<Node>,
}

/// Applies all rules; returns what is left, and what each rule took.
pub(crate) fn parse(grammar: &Grammar, nodes: Vec<Rc<Node>>) -> (Vec<Rc<Node>>, Vec<Applied>) {
    let mut nodes = nodes;
    let mut applied = Vec::new();
    for level in &grammar.steps {
        for _ in 0..level.times {
            let before = nodes.len();
            nodes = step(grammar, level, nodes, &mut applied);
            if nodes.len() == before {
                break;
            }
        }
    }
    (nodes, applied)
}

struct Candidate {
    rule: usize,
    score: f64,
    fit: Fit,
}

fn step(grammar: &Grammar, level: &Level, nodes: Vec<Rc<Node>>, applied: &mut Vec<Applied>) -> Vec<Rc<Node>> {
    let small = |node: &Node| grammar.small.iter().any(|(class, value)| node.is(class, Some(value)));
    // from behind: the worth of all nodes from one on, and the match that is taken there
    let mut best: Vec<(f64, Option<Candidate>)> = Vec::with_capacity(nodes.len() + 1);
    best.push((0.0, None));
    for from in (0..nodes.len()).rev() {
        let worth_at = |node: usize, best: &Vec<(f64, Option<Candidate>)>| best[nodes.len() - node].0;
        let mut here = (worth_at(from + 1, &best), None);
        for &number in &level.rules {
            let rule = &grammar.rules[number];
            if !may_begin(rule, &nodes[from]) {
                continue;
            }
            let Some(fit) = rule.pattern.fit(&nodes, from, &small) else { continue };
            let score = rule.weight + fit.taken as f64 + worth_at(fit.end, &best);
            if score > here.0 {
                here = (score, Some(Candidate { rule: number, score, fit }));
            }
        }
        best.push(here);
    }
    let mut left = Vec::with_capacity(nodes.len());
    let mut at = 0;
    while at < nodes.len() {
        let taken = best[nodes.len() - at].1.take();
        match taken {
            Some(candidate) => {
                debug_assert!(candidate.score > 0.0);
                let node = Rc::new(made(grammar, &candidate, &nodes, at));
                applied.push(Applied { rule: candidate.rule, node: node.clone() });
                left.push(node);
                at = candidate.fit.end;
            }
            None => {
                left.push(nodes[at].clone());
                at += 1;
            }
        }
    }
    left
}

fn may_begin(rule: &Rule, node: &Node) -> bool {
    let order = match rule.order {
        Some(Order::First) => !node.head_last,
        Some(Order::Last) => node.head_last,
        Some(Order::Postposed) => node.postpositions,
        Some(Order::Preposed) => !node.postpositions,
        None => true,
    };
    order && (rule.first.is_empty() || rule.first.iter().any(|c| node.is(c, None) || (c == "mark" && node.mark)))
}

/// Returns the class of words whose value something is known by that a rule made, of what it captured under a name.
fn class_of(name: &str) -> Option<&str> {
    match name {
        "room" | "object" | "classifier" => Some(name),
        "who" => Some("person"),
        "what" => Some("capacity"),
        "named" => Some("storey"),
        _ => None,
    }
}

fn made(grammar: &Grammar, candidate: &Candidate, nodes: &[Rc<Node>], from: usize) -> Node {
    let rule = &grammar.rules[candidate.rule];
    let tokens = nodes[from].tokens.start..nodes[candidate.fit.end - 1].tokens.end;
    let captured = candidate.fit.captured.iter().map(|(name, at)| (name.clone(), nodes[*at].clone()));
    let mut captured: Vec<(Arc<str>, Rc<Node>)> = captured.collect();
    let constants = rule.set.iter().map(|(name, value)| {
        (Arc::from(name.as_str()), Rc::new(Node { text: value.as_str().into(), tokens: 0..0, ..Node::default() }))
    });
    let mut node = Node {
        tokens,
        rule: Some(candidate.rule),
        head_last: nodes[from].head_last,
        postpositions: nodes[from].postpositions,
        joined: nodes[from].joined,
        ..Node::default()
    };
    match &rule.makes {
        Makes::New(class) => {
            let class: Arc<str> = class.as_str().into();
            // rooms, objects, people, places and storeys may be asked for by their values
            let ids = captured.iter().filter_map(|(name, n)| Some((class_of(name)?, n)));
            let ids = ids.flat_map(|(of, n)| n.values(of).map(Arc::from).collect::<Vec<Arc<str>>>());
            node.senses = [Arc::from("")].into_iter().chain(ids).map(|id| (class.clone(), id)).collect();
        }
        Makes::More(name) => {
            let Some(at) = captured.iter().position(|(n, _)| **n == **name) else { return node };
            let base = captured.remove(at).1;
            node.senses.clone_from(&base.senses);
            node.fields.clone_from(&base.fields);
        }
    }
    node.fields.extend(captured);
    node.fields.extend(constants);
    node
}
