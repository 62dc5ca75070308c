//! `d3dgen knowledge search`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::Ordering;

use d3dgen_knowledge::database::{Answer, Found, SearchQuery, Searcher};
use d3dgen_knowledge::glossary::Glossary;
use d3dgen_knowledge::{jurisdiction, phrase};
use d3dgen_store::index::{Mode, Progress, Watch};

use crate::database::embedder;
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::registry::{RegistryArgs, domain};
use crate::remote::{self, ServerArgs};

/// Arguments.
#[derive(clap::Args, Default)]
pub struct Args {
    /// What to find, in any words; without, everything that the filters leave
    #[arg(value_name = "WORDS")]
    words: Vec<String>,
    /// Only this domain; may be given more than once, as every filter
    #[arg(long, value_name = "ID")]
    domain: Vec<String>,
    /// Only rules that apply in this country: its own, its region's and international ones
    #[arg(long, value_name = "CODE")]
    country: Option<String>,
    /// Only rules of this jurisdiction (DE, US-NC, EU, INT, LOCAL)
    #[arg(long, value_name = "CODE")]
    jurisdiction: Vec<String>,
    /// Only this topic (room_size, fire_safety_evacuation, ...)
    #[arg(long)]
    topic: Vec<String>,
    /// Only rules on this room type of a domain, under whatever name they call it
    #[arg(long, value_name = "ID")]
    room_type: Vec<String>,
    /// Only this kind (minimum, maximum, range, ratio, table, recommendation, rule_of_thumb)
    #[arg(long = "type", value_name = "KIND")]
    constraint_type: Vec<String>,
    /// Only figures in this unit (m, m^2, lx, ...)
    #[arg(long)]
    unit: Vec<String>,
    /// Only this confidence (high, medium, low)
    #[arg(long)]
    confidence: Vec<String>,
    /// Only this type of source (regulation, standard, guideline, ...)
    #[arg(long, value_name = "TYPE")]
    source_type: Vec<String>,
    /// Least figure, in the rule's unit
    #[arg(long, value_name = "FIGURE", allow_negative_numbers = true)]
    min: Option<f64>,
    /// Largest figure, in the rule's unit
    #[arg(long, value_name = "FIGURE", allow_negative_numbers = true)]
    max: Option<f64>,
    /// Most rules to print
    #[arg(long, default_value_t = 10, value_name = "N")]
    limit: usize,
    /// How to find: by words, by meaning, or both
    #[arg(long, default_value = "hybrid", value_parser = ["hybrid", "text", "vector"])]
    mode: String,
    /// Print one JSON line for each rule
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
    #[command(flatten)]
    server: ServerArgs,
}

/// Values by filter: one of each must be the rule's.
type Filters = BTreeMap<String, BTreeSet<String>>;

impl Args {
    /// Returns a search by words and by meaning in the database here.
    pub fn of(
        words: String,
        country: Option<String>,
        domain: Option<String>,
        limit: usize,
        registry: RegistryArgs,
    ) -> Self {
        let (words, domain) = (vec![words], domain.into_iter().collect());
        Self { words, country, domain, limit, registry, ..Self::default() }
    }

    pub fn run(self) -> Result<(), Error> {
        if let Some(remote) = self.server.instead_of(&self.registry)? {
            if !self.room_type.is_empty() {
                return Err(Error::Input(
                    "--room-type and --server: a server finds rules by words; give the room among them".into(),
                ));
            }
            let there = remote::knowledge::filter_values(&remote)?;
            let filters = self.filters(&|name| there.get(name).cloned().unwrap_or_default())?;
            return self.print(&remote::knowledge::search(&remote, &self.query(filters))?);
        }
        self.print(&self.answer()?)
    }

    /// Returns the rules that the database here has for it.
    ///
    /// # Errors
    /// `Input` for a filter that no rule meets; `Knowledge`; `Interrupted`.
    pub fn answer(&self) -> Result<Answer, Error> {
        let registry = self.registry.load_as_brought()?;
        let database = self.registry.store.read(&registry)?;
        let searcher = open(&database)?;
        let mut filters = self.filters(&|name| searcher.values(name).into_keys().map(|v| v.to_string()).collect())?;
        if !self.room_type.is_empty() {
            let among = |id: &String| self.domain.is_empty() || self.domain.contains(id);
            let mut spaces = BTreeSet::new();
            for plugin in registry.iter().filter(|p| among(&p.id().to_owned())) {
                spaces.extend(self.room_type.iter().flat_map(|t| searcher.spaces_of(t, plugin.domain())));
            }
            for id in &self.domain {
                domain(&registry, id)?;
            }
            filters.insert("space_type".into(), spaces);
        }
        let glossary = Glossary::of(registry.iter().map(|p| p.domain()));
        Ok(searcher.answer(&self.query(filters), &glossary)?)
    }

