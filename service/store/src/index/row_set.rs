//! Sets of rows as bits: what a filter leaves over. Rows are numbered in the order of their keys.

/// A set of the rows 0 to `rows`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RowSet {
    words: Vec<u64>,
    rows: u32,
}

impl RowSet {
    pub(crate) fn none(rows: u32) -> Self {
        Self { words: vec![0; rows.div_ceil(64) as usize], rows }
    }

    pub(crate) fn all(rows: u32) -> Self {
        let mut set = Self { words: vec![u64::MAX; rows.div_ceil(64) as usize], rows };
        set.trim();
        set
    }

    pub(crate) fn insert(&mut self, row: u32) {
        if let Some(word) = self.words.get_mut((row / 64) as usize)
            && row < self.rows
        {
            *word |= 1 << (row % 64);
        }
    }

    pub(crate) fn contains(&self, row: u32) -> bool {
        self.words.get((row / 64) as usize).is_some_and(|word| word >> (row % 64) & 1 == 1)
    }

    pub(crate) fn count(&self) -> u32 {
        self.words.iter().map(|w| w.count_ones()).sum()
    }

    pub(crate) fn intersect(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= b);
    }

    pub(crate) fn unite(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a |= b);
    }

    pub(crate) fn invert(&mut self) {
        self.words.iter_mut().for_each(|w| *w = !*w);
        self.trim();
    }

    /// Yields the rows in ascending order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.words).flat_map(|(index, &word): (u32, &u64)| {
            let mut left = word;
            std::iter::from_fn(move || {
                let bit = (left != 0).then(|| left.trailing_zeros())?;
                left &= left - 1;
                Some(index * 64 + bit)
            })
        })
    }

    fn trim(&mut self) {
        let spare = self.rows.div_ceil(64) * 64 - self.rows;
        if let Some(last) = self.words.last_mut() {
            *last &= u64::MAX >> spare;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_of_all_sizes_hold_what_was_put_in() {
        for rows in [0, 1, 63, 64, 65, 200] {
            let mut set = RowSet::none(rows);
            (0..rows).step_by(3).for_each(|row| set.insert(row));
            set.insert(rows);
            assert_eq!(set.iter().collect::<Vec<_>>(), (0..rows).step_by(3).collect::<Vec<_>>());
            let mut others = set.clone();
            others.invert();
            assert_eq!(set.count() + others.count(), rows);
            assert!(others.iter().all(|row| !set.contains(row)));
            others.unite(&set);
            assert_eq!(others, RowSet::all(rows));
            others.intersect(&set);
            assert_eq!(others, set);
        }
    }
}
