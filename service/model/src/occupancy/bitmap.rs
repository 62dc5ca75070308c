//! A rectangular grid of bits in rows of 64-bit words: the set operations, erosion and flood fill that navigation needs.

/// A set of grid cells; cell `(i, j)` is column `i` (east) of row `j` (north). Cells outside the grid are never set.
#[derive(Debug, PartialEq, Eq)]
pub struct Bitmap {
    nx: usize,
    ny: usize,
    stride: usize,
    words: Vec<u64>,
}

impl Clone for Bitmap {
    fn clone(&self) -> Self {
        Self { words: self.words.clone(), ..*self }
    }

    /// Takes over `source` in the memory of `self`.
    fn clone_from(&mut self, source: &Self) {
        (self.nx, self.ny, self.stride) = (source.nx, source.ny, source.stride);
        self.words.clone_from(&source.words);
    }
}

impl Bitmap {
    /// Returns an empty set over `nx` columns and `ny` rows.
    pub fn new(nx: usize, ny: usize) -> Self {
        let stride = nx.div_ceil(64);
        Self { nx, ny, stride, words: vec![0; stride * ny] }
    }

    /// Returns the number of columns.
    pub fn nx(&self) -> usize {
        self.nx
    }

    /// Returns the number of rows.
    pub fn ny(&self) -> usize {
        self.ny
    }

    /// Returns true when the cell is in the set.
    pub fn get(&self, i: usize, j: usize) -> bool {
        i < self.nx && j < self.ny && self.words[j * self.stride + i / 64] >> (i % 64) & 1 == 1
    }

    /// Adds the cell, when it lies in the grid.
    pub fn set(&mut self, i: usize, j: usize) {
        if i < self.nx && j < self.ny {
            self.words[j * self.stride + i / 64] |= 1 << (i % 64);
        }
    }

    /// Adds (`value` true) or removes the cells of columns `i0..i1` and rows `j0..j1`, clipped to the grid.
    pub fn fill(&mut self, i0: i64, i1: i64, j0: i64, j1: i64, value: bool) {
        let (i0, i1) = clip(i0, i1, self.nx);
        let (j0, j1) = clip(j0, j1, self.ny);
        if i0 >= i1 {
            return;
        }
        for j in j0..j1 {
            for w in i0 / 64..=(i1 - 1) / 64 {
                let mask = span_mask(i0, i1, w);
                let word = &mut self.words[j * self.stride + w];
                *word = if value { *word | mask } else { *word & !mask };
            }
        }
    }

    /// Removes the cells of columns `i0..i1` and rows `j0..j1`, clipped to the grid; returns how many of them `counted`
    /// (of one size) has.
    pub fn remove_counting(&mut self, i0: i64, i1: i64, j0: i64, j1: i64, counted: &Self) -> usize {
        let (i0, i1) = clip(i0, i1, self.nx);
        let (j0, j1) = clip(j0, j1, self.ny);
        let mut removed = 0;
        if i0 >= i1 || j0 >= j1 {
            return 0;
        }
        for w in i0 / 64..=(i1 - 1) / 64 {
            let mask = span_mask(i0, i1, w);
            let column = j0 * self.stride + w..(j1 - 1) * self.stride + w + 1;
            let words = self.words[column.clone()].iter_mut().step_by(self.stride);
            for (word, counted) in words.zip(counted.words[column].iter().step_by(self.stride)) {
                let lost = *word & mask;
                if lost != 0 {
                    removed += (lost & counted).count_ones() as usize;
                    *word ^= lost;
                }
            }
        }
        removed
    }

    /// Returns true when any cell of columns `i0..i1` and rows `j0..j1` is in the set.
    pub fn any_in(&self, i0: i64, i1: i64, j0: i64, j1: i64) -> bool {
        let (i0, i1) = clip(i0, i1, self.nx);
        let (j0, j1) = clip(j0, j1, self.ny);
        i0 < i1
            && (j0..j1)
                .any(|j| (i0 / 64..=(i1 - 1) / 64).any(|w| self.words[j * self.stride + w] & span_mask(i0, i1, w) != 0))
    }