    /// Returns what every rule must be, by filter; `values` are those that the rules have.
    fn filters(&self, values: &dyn Fn(&str) -> BTreeSet<String>) -> Result<Filters, Error> {
        let mut filters = Filters::new();
        for (name, asked) in [
            ("domain", &self.domain),
            ("jurisdiction", &self.jurisdiction),
            ("topic", &self.topic),
            ("constraint_type", &self.constraint_type),
            ("unit", &self.unit),
            ("confidence", &self.confidence),
            ("source_type", &self.source_type),
        ] {
            if asked.is_empty() {
                continue;
            }
            known(&values(name), name, asked)?;
            filters.insert(name.to_owned(), asked.iter().cloned().collect());
        }
        if let Some(country) = &self.country {
            let places: BTreeSet<String> = jurisdiction::chain(Some(country)).into_iter().collect();
            let asked = filters.remove("jurisdiction");
            filters.insert(
                "jurisdiction".into(),
                asked.map_or(places.clone(), |a| a.intersection(&places).cloned().collect()),
            );
        }
        Ok(filters)
    }

    fn query(&self, filters: Filters) -> SearchQuery {
        let mode = match self.mode.as_str() {
            "text" => Mode::Text,
            "vector" => Mode::Vector,
            _ => Mode::Hybrid,
        };
        SearchQuery { text: self.words.join(" "), filters, value: (self.min, self.max), limit: self.limit, mode }
    }

    fn print(&self, Answer { found, note }: &Answer) -> Result<(), Error> {
        if let Some(note) = note {
            eprintln!("{note}");
        }
        if self.json {
            return write_text(None, &found.iter().map(|f| format!("{}\n", json(f))).collect::<String>());
        }
        if found.is_empty() && note.is_none() {
            eprintln!("nothing fits; `knowledge search` without words lists what the filters leave");
        }
        write_text(None, &found.iter().map(shown).collect::<String>())
    }
}

/// Opens the index, with progress when it has to be made.
fn open(database: &d3dgen_knowledge::database::Database) -> Result<Searcher, Error> {
    interrupt::listen();
    let progress = crate::progress::Progress::of(1);
    let report = |p: Progress| progress.doing(&format!("indexing: {} of {}", p.done, p.total));
    let cancel = || interrupt::flag().load(Ordering::SeqCst);
    let searcher = Searcher::open(database, embedder()?, Watch { progress: &report, cancel: &cancel });
    progress.finish();
    let searcher = searcher?;
    if let Some(reason) = &searcher.rebuilt {
        eprintln!("index made anew: {reason}");
    }
    if let Some(reason) = &searcher.unsaved {
        eprintln!("warning: the index could not be kept: {reason}");
    }
    for damage in &searcher.damaged {
        eprintln!("warning: left out {}: {}", damage.place, damage.reason);
    }
    Ok(searcher)
}

/// Refuses a filter value that no rule has, with those there are.
fn known(there: &BTreeSet<String>, filter: &str, values: &[String]) -> Result<(), Error> {
    match values.iter().find(|v| !there.contains(*v)) {
        None => Ok(()),
        Some(value) => {
            let names: Vec<&str> = there.iter().map(String::as_str).collect();
            let flag = if filter == "constraint_type" { "type".into() } else { filter.replace('_', "-") };
            Err(Error::Input(format!("--{flag} {value}: no rule has it; there are {}", names.join(", "))))
        }
    }
}

/// Returns a rule that was found as data.
pub fn json(f: &Found) -> serde_json::Value {
    serde_json::json!({
        "domain": f.domain, "jurisdiction": f.jurisdiction, "ref_id": f.ref_id, "source": f.source,
        "constraint": f.constraint, "score": f.hit.score, "text_rank": f.hit.text_rank,
        "vector_rank": f.hit.vector_rank, "copies": f.copies,
    })
}

/// Returns a rule that was found in lines.
pub fn shown(f: &Found) -> String {
    let source = f.source.as_ref().map(|s| format!("{} ({}, {})", s.title, s.publisher, s.edition_or_year));
    format!(
        "{}\n    {} {}; {}, {} confidence\n    {}/{}\n",
        phrase::sentence(&f.constraint),
        f.jurisdiction,
        source.unwrap_or_default(),
        f.source.as_ref().map_or("", |s| s.source_type.as_str()),
        f.constraint.confidence,
        f.domain,
        f.constraint.constraint_id,
    )
}
