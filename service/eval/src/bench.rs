//! The paper's benchmark: 450 worlds of a fixed list of prompts, and the paper's figures to print beside ours.
//!
//! The prompts are in `data/paper_prompts.toml`, the paper's figures with their source in `data/paper_figures.toml`.

use serde::Deserialize;

use crate::Error;
use crate::evaluation::Evaluation;

/// Ten prompts of a domain with a number of rooms.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Domain id.
    pub domain: String,
    /// Number of rooms that every prompt asks for.
    pub rooms: u32,
    /// The prompts.
    pub prompts: Vec<String>,
}

/// A world to be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Task {
    /// Domain id.
    pub domain: String,
    /// Number of rooms in the prompt.
    pub rooms: u32,
    /// The prompt.
    pub prompt: String,
    /// Seed.
    pub seed: u64,
    /// Folder of the world: domain and rooms, then the number of the world.
    pub path: String,
}

/// The paper's figures.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Where they come from.
    pub source: String,
    /// Worlds by domain and number of rooms.
    pub worlds: Vec<PublishedRow>,
    /// Objects by room of each domain.
    pub density: Vec<PublishedDensity>,
}

/// A row of the paper's table of worlds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedRow {
    /// Domain id.
    pub domain: String,
    /// Number of rooms.
    pub rooms: u32,
    /// Mean number of objects.
    pub objects: f64,
    /// Mean number of doors.
    pub doors: f64,
    /// Mean floor area, m^2.
    pub floor_area_m2: f64,
}

/// Objects by room of a domain.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedDensity {
    /// Domain id.
    pub domain: String,
    /// Least and largest mean.
    pub objects_per_room: [f64; 2],
}

/// A table with its heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// Headings.
    pub header: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

/// Returns the prompts by case, in order of domain and rooms as in the paper.
///
/// # Errors
/// `Data` when the list of this release is broken.
pub fn cases() -> Result<Vec<Case>, Error> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct List {
        cases: Vec<Case>,
    }
    let file = "paper_prompts.toml";
    let list: List = toml::from_str(include_str!("../data/paper_prompts.toml"))
        .map_err(|e| Error::Data { file, reason: e.to_string() })?;
    Ok(list.cases)
}

/// Returns the paper's figures.
///
/// # Errors
/// `Data` when the list of this release is broken.
pub fn published() -> Result<Published, Error> {
    let file = "paper_figures.toml";
    toml::from_str(include_str!("../data/paper_figures.toml")).map_err(|e| Error::Data { file, reason: e.to_string() })
}

/// Returns `each` worlds of every case: prompts in turn, the seed counted up when all have had one.
pub fn tasks(cases: &[Case], each: u32) -> Vec<Task> {
    let of_case = |case: &Case| {
        let count = case.prompts.len().max(1);
        let prompts = case.prompts.iter().cycle().take(each as usize).enumerate();
        let task = |(i, prompt): (usize, &String)| Task {
            domain: case.domain.clone(),
            rooms: case.rooms,
            prompt: prompt.clone(),
            seed: (i / count) as u64,
            path: format!("{}_{:02}/{i:03}", case.domain, case.rooms),
        };
        prompts.map(task).collect::<Vec<_>>()
    };
    cases.iter().flat_map(of_case).collect()
}

