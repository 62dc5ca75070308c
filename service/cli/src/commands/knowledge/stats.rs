//! `d3dgen knowledge stats`: what the knowledge bases hold.

use d3dgen_knowledge::Stats;
use d3dgen_model::Document;

use crate::error::Error;
use crate::input::{write_lines, write_text};
use crate::registry::{RegistryArgs, domain};
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Only this domain, with the reasons why the other rules cannot be decided
    #[arg(long, value_name = "ID")]
    domain: Option<String>,
    /// Print one JSON line for each domain
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load()?;
        let plugins = match &self.domain {
            Some(id) => vec![domain(&registry, id)?],
            None => registry.iter().collect(),
        };
        let stats: Vec<Stats> =
            plugins.into_iter().map(|p| Stats::of(p.knowledge(), p.domain(), p.knowledge().to_json().len())).collect();
        if self.json { write_lines(&stats) } else { write_text(None, &shown(&stats, self.domain.is_some())) }
    }
}

/// Returns the table with a column for each domain, as the paper prints it.
fn shown(stats: &[Stats], reasons: bool) -> String {
    type Figure = fn(&Stats) -> String;
    let level = |s: &Stats, name: &str| s.confidence.get(name).copied().unwrap_or(0).to_string();
    let figures: [(&str, Figure); 9] = [
        ("references", |s| s.references.to_string()),
        ("constraints", |s| s.constraints.to_string()),
        ("constraints per reference", |s| format!("{:.2}", s.constraints_per_reference)),
        ("room types", |s| s.room_types.to_string()),
        ("type families", |s| s.type_families.to_string()),
        ("jurisdictions", |s| s.jurisdictions.to_string()),
        ("file size, kB", |s| format!("{:.0}", s.file_bytes as f64 / 1000.0)),
        ("share decided, %", |s| format!("{:.1}", s.share_decided * 100.0)),
        ("decided one way only, %", |s| {
            format!("{:.1}", s.decided_one_way as f64 / s.constraints.max(1) as f64 * 100.0)
        }),
    ];
    let mut header = vec![""];
    header.extend(stats.iter().map(|s| s.domain.as_str()));
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (name, figure) in figures {
        rows.push([vec![name.to_owned()], stats.iter().map(figure).collect()].concat());
    }
    for name in ["high", "medium", "low"] {
        let cells = stats.iter().map(|s| level(s, name)).collect();
        rows.push([vec![format!("confidence {name}")], cells].concat());
    }
    let mut text = table(&header, &rows);
    for s in stats.iter().filter(|_| reasons) {
        let mut reasons: Vec<(&String, &usize)> = s.not_decidable.iter().collect();
        reasons.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
        let rows: Vec<Vec<String>> = reasons.iter().map(|(why, n)| vec![n.to_string(), (*why).clone()]).collect();
        text += &format!("\n{}", table(&["rules", "not decidable because"], &rows));
    }
    text
}
