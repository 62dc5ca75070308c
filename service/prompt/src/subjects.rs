//! Rooms and objects that words name: which of their senses the building at hand knows.

use std::collections::BTreeSet;

use d3dgen_language::Reading;
use d3dgen_model::brief::Subject;
use d3dgen_plugins::Registry;

use crate::node::Node;

/// What a building knows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Known {
    pub rooms: BTreeSet<String>,
    pub objects: BTreeSet<String>,
}

impl Known {
    /// Returns what a domain knows; nothing for a building that no domain knows.
    pub fn of(registry: &Registry, domain: Option<&str>) -> Self {
        let Some(plugin) = domain.and_then(|d| registry.get(d)) else { return Self::default() };
        Self {
            rooms: plugin.domain().room_types.iter().map(|r| r.id.clone()).collect(),
            objects: plugin.domain().objects.iter().map(|o| o.id.clone()).collect(),
        }
    }

    /// Returns the sense of a node that the building knows, or else its first one.
    fn sense<'n>(&self, node: &'n Node, class: &'n str) -> Option<&'n str> {
        let known = if class == "room" { &self.rooms } else { &self.objects };
        // of those that the building knows, the one that is called so
        let named = |v: &&str| node.text.contains(&v.replace('_', " "));
        let fits = || node.values(class).filter(|v| known.contains(*v));
        fits().find(named).or_else(|| fits().next()).or_else(|| node.values(class).next())
    }

    /// Returns the room or object that a node of the grammar is about: a field of that class, or words of the prompt's own.
    pub fn subject(&self, node: &Node, class: &str, reading: &Reading) -> Subject {
        let own: Vec<&Node> = node.all("own").map(|n| &**n).collect();
        let named = node.field(class);
        let id = named.and_then(|n| self.sense(n, class)).map(str::to_owned);
        let ends = own.iter().map(|n| n.tokens.clone()).chain(named.map(|n| n.tokens.clone()));
        let span = ends.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
        let name = span.map_or("", |s| reading.written(s)).to_owned();
        Subject { id, name }
    }

    /// Returns the room or object of a node, whichever it is about.
    pub fn any(&self, node: &Node, reading: &Reading) -> Subject {
        match node.made() {
            Some("objects") => self.subject(node, "object", reading),
            Some("rooms") => self.subject(node, "room", reading),
            _ => Subject::unknown(reading.written(node.tokens.clone())),
        }
    }
}
