//! `d3dgen knowledge retrieve`: from room labels to the rules of the building, as limits and as sentences.

use std::collections::BTreeMap;

use d3dgen_knowledge::classify::{Building, Classified, classify, ties};
use d3dgen_knowledge::{Limit, Policy, Retrieval, phrase, retrieve_with};
use d3dgen_model::domain::Domain;
use d3dgen_model::scene_graph::Robot;

use crate::error::Error;
use crate::input::write_text;
use crate::registry::{RegistryArgs, domain};
use crate::table::table;

/// Height of a robot of which only the radius is known, m; no rule of the shipped domains asks for it.
const ROBOT_HEIGHT_M: f64 = 1.2;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Labels of the rooms at hand, in any language the domains know: "patient room, Flur, staff WC"
    #[arg(long, value_name = "LABELS", value_delimiter = ',', required = true)]
    rooms: Vec<String>,
    /// Kind of building; otherwise told from the labels
    #[arg(long, value_name = "ID")]
    domain: Option<String>,
    /// Where it stands, as an ISO 3166 code (DE, US-NC); without, international rules only
    #[arg(long, value_name = "CODE")]
    country: Option<String>,
    /// People in the building at a time; otherwise reckoned from usual areas
    #[arg(long, value_name = "N")]
    persons: Option<u32>,
    /// Wheelchair access is asked for
    #[arg(long)]
    accessible: bool,
    /// Somebody in a wheelchair lives or works there: more than access without steps
    #[arg(long)]
    wheelchair: bool,
    /// Radius in m of the robots that work there
    #[arg(long, value_name = "M")]
    robot_radius: Option<f64>,
    /// Which source of one jurisdiction is kept when they contradict each other: strictest, newest, or preferred
    #[arg(long, default_value = "strictest", value_parser = ["strictest", "newest", "preferred"])]
    policy: String,
    /// Words of the titles to prefer, in their order; for --policy preferred
    #[arg(long, value_name = "WORDS", value_delimiter = ',', required_if_eq("policy", "preferred"))]
    prefer: Vec<String>,
    /// Print only the sentences, for a prompt
    #[arg(long, conflicts_with = "json")]
    bullets: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load()?;
        let domains: Vec<&Domain> = match &self.domain {
            Some(id) => vec![domain(&registry, id)?.domain()],
            None => registry.iter().map(|p| p.domain()).collect(),
        };
        let labels: Vec<String> = self.rooms.iter().map(|l| l.trim().to_owned()).filter(|l| !l.is_empty()).collect();
        let readings = classify(&labels, &domains);
        let others: Vec<String> = ties(&readings).iter().map(|r| r.domain.clone()).collect();
        let Some(reading) = readings.into_iter().next().filter(|r| r.score > 0.0) else {
            return Err(Error::Input(format!(
                "no domain knows any of these rooms, or they are of no kind: {}",
                labels.join(", ")
            )));
        };
        if let Some(code) = &self.country
            && !d3dgen_model::knowledge::is_jurisdiction(&code.to_ascii_uppercase())
        {
            return Err(Error::Input(format!("--country {code}: no ISO 3166 code like DE or US-NC")));
        }
        let plugin = domain(&registry, &reading.domain)?;
        let building = self.building(&reading);
        let policy = match self.policy.as_str() {
            "newest" => Policy::Newest,
            "preferred" => Policy::Preferred(self.prefer.clone()),
            _ => Policy::Strictest,
        };
        let found = retrieve_with(plugin.knowledge(), &building.query(plugin.domain()), &policy);
        let text = if self.json {
            format!("{}\n", json(&reading, &others, &found, &policy))
        } else if self.bullets {
            phrase::bullets(&found).iter().map(|b| format!("{b}\n")).collect()
        } else {
            shown(&reading, &others, &found, &policy)
        };
        if !others.is_empty() && (self.json || self.bullets) {
            eprintln!("{}", tied(&others));
        }
        write_text(None, &text)
    }

    fn building(&self, reading: &Classified) -> Building {
        let mut rooms: BTreeMap<String, u32> = BTreeMap::new();
        for id in reading.rooms.iter().filter_map(|(_, t)| t.clone()) {
            *rooms.entry(id).or_insert(0) += 1;
        }
        let robot = self.robot_radius.map(|radius_m| Robot {
            kind: "service".into(),
            count: 1,
            radius_m,
            height_m: ROBOT_HEIGHT_M,
            body: None,
            charging: true,
            stops: Vec::new(),
            room_types: Vec::new(),
            misfit: false,
        });
        Building {
            country_code: self.country.as_ref().map(|c| c.to_ascii_uppercase()),
            building_type: reading.building_type.clone(),
            accessible: self.accessible || self.wheelchair,
            wheelchair: self.wheelchair,
            rooms,
            persons: self.persons,
            robots: robot.into_iter().collect(),
        }
    }
}