/// Returns the paper's two tables of worlds, each figure of ours beside its own.
pub fn tables(paper: &Published, ours: &Evaluation) -> [Table; 2] {
    let mean = |domain: &str, rooms: Option<u32>, name: &str| {
        let of = |g: &&crate::evaluation::Group| g.domain == domain && rooms.is_none_or(|r| g.rooms == Some(r));
        let groups: Vec<_> =
            ours.groups.iter().filter(of).filter_map(|g| Some((*g.figures.get(name)?, g.worlds))).collect();
        let worlds: u32 = groups.iter().map(|g| g.1).sum();
        (worlds > 0).then(|| groups.iter().map(|(v, n)| v * f64::from(*n)).sum::<f64>() / f64::from(worlds))
    };
    let text = |value: Option<f64>, digits: usize| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"));
    let percent = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| crate::figures::Form::Percent.text(v));
    let row = |p: &PublishedRow| {
        let of = |name| mean(&p.domain, Some(p.rooms), name);
        vec![
            p.domain.clone(),
            p.rooms.to_string(),
            text(Some(p.objects), 0),
            text(of("objects"), 1),
            text(Some(p.doors), 0),
            text(of("doors"), 1),
            text(Some(p.floor_area_m2), 0),
            text(of("floor_area_m2"), 0),
            percent(of("room_count_fidelity")),
            text(of("time_ms"), 0),
        ]
    };
    let words = |list: &[&str]| list.iter().map(|w| (*w).to_owned()).collect::<Vec<_>>();
    let counts = Table {
        title: format!("Worlds: objects, doors, floor area; the paper ({}) and ours", paper.source),
        header: words(&[
            "domain",
            "rooms",
            "objects paper",
            "ours",
            "doors paper",
            "ours",
            "m2 paper",
            "ours",
            "rooms exact",
            "time ms",
        ]),
        rows: paper.worlds.iter().map(row).collect(),
    };
    let density_row = |p: &PublishedDensity| {
        let [least, most] = p.objects_per_room;
        let published = if least == most { format!("{least}") } else { format!("{least}-{most}") };
        let of = |name| mean(&p.domain, None, name);
        vec![
            p.domain.clone(),
            published,
            text(of("objects_per_room"), 1),
            text(of("objects_per_m2"), 2),
            text(of("object_spacing_m"), 2),
            text(of("material_diversity_bit"), 2),
            text(of("walls"), 1),
        ]
    };
    let density = Table {
        title: "Furnishing: objects a room, the paper and ours; spacing and materials, ours".into(),
        header: words(&["domain", "a room paper", "ours", "a m2", "spacing m", "materials bit", "walls"]),
        rows: paper.density.iter().map(density_row).collect(),
    };
    [counts, density]
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_list_is_ninety_different_sentences_and_makes_450_worlds() {
        let cases = cases().expect("the file is in order");
        let prompts: BTreeSet<&str> = cases.iter().flat_map(|c| &c.prompts).map(String::as_str).collect();
        assert_eq!((cases.len(), prompts.len()), (9, 90));
        assert!(cases.iter().all(|c| c.prompts.len() == 10));
        let tasks = tasks(&cases, 50);
        assert_eq!(tasks.len(), 450);
        let paths: BTreeSet<&str> = tasks.iter().map(|t| t.path.as_str()).collect();
        let runs: BTreeSet<_> = tasks.iter().map(|t| (&t.prompt, t.seed)).collect();
        assert_eq!((paths.len(), runs.len()), (450, 450));
        assert_eq!(tasks.iter().filter(|t| t.domain == "office" && t.rooms == 8).count(), 50);
    }

    #[test]
    fn our_figures_stand_beside_those_of_the_paper() {
        let paper = published().expect("the file is in order");
        assert_eq!((paper.worlds.len(), paper.density.len()), (9, 3));
        let mut world = crate::sample::world();
        world.scene_graph.domain = "office".into();
        let known = crate::Known { rooms_asked: Some(5), ..Default::default() };
        let measured = crate::measure(&world, None, "a", &known);
        let [counts, density] = tables(&paper, &crate::compare::evaluation(vec![measured], &[], Vec::new()));
        let row = counts.rows.iter().find(|r| r[0] == "office" && r[1] == "5").expect("the paper has it");
        assert_eq!(row[2..], ["45", "5.0", "6", "2.0", "287", "21", "0 %", "-"].map(str::to_owned));
        assert!(counts.rows.iter().any(|r| r[0] == "hospital" && r[3] == "-"), "no world, no figure");
        assert_eq!(density.rows.iter().find(|r| r[0] == "office").map(|r| r[2].as_str()), Some("2.5"));
        assert!(counts.rows.iter().all(|r| r.len() == counts.header.len()));
        assert!(density.rows.iter().all(|r| r.len() == density.header.len()));
    }
}
