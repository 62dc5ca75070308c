//! Patterns over nodes, as the rules of the grammar write them.
//!
//! `count:count? attribute:attribute* room:room` is three elements: a name under which what matches is captured, what it must
//! be (a class, or a class with a value: `particle.no`), and how often (`?` at most once, `*` any number of times, `+` at
//! least once). `( a | b c )` is one of several sequences. `=mark` must come next, or the end, and is not taken; `!mark` must not come next; `<mark` must
//! stand before, or the beginning. Small words that say nothing may stand between the elements.

use std::rc::Rc;
use std::sync::Arc;

use crate::node::Node;

/// Most nodes that one match takes.
const LONGEST: usize = 40;

/// A sequence of elements.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pattern(Vec<Element>);

#[derive(Debug, Clone, PartialEq)]
struct Element {
    what: What,
    least: usize,
    most: usize,
}

#[derive(Debug, Clone, PartialEq)]
enum What {
    Atom { name: Option<Arc<str>>, class: String, value: Option<String>, look: Look },
    Any(Vec<Pattern>),
}

/// Where an atom looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Look {
    /// At the next node, which it takes.
    Here,
    /// At the next node or the end, which must be so and is not taken.
    Ahead,
    /// At the next node, which must not be so.
    NotAhead,
    /// At the node before, or the beginning, which must be so.
    Behind,
}

/// Where a pattern fits.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    /// First node behind it.
    pub end: usize,
    /// What was captured: a name, and which node.
    pub captured: Vec<(Arc<str>, usize)>,
    /// Nodes taken, those in between aside.
    pub taken: usize,
}

impl Pattern {
    /// Reads a pattern.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let words = words(text);
        let mut at = 0;
        let pattern = sequence(&words, &mut at)?;
        if at < words.len() {
            return Err(format!("`{}` closes nothing", words[at]));
        }
        if pattern.0.is_empty() {
            return Err("it is empty".to_owned());
        }
        Ok(pattern)
    }

    /// Captures what has no name yet under this one.
    fn capture_as(&mut self, under: &str) {
        for element in &mut self.0 {
            match &mut element.what {
                What::Atom { name, .. } => *name = name.take().or_else(|| Some(under.into())),
                What::Any(ways) => ways.iter_mut().for_each(|way| way.capture_as(under)),
            }
        }
    }

    /// Makes all of it look elsewhere, and take nothing.
    fn look_to(&mut self, to: Look) {
        for element in &mut self.0 {
            match &mut element.what {
                What::Atom { look, .. } => *look = to,
                What::Any(ways) => ways.iter_mut().for_each(|way| way.look_to(to)),
            }
        }
    }

    /// Returns the classes of its first elements, to pass over it quickly; empty when any may be first.
    pub fn first_classes(&self) -> Vec<&str> {
        let mut classes = Vec::new();
        if self.collect_first(&mut classes) { classes } else { Vec::new() }
    }

    /// Collects what may be first; false when it may be empty.
    fn collect_first<'a>(&'a self, classes: &mut Vec<&'a str>) -> bool {
        for element in &self.0 {
            let solid = match &element.what {
                What::Atom { class, look: Look::Here, .. } => {
                    classes.push(class);
                    true
                }
                What::Atom { .. } => false,
                What::Any(patterns) => {
                    // all of them: each adds what it may begin with
                    let solid: Vec<bool> = patterns.iter().map(|p| p.collect_first(classes)).collect();
                    solid.into_iter().all(|s| s)
                }
            };
            if solid && element.least > 0 {
                return true;
            }
        }
        false
    }

    /// Returns all classes that it asks for, with their values.
    #[cfg(test)]
    pub fn classes(&self) -> Vec<(&str, Option<&str>)> {
        self.0
            .iter()
            .flat_map(|e| match &e.what {
                What::Atom { class, value, .. } => vec![(class.as_str(), value.as_deref())],
                What::Any(patterns) => patterns.iter().flat_map(Pattern::classes).collect(),
            })
            .collect()
    }

    /// Returns the longest way in which it fits from a node on; `skip` says which nodes may stand between its elements.
    pub fn fit(&self, nodes: &[Rc<Node>], from: usize, skip: &dyn Fn(&Node) -> bool) -> Option<Fit> {
        let mut best: Option<Fit> = None;
        let mut steps = 0;
        let mut walk = Walk { nodes, from, skip, steps: &mut steps };
        walk.sequence(&self.0, Fit { end: from, captured: Vec::new(), taken: 0 }, &mut |_, fit| {
            if fit.taken > 0 && best.as_ref().is_none_or(|b| fit.taken > b.taken) {
                best = Some(fit);
            }
        });
        best
    }
}