    /// Returns into how many pieces the edge cells of columns `i0..i1` and rows `j0..j1`, two or more each, that are in
    /// the set fall, going once around.
    pub fn pieces_around(&self, i0: i64, i1: i64, j0: i64, j1: i64) -> usize {
        let changes = [j0, j1 - 1].map(|j| self.changes_along_row(i0, i1, j)).iter().sum::<usize>()
            + [i0, i1 - 1].map(|i| self.changes_along_column(i, j0, j1)).iter().sum::<usize>();
        let whole = changes == 0 && i0 >= 0 && j0 >= 0 && self.get(i0 as usize, j0 as usize);
        if whole { 1 } else { changes / 2 }
    }

    /// Returns how often a walk along columns `i0..i1` of a row steps into the set or out of it.
    fn changes_along_row(&self, i0: i64, i1: i64, j: i64) -> usize {
        if j < 0 || j >= self.ny as i64 {
            return 0;
        }
        let row = &self.words[j as usize * self.stride..(j as usize + 1) * self.stride];
        let entered = usize::from(i0 < 0 && i1 > 0 && row.first().is_some_and(|w| w & 1 == 1));
        // a bit here stands for the step to the next column
        let (from, to) = clip(i0, i1 - 1, self.nx);
        if from >= to {
            return entered;
        }
        let steps = (from / 64..=(to - 1) / 64).map(|w| {
            let next = row[w] >> 1 | row.get(w + 1).map_or(0, |n| n << 63);
            ((row[w] ^ next) & span_mask(from, to, w)).count_ones() as usize
        });
        entered + steps.sum::<usize>()
    }

    /// Returns how often a walk along rows `j0..j1` of a column steps into the set or out of it.
    fn changes_along_column(&self, i: i64, j0: i64, j1: i64) -> usize {
        if i < 0 || i >= self.nx as i64 {
            return 0;
        }
        let (from, to) = clip(j0, j1, self.ny);
        let (word, bit) = (i as usize / 64, i as usize % 64);
        let (mut changes, mut last) = (0, if j0 < 0 { 0 } else { self.bit(word, bit, from) });
        for j in from..to {
            let on = self.bit(word, bit, j);
            changes += (on ^ last) as usize;
            last = on;
        }
        // beyond the grid nothing is in the set
        changes + if j1 > self.ny as i64 { last as usize } else { 0 }
    }

    /// Returns a bit of a word of row `j`; none beyond the grid.
    fn bit(&self, word: usize, bit: usize, j: usize) -> u64 {
        self.words.get(j * self.stride + word).map_or(0, |w| w >> bit & 1)
    }

    /// Returns all rectangles of cells in the set that cannot be made larger, as first and last but one column and row
    /// `[i0, i1, j0, j1]`, by their lowest row, their highest and their first column. They overlap.
    pub fn maximal_rectangles(&self) -> Vec<[usize; 4]> {
        let mut out = Vec::with_capacity(2 * (self.nx + self.ny));
        let row = |j: usize| &self.words[j * self.stride..(j + 1) * self.stride];
        let mut open = vec![0; self.stride];
        for low in 0..self.ny {
            open.copy_from_slice(row(low));
            for high in low..self.ny {
                open.iter_mut().zip(row(high)).for_each(|(o, w)| *o &= w);
                if open.iter().all(|w| *w == 0) {
                    break;
                }
                let mut from = 0;
                while let Some((i0, i1)) = next_run(&open, from) {
                    let whole = |j: usize| (i0 / 64..=(i1 - 1) / 64).all(|w| span_mask(i0, i1, w) & !row(j)[w] == 0);
                    if !(low > 0 && whole(low - 1) || high + 1 < self.ny && whole(high + 1)) {
                        out.push([i0, i1, low, high + 1]);
                    }
                    from = i1;
                }
            }
        }
        out
    }

    /// Returns the number of cells in the set.
    pub fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Returns the number of cells in both sets (of one size).
    pub fn count_common(&self, other: &Self) -> usize {
        self.words.iter().zip(&other.words).map(|(a, b)| (a & b).count_ones() as usize).sum()
    }

    /// Returns the number of cells in both sets (of one size) of columns `i0..i1` and rows `j0..j1`.
    pub fn count_common_in(&self, other: &Self, i0: i64, i1: i64, j0: i64, j1: i64) -> usize {
        let (i0, i1) = clip(i0, i1, self.nx);
        let (j0, j1) = clip(j0, j1, self.ny);
        if i0 >= i1 {
            return 0;
        }
        let row = |j: usize| {
            (i0 / 64..=(i1 - 1) / 64).map(move |w| {
                let k = j * self.stride + w;
                (self.words[k] & other.words[k] & span_mask(i0, i1, w)).count_ones() as usize
            })
        };
        (j0..j1).flat_map(row).sum()
    }

