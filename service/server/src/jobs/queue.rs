//! Whose turn it is: one job of each client after the other, so that nobody waits behind somebody else's many.

use std::collections::{BTreeMap, VecDeque};
use std::ops::Bound;

/// Jobs that wait, by owner, each owner's in their order.
#[derive(Debug, Default)]
pub(super) struct Queue {
    waiting: BTreeMap<String, VecDeque<String>>,
    /// Whose job began last.
    last: Option<String>,
}

impl Queue {
    pub(super) fn push(&mut self, owner: &str, id: &str) {
        self.waiting.entry(owner.to_owned()).or_default().push_back(id.to_owned());
    }

    /// Takes the first job of the next owner after the last one, in the order of names and around.
    pub(super) fn pop(&mut self) -> Option<String> {
        let after = self.last.as_deref().map_or(Bound::Unbounded, Bound::Excluded);
        let next = self.waiting.range::<str, _>((after, Bound::Unbounded)).next().or(self.waiting.iter().next());
        let owner = next?.0.clone();
        let own = self.waiting.get_mut(&owner)?;
        let id = own.pop_front();
        if own.is_empty() {
            self.waiting.remove(&owner);
        }
        self.last = Some(owner);
        id
    }

    pub(super) fn remove(&mut self, id: &str) {
        for own in self.waiting.values_mut() {
            own.retain(|i| i != id);
        }
        self.waiting.retain(|_, own| !own.is_empty());
    }

    pub(super) fn len(&self) -> usize {
        self.waiting.values().map(VecDeque::len).sum()
    }

    pub(super) fn len_of(&self, owner: &str) -> usize {
        self.waiting.get(owner).map_or(0, VecDeque::len)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn owners_take_turns() {
        let mut queue = Queue::default();
        for (owner, id) in [("b", "b1"), ("b", "b2"), ("b", "b3"), ("a", "a1"), ("c", "c1"), ("a", "a2")] {
            queue.push(owner, id);
        }
        queue.remove("b2");
        assert_eq!((queue.len(), queue.len_of("b")), (5, 2));
        let order: Vec<String> = std::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(order, ["a1", "b1", "c1", "a2", "b3"]);
        queue.push("a", "a3");
        assert_eq!(queue.pop().as_deref(), Some("a3"));
    }
}