/// Most steps of one try: patterns have few ways to fit, and no text makes them many.
const STEPS: usize = 2000;

struct Walk<'a> {
    nodes: &'a [Rc<Node>],
    from: usize,
    skip: &'a dyn Fn(&Node) -> bool,
    steps: &'a mut usize,
}

type Then<'t> = &'t mut dyn FnMut(&mut Walk, Fit);

impl Walk<'_> {
    fn sequence(&mut self, elements: &[Element], fit: Fit, then: Then) {
        let Some((first, rest)) = elements.split_first() else {
            then(self, fit);
            return;
        };
        self.repeat(first, 0, fit, &mut |walk, fit| walk.sequence(rest, fit, then));
    }

    fn repeat(&mut self, element: &Element, done: usize, fit: Fit, then: Then) {
        *self.steps += 1;
        if *self.steps > STEPS || fit.end - self.from > LONGEST {
            return;
        }
        if done < element.most {
            let before = fit.end;
            self.once(element, fit.clone(), &mut |walk, fit| {
                // what takes nothing is not done again
                if fit.end > before {
                    walk.repeat(element, done + 1, fit, then);
                } else if done < element.least {
                    then(walk, fit);
                }
            });
        }
        if done >= element.least {
            then(self, fit);
        }
    }

    fn once(&mut self, element: &Element, fit: Fit, then: Then) {
        match &element.what {
            What::Any(patterns) => patterns.iter().for_each(|p| self.sequence(&p.0, fit.clone(), then)),
            What::Atom { class, value, look: look @ (Look::Ahead | Look::NotAhead | Look::Behind), .. } => {
                let is = |n: &Rc<Node>| n.is(class, value.as_deref());
                let fits = match look {
                    Look::Behind => fit.end.checked_sub(1).is_none_or(|before| is(&self.nodes[before])),
                    Look::NotAhead => !self.nodes.get(fit.end).is_some_and(is),
                    _ => self.nodes.get(fit.end).is_none_or(is),
                };
                if fits {
                    then(self, fit);
                }
            }
            What::Atom { name, class, value, .. } => {
                let mut at = fit.end;
                loop {
                    let Some(node) = self.nodes.get(at) else { return };
                    if node.is(class, value.as_deref()) {
                        let mut fit = fit;
                        // "own+hold": under two names
                        for name in name.iter().flat_map(|n| n.split('+')) {
                            fit.captured.push((name.into(), at));
                        }
                        fit.end = at + 1;
                        fit.taken += 1;
                        then(self, fit);
                        return;
                    }
                    // small words may stand between, not before
                    if at == self.from || !(self.skip)(node) {
                        return;
                    }
                    at += 1;
                }
            }
        }
    }
}

fn words(text: &str) -> Vec<String> {
    let mut spaced = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '(' | '|' => spaced.extend([' ', c, ' ']),
            ')' => spaced.extend([' ', c]),
            _ => spaced.push(c),
        }
    }
    spaced.split_whitespace().map(str::to_owned).collect()
}