    /// Returns columns `i0..i1` and rows `j0..j1`, clipped to the grid, as a set of its own: its cell (0, 0) is cell
    /// `(i0, j0)` here.
    pub fn window(&self, i0: i64, i1: i64, j0: i64, j1: i64) -> Self {
        let (i0, i1) = clip(i0, i1, self.nx);
        let (j0, j1) = clip(j0, j1, self.ny);
        let mut out = Self::new(i1.saturating_sub(i0), j1.saturating_sub(j0));
        let bits = i0 % 64;
        for j in 0..out.ny {
            let row = &self.words[(j0 + j) * self.stride..(j0 + j + 1) * self.stride];
            let at = |k: usize| row.get(k).copied().unwrap_or(0);
            for w in 0..out.stride {
                let from = i0 / 64 + w;
                let high = if bits == 0 { 0 } else { at(from + 1) << (64 - bits) };
                let word = at(from) >> bits | high;
                out.words[j * out.stride + w] = word & span_mask(0, out.nx, w);
            }
        }
        out
    }

    /// Returns true when no cell is in the set.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|w| *w == 0)
    }

    /// Adds every cell of the other set (of one size).
    pub fn union(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a |= b);
    }

    /// Keeps only cells that are in the other set too (of one size).
    pub fn intersect(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= b);
    }

    /// Removes every cell of the other set (of one size).
    pub fn subtract(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= !b);
    }

    /// Returns the cells of the set in rows from south to north, west to east.
    pub fn cells(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.ny).flat_map(move |j| {
            (0..self.stride).flat_map(move |w| {
                let mut word = self.words[j * self.stride + w];
                std::iter::from_fn(move || {
                    (word != 0).then(|| {
                        let bit = word.trailing_zeros() as usize;
                        word &= word - 1;
                        (w * 64 + bit, j)
                    })
                })
            })
        })
    }

    /// Returns the largest connected part (by edges), of equal ones that with the southernmost, then westernmost cell.
    pub fn largest(&self) -> Option<Self> {
        let mut rest = self.clone();
        let mut left = rest.count();
        let mut best: Option<(usize, Self)> = None;
        // what is left may hold many small parts, of which none can be the one
        while left > best.as_ref().map_or(0, |(count, _)| *count) {
            let (i, j) = rest.cells().next()?;
            let mut seed = Self::new(self.nx, self.ny);
            seed.set(i, j);
            let part = rest.flood(&seed);
            rest.subtract(&part);
            let count = part.count();
            left -= count;
            if best.as_ref().is_none_or(|(most, _)| count > *most) {
                best = Some((count, part));
            }
        }
        best.map(|(_, part)| part)
    }

    /// Returns the cells whose whole surrounding disc is in the set: no missing cell center, and no cell outside the
    /// grid, is nearer than `radius` (in cells) to the cell's center.
    pub fn eroded(&self, radius: f64) -> Self {
        let reach = radius.ceil() as usize;
        let mut out = self.clone();
        let mut rows: Option<(usize, Vec<u64>)> = None;
        for dy in 0..=reach {
            // half width of the disc in this row: the largest dx with dx^2 + dy^2 < radius^2
            let left = radius * radius - (dy * dy) as f64 - 1e-9;
            if left <= 0.0 {
                continue;
            }
            let half = (left.sqrt().ceil() as usize).saturating_sub(1);
            // near its middle the disc is as wide in several rows, and those above and below it are the same
            if rows.as_ref().is_none_or(|(known, _)| *known != half) {
                rows = Some((half, self.eroded_along_rows(half)));
            }
            let Some((_, rows)) = &rows else { continue };
            out.intersect_moved(rows, dy);
        }
        out
    }

    /// Keeps the cells that have one in `rows` so many rows farther north and so many farther south.
    fn intersect_moved(&mut self, rows: &[u64], dy: usize) {
        let shift = (dy * self.stride).min(self.words.len());
        let kept = self.words.len() - shift;
        self.words[..kept].iter_mut().zip(&rows[shift..]).for_each(|(word, other)| *word &= other);
        self.words[kept..].fill(0);
        self.words[shift..].iter_mut().zip(&rows[..kept]).for_each(|(word, other)| *word &= other);
        self.words[..shift].fill(0);
    }

    /// Returns rows in which a bit stays when all bits within `half` columns are set, by doubling the window.
    fn eroded_along_rows(&self, half: usize) -> Vec<u64> {
        let mut out = self.words.clone();
        if half == 0 {
            return out;
        }
        for row in out.chunks_exact_mut(self.stride.max(1)) {
            let whole = 2 * half + 1;
            let mut window = 1;
            while window < whole {
                let step = window.min(whole - window);
                and_shifted_down(row, step);
                window += step;
            }
            shift_up(row, half);
        }
        out
    }

    /// Returns the cells of the set that touch a seed cell through cells of the set, by edges (not corners).
    pub fn flood(&self, seeds: &Self) -> Self {
        let mut out = seeds.clone();
        out.intersect(self);
        let (stride, ny) = (self.stride, self.ny);
        if stride == 0 {
            return out;
        }
        // rows that have spread to the next one north or south since they last grew need no look
        let (mut north, mut south) = (vec![false; ny], vec![false; ny]);
        for j in 0..ny {
            let row = &mut out.words[j * stride..(j + 1) * stride];
            if row.iter().any(|w| *w != 0) {
                spread_row(row, &self.words[j * stride..(j + 1) * stride]);
                (north[j], south[j]) = (true, true);
            }
        }
        loop {
            for j in 1..ny {
                if std::mem::take(&mut north[j - 1]) && out.spread_from(self, j - 1, j) {
                    (north[j], south[j]) = (true, true);
                }
            }
            let mut grown = false;
            for j in (1..ny).rev() {
                if std::mem::take(&mut south[j]) && out.spread_from(self, j, j - 1) {
                    (north[j - 1], south[j - 1], grown) = (true, true, true);
                }
            }
            if !grown {
                return out;
            }
        }
    }

    /// Spreads filled cells of row `from` into row `to`; returns true when the row changed.
    fn spread_from(&mut self, mask: &Self, from: usize, to: usize) -> bool {
        let s = self.stride;
        let mut changed = false;
        for w in 0..s {
            let new = self.words[from * s + w] & mask.words[to * s + w] & !self.words[to * s + w];
            if new != 0 {
                self.words[to * s + w] |= new;
                changed = true;
            }
        }
        if changed {
            spread_row(&mut self.words[to * s..(to + 1) * s], &mask.words[to * s..(to + 1) * s]);
        }
        changed
    }

    /// Returns the connected parts of the set, largest first (ties: the one with the south-western cell first).
    pub fn components(&self) -> Vec<Self> {
        let mut rest = self.clone();
        let mut out = Vec::new();
        loop {
            let first = rest.cells().next();
            let Some((i, j)) = first else { break };
            let mut seed = Self::new(self.nx, self.ny);
            seed.set(i, j);
            let part = rest.flood(&seed);
            rest.subtract(&part);
            out.push(part);
        }
        out.sort_by_key(|part| std::cmp::Reverse(part.count()));
        out
    }
}

