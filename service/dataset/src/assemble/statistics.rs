//! What the card says of all worlds: counts, spreads, plots.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::row::{Failure, Row, Why};

/// Figures of the card, with their heading.
const NUMBERS: &[(&str, &str)] = &[
    ("rooms", "rooms"),
    ("net_area_m2", "net floor area, m²"),
    ("objects", "objects"),
    ("doors", "doors"),
    ("circulation_share", "share of circulation"),
    ("constraints_satisfied", "constraints satisfied"),
    ("constraints_violated", "constraints violated"),
];
/// Bars of a histogram, most bars of a count, and bars shown of the largest counts.
const BINS: usize = 16;
const MOST_BARS: usize = 24;

/// Counts and figures of the worlds of a data set.
#[derive(Debug, Default)]
pub struct Statistics {
    /// Worlds by split.
    pub splits: BTreeMap<String, u64>,
    kinds: BTreeMap<String, u64>,
    countries: BTreeMap<String, u64>,
    rules: BTreeMap<String, u64>,
    failures: BTreeMap<Why, u64>,
    numbers: BTreeMap<&'static str, Vec<f64>>,
    /// Worlds.
    pub worlds: u64,
    /// Bytes of their files.
    pub bytes: u64,
}

impl Statistics {
    /// Counts a world.
    pub fn add(&mut self, row: &Row, split: &str, bytes: u64) {
        self.worlds += 1;
        self.bytes += bytes;
        *self.splits.entry(split.to_owned()).or_default() += 1;
        let kind = row.kind.clone().unwrap_or_else(|| row.domain.clone());
        *self.kinds.entry(kind).or_default() += 1;
        *self.countries.entry(row.country.clone().unwrap_or_else(|| "none".into())).or_default() += 1;
        for rule in &row.violated {
            *self.rules.entry(rule.clone()).or_default() += 1;
        }
        for (name, _) in NUMBERS {
            let value = if *name == "rooms" { Some(f64::from(row.rooms)) } else { row.figures.get(*name).copied() };
            self.numbers.entry(name).or_default().extend(value);
        }
    }

    /// Counts a task that came to no world.
    pub fn miss(&mut self, failure: &Failure) {
        *self.failures.entry(failure.why).or_default() += 1;
    }

    /// Returns how many tasks came to no world.
    pub fn missed(&self) -> u64 {
        self.failures.values().sum()
    }

    /// Puts the figures in order, so that what is said of them depends on no other.
    pub fn sort(&mut self) {
        self.numbers.values_mut().for_each(|values| values.sort_by(f64::total_cmp));
    }

    /// Returns the tables of the card, in Markdown.
    pub fn tables(&self) -> String {
        let mut text = String::from("| figure | least | 5 % | median | 95 % | most |\n|---|---|---|---|---|---|\n");
        for (name, title) in NUMBERS {
            let Some(values) = self.numbers.get(name).filter(|v| !v.is_empty()) else { continue };
            let at = |share: f64| round(values[((values.len() - 1) as f64 * share).round() as usize]);
            let _ =
                writeln!(text, "| {title} | {} | {} | {} | {} | {} |", at(0.0), at(0.05), at(0.5), at(0.95), at(1.0));
        }
        if !self.failures.is_empty() {
            text += "\n| tasks without a world | count |\n|---|---|\n";
            for (why, count) in &self.failures {
                let _ = writeln!(text, "| {} | {count} |", why.name());
            }
        }
        if !self.rules.is_empty() {
            text += "\n| constraint that is most often not kept (advice, or what no plan of the request allows) | worlds |\n|---|---|\n";
            for (rule, count) in largest(&self.rules, 8) {
                let _ = writeln!(text, "| `{rule}` | {count} |");
            }
        }
        text
    }

    /// Returns the plots: file name, what it shows, picture.
    pub fn plots(&self) -> Vec<(String, String, String)> {
        let mut plots = Vec::new();
        for (name, title) in NUMBERS.iter().take(3) {
            let Some(values) = self.numbers.get(name).filter(|v| !v.is_empty()) else { continue };
            plots.push((format!("{name}.svg"), (*title).to_owned(), bars(title, &histogram(values))));
        }
        let counts = [
            ("kinds", "kinds of building", &self.kinds),
            ("countries", "countries", &self.countries),
            ("splits", "splits", &self.splits),
        ];
        for (name, title, counts) in counts {
            plots.push((format!("{name}.svg"), title.to_owned(), bars(title, &largest(counts, MOST_BARS))));
        }
        plots
    }
}

fn largest(counts: &BTreeMap<String, u64>, most: usize) -> Vec<(String, u64)> {
    let mut sorted: Vec<(String, u64)> = counts.iter().map(|(name, n)| (name.clone(), *n)).collect();
    sorted.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    sorted.truncate(most);
    sorted
}

/// Returns the counts of sorted values in equal steps; whole numbers of few values have a bar each.
fn histogram(values: &[f64]) -> Vec<(String, u64)> {
    let (least, most) = (values[0], values[values.len() - 1]);
    let whole = values.iter().all(|v| v.fract() == 0.0) && most - least < MOST_BARS as f64;
    let (step, bins) =
        if whole { (1.0, (most - least) as usize + 1) } else { (((most - least) / BINS as f64).max(1e-9), BINS) };
    let mut counts = vec![0; bins];
    for value in values {
        counts[(((value - least) / step) as usize).min(bins - 1)] += 1;
    }
    let label = |i: usize| round(least + i as f64 * step);
    counts.into_iter().enumerate().map(|(i, n)| (label(i), n)).collect()
}

fn round(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Draws bars, the labels left of them and the counts at their ends.
fn bars(title: &str, counts: &[(String, u64)]) -> String {
    const ROW: f64 = 18.0;
    const LEFT: f64 = 150.0;
    const WIDTH: f64 = 330.0;
    let most = counts.iter().map(|c| c.1).max().unwrap_or(1).max(1) as f64;
    let height = 34.0 + ROW * counts.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 560 {height}\" width=\"560\" height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"560\" height=\"{height}\" fill=\"#fff\"/>\n<text x=\"8\" y=\"18\" font-weight=\"bold\">{}</text>\n",
        escaped(title)
    );
    for (i, (label, count)) in counts.iter().enumerate() {
        let y = 28.0 + ROW * i as f64;
        let width = WIDTH * *count as f64 / most;
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text><rect x=\"{LEFT}\" y=\"{y}\" width=\"{width:.1}\" height=\"13\" fill=\"#4878a8\"/><text x=\"{:.1}\" y=\"{}\" fill=\"#555\">{count}</text>",
            LEFT - 6.0,
            y + 11.0,
            escaped(label),
            LEFT + width + 5.0,
            y + 11.0
        );
    }
    svg + "</svg>\n"
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
