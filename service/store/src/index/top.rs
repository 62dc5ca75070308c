//! The best few of many scored rows; equal scores go by row, which is the order of keys.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// A row and how well it fits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scored {
    pub(crate) score: f32,
    pub(crate) row: u32,
}

impl Eq for Scored {}

impl Ord for Scored {
    /// Greater is better.
    fn cmp(&self, other: &Self) -> Ordering {
        self.score.total_cmp(&other.score).then(other.row.cmp(&self.row))
    }
}

impl PartialOrd for Scored {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Keeps the best `limit` of what is pushed.
pub(crate) struct Top {
    limit: usize,
    heap: BinaryHeap<Reverse<Scored>>,
}

impl Top {
    pub(crate) fn new(limit: usize) -> Self {
        Self { limit, heap: BinaryHeap::with_capacity(limit.min(1024) + 1) }
    }

    /// Returns the score that another row has to exceed, once there are enough; a later row of equal score loses.
    pub(crate) fn threshold(&self) -> Option<f32> {
        if self.heap.len() < self.limit { None } else { Some(self.heap.peek().map_or(f32::INFINITY, |w| w.0.score)) }
    }

    #[inline]
    pub(crate) fn push(&mut self, score: f32, row: u32) {
        let scored = Scored { score, row };
        if self.heap.len() < self.limit {
            self.heap.push(Reverse(scored));
        } else if let Some(mut worst) = self.heap.peek_mut()
            && worst.0 < scored
        {
            *worst = Reverse(scored);
        }
    }

    /// Returns what was kept, best first.
    pub(crate) fn into_sorted(self) -> Vec<Scored> {
        self.heap.into_sorted_vec().into_iter().map(|Reverse(scored)| scored).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_best_and_prefers_earlier_rows() {
        for limit in [0, 1, 3, 10] {
            let mut top = Top::new(limit);
            let scores = [0.5, 0.9, 0.5, 0.1, 0.9, 0.5];
            (0..).zip(scores).for_each(|(row, score)| top.push(score, row));
            let rows: Vec<u32> = top.into_sorted().iter().map(|s| s.row).collect();
            assert_eq!(rows, [1, 4, 0, 2, 5, 3][..limit.min(6)]);
        }
    }
}