fn clip(a: i64, b: i64, n: usize) -> (usize, usize) {
    (a.clamp(0, n as i64) as usize, b.clamp(0, n as i64) as usize)
}

/// Returns the first stretch of set bits from a bit on, its end exclusive.
fn next_run(words: &[u64], from: usize) -> Option<(usize, usize)> {
    let find = |from: usize, flip: u64| {
        (from / 64..words.len()).find_map(|w| {
            let skipped = if w == from / 64 { u64::MAX << (from % 64) } else { u64::MAX };
            let rest = (words[w] ^ flip) & skipped;
            (rest != 0).then(|| 64 * w + rest.trailing_zeros() as usize)
        })
    };
    let start = find(from, 0)?;
    Some((start, find(start, u64::MAX).unwrap_or(64 * words.len())))
}

/// Returns the bits of word `w` that belong to columns `i0..i1`.
fn span_mask(i0: usize, i1: usize, w: usize) -> u64 {
    let (lo, hi) = (i0.saturating_sub(w * 64).min(63), (i1 - w * 64).min(64));
    (u64::MAX >> (64 - hi)) & (u64::MAX << lo)
}

/// Bit k becomes bit k AND bit k + step.
fn and_shifted_down(row: &mut [u64], step: usize) {
    let (words, bits) = (step / 64, step % 64);
    for w in 0..row.len() {
        let at = |k: usize| row.get(k).copied().unwrap_or(0);
        let low = at(w + words) >> bits;
        let high = if bits == 0 { 0 } else { at(w + words + 1) << (64 - bits) };
        row[w] &= low | high;
    }
}