fn sequence(words: &[String], at: &mut usize) -> Result<Pattern, String> {
    let mut elements = Vec::new();
    while let Some(word) = words.get(*at) {
        if word == "|" || word.starts_with(')') {
            break;
        }
        *at += 1;
        // "item:( rooms | objects )": what is in the bracket is captured under the name
        let opens = words.get(*at).is_some_and(|w| w == "(");
        let name = word.strip_suffix(':').filter(|_| opens);
        let look = look_of(word).filter(|_| opens && word.len() == 1);
        if word == "(" || name.is_some() || look.is_some() {
            *at += usize::from(name.is_some() || look.is_some());
            let mut ways = vec![sequence(words, at)?];
            while words.get(*at).is_some_and(|w| w == "|") {
                *at += 1;
                ways.push(sequence(words, at)?);
            }
            let close = words.get(*at).filter(|w| w.starts_with(')')).ok_or("a bracket is not closed")?;
            let (_, least, most) = times(close);
            *at += 1;
            name.iter().for_each(|name| ways.iter_mut().for_each(|way| way.capture_as(name)));
            look.iter().for_each(|look| ways.iter_mut().for_each(|way| way.look_to(*look)));
            elements.push(Element { what: What::Any(ways), least, most });
        } else {
            elements.push(atom(word)?);
        }
    }
    Ok(Pattern(elements))
}

/// Returns where an element looks that begins with one of the signs for that.
fn look_of(word: &str) -> Option<Look> {
    match word.as_bytes().first() {
        Some(b'=') => Some(Look::Ahead),
        Some(b'!') => Some(Look::NotAhead),
        Some(b'<') => Some(Look::Behind),
        _ => None,
    }
}

fn atom(word: &str) -> Result<Element, String> {
    let (text, least, most) = times(word);
    let (look, text) = look_of(text).map_or((Look::Here, text), |look| (look, &text[1..]));
    let (name, what) = text.split_once(':').map_or((None, text), |(name, what)| (Some(name), what));
    let (class, value) = what.split_once('.').map_or((what, None), |(class, value)| (class, Some(value.to_owned())));
    let plain = |s: &str| !s.is_empty() && s.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !plain(class) || name.is_some_and(|n| !n.split('+').all(plain)) {
        return Err(format!("`{word}` is no element"));
    }
    let name = name.map(Arc::from);
    Ok(Element { what: What::Atom { name, class: class.to_owned(), value, look }, least, most })
}

fn times(word: &str) -> (&str, usize, usize) {
    match word.as_bytes().last() {
        Some(b'?') => (&word[..word.len() - 1], 0, 1),
        Some(b'*') => (&word[..word.len() - 1], 0, LONGEST),
        Some(b'+') => (&word[..word.len() - 1], 1, LONGEST),
        _ => (word, 1, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(class: &str, value: &str) -> Rc<Node> {
        Rc::new(Node { senses: vec![(class.into(), value.into())], ..Node::default() })
    }

    #[test]
    fn the_longest_way_is_taken_and_small_words_are_passed_over() {
        let nodes = [node("a", "1"), node("small", "x"), node("a", "2"), node("b", "1"), node("small", "x")];
        let skip = |n: &Node| n.is("small", None);
        for (pattern, end, taken) in [
            ("one:a* b", Some(4), 3),
            ("a a b?", Some(4), 3),
            ("a ( b | a.2 )", Some(3), 2),
            ("a ( a b )?", Some(4), 3),
            ("b", None, 0),
            ("a.2", None, 0),
            ("a !small", None, 0),
            ("a !b", Some(1), 1),
            ("<b a", Some(1), 1),
        ] {
            let fit = Pattern::parse(pattern).unwrap().fit(&nodes, 0, &skip);
            assert_eq!(fit.as_ref().map(|f| f.end), end, "{pattern}");
            assert_eq!(fit.map_or(0, |f| f.taken), taken, "{pattern}");
        }
    }

    #[test]
    fn what_is_no_pattern_is_refused() {
        for (text, reason) in [("", "empty"), ("( a", "not closed"), ("a )", "closes nothing"), ("a$", "no element")] {
            let error = Pattern::parse(text).unwrap_err();
            assert!(error.contains(reason), "{error}");
        }
    }
}