/// Returns the figures that plans keep: what, for which rooms, how much, by which rule.
fn limits(found: &Retrieval) -> Vec<(String, String, f64, &'static str, String)> {
    let mut out = Vec::new();
    let mut add = |place: &str, what: &str, unit: &'static str, limit: &Option<Limit>| {
        if let Some(limit) = limit {
            out.push((place.to_owned(), what.to_owned(), limit.value, unit, limit.constraint_id.clone()));
        }
    };
    let limits = &found.limits;
    add("circulation", "clear width", "m", &limits.corridor_width);
    add("entrance", "clear width of the door", "m", &limits.entrance_width);
    for (room, of_it) in &limits.rooms {
        add(room, "least area", "m^2", &of_it.area_min);
        add(room, "largest area", "m^2", &of_it.area_max);
        add(room, "least extent", "m", &of_it.dimension_min);
        add(room, "clear width of the door", "m", &of_it.door_width);
        add(room, "clear height", "m", &of_it.ceiling_height_min);
    }
    out
}

fn json(reading: &Classified, others: &[String], found: &Retrieval, policy: &Policy) -> serde_json::Value {
    let rooms: BTreeMap<&str, Option<&str>> = reading.rooms.iter().map(|(l, t)| (l.as_str(), t.as_deref())).collect();
    let limits: Vec<serde_json::Value> = limits(found)
        .into_iter()
        .map(|(place, what, value, unit, id)| {
            serde_json::json!({"place": place, "what": what, "value": value, "unit": unit, "constraint_id": id})
        })
        .collect();
    let conflicts: Vec<serde_json::Value> = found
        .conflicts
        .iter()
        .map(|c| serde_json::json!({"space_type": c.space_type, "kept": c.kept, "against": c.against, "by": c.by}))
        .collect();
    let constraints: Vec<serde_json::Value> = found
        .constraints
        .iter()
        .map(|a| {
            serde_json::json!({
                "constraint": a.constraint, "ref_id": a.ref_id, "citation": a.citation, "mandatory": a.mandatory,
                "superseded_by": a.superseded_by, "decidable": a.decision.is_ok(),
                "not_decidable_because": a.decision.as_ref().err(), "sentence": phrase::sentence(&a.constraint),
            })
        })
        .collect();
    serde_json::json!({
        "domain": reading.domain, "building_type": reading.building_type, "score": reading.score, "ties": others, "rooms": rooms,
        "jurisdictions": found.jurisdictions, "policy": policy.name(), "limits": limits, "conflicts": conflicts,
        "constraints": constraints, "not_applicable": found.not_applicable,
    })
}

/// Returns a line on the kinds of building that the rooms fit as well.
fn tied(others: &[String]) -> String {
    format!("the rooms fit {} as well: --domain chooses", others.join(", "))
}

fn shown(reading: &Classified, others: &[String], found: &Retrieval, policy: &Policy) -> String {
    let kind = reading.building_type.as_ref().map(|b| format!(", most like {b}")).unwrap_or_default();
    let rooms: Vec<String> = reading
        .rooms
        .iter()
        .map(|(label, t)| {
            t.as_ref().map_or_else(|| format!("{label} (not known, left out)"), |t| format!("{label} = {t}"))
        })
        .collect();
    let rows: Vec<Vec<String>> = limits(found)
        .into_iter()
        .map(|(place, what, value, unit, id)| vec![place, what, value.to_string(), unit.to_owned(), id])
        .collect();
    let also = if others.is_empty() { String::new() } else { format!("               {}\n", tied(others)) };
    let mut text = format!(
        "building       {}{kind}\n{also}rooms          {}\njurisdictions  {}\ncontradictions settled by nearest jurisdiction, then {}\n\n",
        reading.domain,
        rooms.join(", "),
        found.jurisdictions.join(" > "),
        policy.name(),
    );
    text += &table(&["limit for", "of", "figure", "unit", "by"], &rows);
    let rows: Vec<Vec<String>> =
        found.conflicts.iter().map(|c| vec![c.kept.clone(), c.against.clone(), c.by.to_owned()]).collect();
    if !rows.is_empty() {
        text += &format!("\n{}", table(&["kept", "rather than", "by"], &rows));
    }
    text += &format!("\n{} rules apply, {} do not\n", found.constraints.len(), found.not_applicable);
    text + &phrase::bullets(found).iter().map(|b| format!("{b}\n")).collect::<String>()
}