/// Bit k moves to bit k + step.
fn shift_up(row: &mut [u64], step: usize) {
    let (words, bits) = (step / 64, step % 64);
    for w in (0..row.len()).rev() {
        let at = |k: Option<usize>| k.map_or(0, |k| row[k]);
        let low = at(w.checked_sub(words)) << bits;
        let high = if bits == 0 { 0 } else { at(w.checked_sub(words + 1)) >> (64 - bits) };
        row[w] = low | high;
    }
}

/// Spreads set bits along a row as far as the mask has ones: up by addition, down by parallel prefix, a carry between
/// words.
fn spread_row(row: &mut [u64], mask: &[u64]) {
    let mut carry = 0;
    for (g, &m) in row.iter_mut().zip(mask) {
        *g |= carry & m;
        // adding a seed to its run of ones carries to the run's end: what the sum changes is what the seed reaches
        *g |= (m.wrapping_add(*g) ^ m) & m;
        carry = *g >> 63;
    }
    carry = 0;
    for (g, &m) in row.iter_mut().zip(mask).rev() {
        *g |= (carry << 63) & m;
        let mut p = m;
        for shift in [1, 2, 4, 8, 16, 32] {
            *g |= p & (*g >> shift);
            p &= p >> shift;
        }
        carry = *g & 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Stream;

    fn noise(nx: usize, ny: usize, fill: f64, seed: u64) -> Bitmap {
        let mut stream = Stream::new(seed, "bitmap");
        let mut map = Bitmap::new(nx, ny);
        for j in 0..ny {
            for i in 0..nx {
                if stream.chance(fill) {
                    map.set(i, j);
                }
            }
        }
        map
    }

    #[test]
    fn erosion_equals_the_plain_definition() {
        for (seed, radius) in [(1, 1.0), (2, 1.5), (3, 2.0), (4, 3.3), (5, 6.0), (6, 7.0)] {
            let map = noise(150, 40, 0.99, seed);
            let eroded = map.eroded(radius);
            for j in 0..40_i64 {
                for i in 0..150_i64 {
                    let r = radius.ceil() as i64;
                    let whole = (-r..=r).all(|dy| {
                        (-r..=r).all(|dx| {
                            let far = ((dx * dx + dy * dy) as f64).sqrt() >= radius;
                            let (x, y) = (i + dx, j + dy);
                            far || (x >= 0 && y >= 0 && map.get(x as usize, y as usize))
                        })
                    });
                    assert_eq!(eroded.get(i as usize, j as usize), whole, "radius {radius} at {i} {j}");
                }
            }
        }
    }

    #[test]
    fn maximal_rectangles_are_those_of_the_plain_definition() {
        for seed in 0..40 {
            let map =
                noise(5 + seed as usize * 4 % 140, 1 + seed as usize % 11, [0.5, 0.8, 0.95][seed as usize % 3], seed);
            let full = |[i0, i1, j0, j1]: [usize; 4]| (j0..j1).all(|j| (i0..i1).all(|i| map.get(i, j)));
            let grown = |[i0, i1, j0, j1]: [usize; 4]| {
                let sides = [
                    (i0 > 0).then(|| [i0 - 1, i1, j0, j1]),
                    (i1 < map.nx()).then_some([i0, i1 + 1, j0, j1]),
                    (j0 > 0).then(|| [i0, i1, j0 - 1, j1]),
                    (j1 < map.ny()).then_some([i0, i1, j0, j1 + 1]),
                ];
                sides.into_iter().flatten().any(full)
            };
            let mut plain = Vec::new();
            for j0 in 0..map.ny() {
                for j1 in j0 + 1..=map.ny() {
                    let columns: Vec<bool> = (0..map.nx()).map(|i| full([i, i + 1, j0, j1])).collect();
                    for run in columns.iter().enumerate().collect::<Vec<_>>().chunk_by(|a, b| a.1 == b.1) {
                        let rect = [run[0].0, run[0].0 + run.len(), j0, j1];
                        if *run[0].1 && !grown(rect) {
                            plain.push(rect);
                        }
                    }
                }
            }
            assert_eq!(map.maximal_rectangles(), plain, "seed {seed}");
        }
    }

    #[test]
    fn components_split_the_set_by_edges() {
        let map = noise(130, 60, 0.6, 9);
        let parts = map.components();
        assert_eq!(parts.iter().map(Bitmap::count).sum::<usize>(), map.count());
        for part in &parts {
            for (i, j) in part.cells() {
                for (x, y) in [(i + 1, j), (i, j + 1)] {
                    assert_eq!(map.get(x, y), part.get(x, y), "a neighbor of {i} {j} is in another part");
                }
            }
        }
        assert!(parts.windows(2).all(|p| p[0].count() >= p[1].count()));
        assert_eq!(map.largest().as_ref(), parts.first());
    }

    #[test]
    fn pieces_around_a_block_are_counted_once_around() {
        let mut map = Bitmap::new(90, 20);
        map.fill(0, 90, 0, 20, true);
        assert_eq!(map.pieces_around(60, 70, 5, 12), 1);
        map.fill(0, 90, 8, 9, false);
        assert_eq!(map.pieces_around(60, 70, 5, 12), 2);
        assert_eq!(map.pieces_around(60, 70, -1, 5), 1);
        map.fill(0, 90, 0, 20, false);
        assert_eq!(map.pieces_around(60, 70, 5, 12), 0);
    }

    #[test]
    fn pieces_around_are_those_of_a_walk() {
        let map = noise(150, 40, 0.6, 7);
        let on = |i: i64, j: i64| i >= 0 && j >= 0 && map.get(i as usize, j as usize);
        for (i0, i1, j0, j1) in [(3, 70, 2, 30), (-2, 64, -1, 9), (63, 151, 20, 44), (60, 62, 5, 7), (-9, 0, 0, 50)] {
            let south = (i0..i1 - 1).map(|i| (i, j0)).chain((j0..j1 - 1).map(|j| (i1 - 1, j)));
            let north = (i0 + 1..i1).rev().map(|i| (i, j1 - 1)).chain((j0 + 1..j1).rev().map(|j| (i0, j)));
            let walk: Vec<bool> = south.chain(north).map(|(i, j)| on(i, j)).collect();
            let starts = (0..walk.len()).filter(|&k| walk[k] && !walk[(k + walk.len() - 1) % walk.len()]).count();
            assert_eq!(map.pieces_around(i0, i1, j0, j1), starts, "{i0} {i1} {j0} {j1}");
        }
    }

    #[test]
    fn a_window_has_the_cells_of_its_part() {
        let (map, other) = (noise(200, 30, 0.5, 3), noise(200, 30, 0.5, 4));
        for (i0, i1, j0, j1) in [(0, 200, 0, 30), (64, 128, 3, 9), (7, 150, -4, 12), (130, 400, 20, 99), (9, 9, 0, 5)] {
            let window = map.window(i0, i1, j0, j1);
            let (x, y) = (i0.max(0) as usize, j0.max(0) as usize);
            let within = |&(i, j): &(usize, usize)| (i0..i1).contains(&(i as i64)) && (j0..j1).contains(&(j as i64));
            let cells: Vec<_> = map.cells().filter(within).map(|(i, j)| (i - x, j - y)).collect();
            assert_eq!(window.cells().collect::<Vec<_>>(), cells, "{i0} {i1} {j0} {j1}");
            let common = map.cells().filter(within).filter(|&(i, j)| other.get(i, j)).count();
            assert_eq!(map.count_common_in(&other, i0, i1, j0, j1), common);
        }
    }

    #[test]
    fn fill_and_any_in_are_clipped() {
        let mut map = Bitmap::new(70, 5);
        map.fill(-3, 200, 1, 2, true);
        assert_eq!(map.count(), 70);
        assert!(map.any_in(60, 66, 0, 9) && !map.any_in(60, 66, 2, 9));
        map.fill(10, 65, -4, 40, false);
        assert_eq!(map.count(), 15);
        let counted = map.clone();
        map.set(30, 1);
        assert_eq!(map.remove_counting(5, 68, 1, 9, &counted), 8);
        assert_eq!(map.count(), 7);
    }
}
