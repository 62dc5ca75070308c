//! An evaluation as one web page: tables and plans, nothing loaded, no scripts.

use std::fmt::Write;

use crate::evaluation::{Evaluation, WorldMeasures};
use crate::figures::{FIGURES, Figure};

const STYLE: &str = include_str!("../data/page.css");

/// The plan of a world, by its position in the evaluation.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Index into `worlds`.
    pub world: usize,
    /// What [`crate::picture::svg`] drew.
    pub svg: String,
}

/// Tables by heading, and the names of their figures.
const TABLES: [(&str, &[&str]); 3] = [
    (
        "The paper's measures",
        &[
            "objects",
            "objects_per_room",
            "objects_per_m2",
            "doors",
            "walls",
            "floor_area_m2",
            "object_spacing_m",
            "material_diversity_bit",
            "room_count_fidelity",
        ],
    ),
    (
        "The field's measures",
        &["col", "col_scene", "oob", "sup", "nav", "nav_rooms", "acc", "oc_doors", "oc_doors_full", "oc_windows"],
    ),
    (
        "Further measures",
        &["adjacency", "public", "mandatory", "advice", "robots", "not_rectangular", "sound", "time_ms"],
    ),
];

/// Returns the text safe for HTML and SVG, in and between tags.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

/// Returns the page; worlds without a picture are in the tables only.
pub fn page(evaluation: &Evaluation, title: &str, pictures: &[Picture]) -> String {
    let title = escape(title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>{title}</title>\
         <style>{STYLE}</style></head><body><main><h1>{title}</h1>\n"
    );
    cards(&mut out, evaluation);
    for (heading, names) in TABLES {
        let figures = FIGURES.iter().filter(|f| names.contains(&f.name));
        groups(&mut out, evaluation, heading, figures);
    }
    broken(&mut out, evaluation);
    sources(&mut out, evaluation);
    diversity(&mut out, evaluation);
    distances(&mut out, evaluation);
    gallery(&mut out, evaluation, pictures);
    out + "</main></body></html>\n"
}

/// Writes the figures that decide, large.
fn cards(out: &mut String, evaluation: &Evaluation) {
    let Some(all) = evaluation.groups.last() else { return };
    out.push_str("<div class=\"cards\">");
    let mut card = |value: String, label: &str| {
        let _ = write!(out, "<div><b>{value}</b><span>{}</span></div>", escape(label));
    };
    card(all.worlds.to_string(), "worlds");
    for name in ["room_count_fidelity", "col", "oob", "sup", "nav", "oc_doors", "mandatory", "robots"] {
        let figure = FIGURES.iter().find(|f| f.name == name);
        if let Some((figure, value)) = figure.and_then(|f| Some((f, all.figures.get(name)?))) {
            card(figure.form.text(*value), figure.title);
        }
    }
    out.push_str("</div>\n");
}

fn table<'a>(out: &mut String, header: &[&str], rows: impl Iterator<Item = Vec<String>> + 'a) {
    out.push_str("<div class=\"wide\"><table><thead><tr>");
    header.iter().for_each(|h| {
        let _ = write!(out, "<th>{}</th>", escape(h));
    });
    out.push_str("</tr></thead><tbody>");
    for row in rows {
        out.push_str("<tr>");
        row.iter().for_each(|cell| {
            let number = cell.starts_with(|c: char| c.is_ascii_digit() || c == '-');
            let _ = write!(out, "<td{}>{}</td>", if number { " class=\"n\"" } else { "" }, escape(cell));
        });
        out.push_str("</tr>");
    }
    out.push_str("</tbody></table></div>\n");
}

fn groups<'f>(out: &mut String, evaluation: &Evaluation, heading: &str, figures: impl Iterator<Item = &'f Figure>) {
    let shown = evaluation.measured(figures);
    if shown.is_empty() {
        return;
    }
    let _ = writeln!(out, "<h2>{}</h2>", escape(heading));
    let (header, rows) = evaluation.group_table(&shown);
    table(out, &header, rows.into_iter());
    out.push_str("<dl>");
    for f in &shown {
        let _ = write!(out, "<dt>{}</dt><dd>{}</dd>", escape(f.title), escape(f.about));
    }
    out.push_str("</dl>\n");
}

fn broken(out: &mut String, evaluation: &Evaluation) {
    if evaluation.broken.is_empty() {
        return;
    }
    out.push_str("<h2>Files that could not be read</h2>\n");
    let rows = evaluation.broken.iter().map(|b| vec![b.path.clone(), b.message.clone()]);
    table(out, &["file", "problem"], rows);
}

fn sources(out: &mut String, evaluation: &Evaluation) {
    if evaluation.sources.is_empty() {
        return;
    }
    out.push_str("<h2>Constraints by source</h2>\n");
    let header = [
        "place",
        "source",
        "publisher",
        "force",
        "worlds",
        "satisfied",
        "violated",
        "not decidable",
        "kept",
        "violated most",
    ];
    let rows = evaluation.sources.iter().map(|s| {
        let t = &s.tally;
        let most: Vec<String> = s.violated.iter().take(3).map(|(name, n)| format!("{name} ({n})")).collect();
        vec![
            s.jurisdiction.clone(),
            s.title.clone(),
            s.publisher.clone(),
            if s.mandatory { "mandatory" } else { "advice" }.into(),
            s.worlds.to_string(),
            t.satisfied.to_string(),
            t.violated.to_string(),
            t.not_decidable.to_string(),
            t.satisfied_share().map_or_else(|| "-".into(), |v| crate::figures::Form::Percent.text(v)),
            most.join(", "),
        ]
    });
    table(out, &header, rows);
}

fn diversity(out: &mut String, evaluation: &Evaluation) {
    if evaluation.prompts.is_empty() {
        return;
    }
    out.push_str("<h2>Different plans of one prompt</h2>\n");
    let percent = |v: f64| crate::figures::Form::Percent.text(v);
    let rows = evaluation.prompts.iter().map(|p| {
        let shares = [p.adjacencies, p.geometries, p.plans].map(percent);
        [vec![p.domain.clone(), p.prompt.clone(), p.worlds.to_string()], shares.to_vec()].concat()
    });
    table(out, &["domain", "prompt", "worlds", "adjacencies", "geometries", "plans"], rows);
}

fn distances(out: &mut String, evaluation: &Evaluation) {
    let Some(first) = evaluation.distances.first() else { return };
    out.push_str("<h2>Distance of layout distributions</h2>\n");
    let header: Vec<&str> =
        ["one", "other", "mean"].into_iter().chain(first.features.keys().map(String::as_str)).collect();
    let rows = evaluation.distances.iter().map(|d| {
        let figures = std::iter::once(d.mean).chain(d.features.values().copied());
        [d.a.clone(), d.b.clone()].into_iter().chain(figures.map(|v| format!("{v:.2}"))).collect()
    });
    table(out, &header, rows);
}

fn gallery(out: &mut String, evaluation: &Evaluation, pictures: &[Picture]) {
    if pictures.is_empty() {
        return;
    }
    let _ = writeln!(out, "<h2>Plans ({} of {})</h2><div class=\"gallery\">", pictures.len(), evaluation.worlds.len());
    for picture in pictures {
        let Some(world) = evaluation.worlds.get(picture.world) else { continue };
        let _ = write!(
            out,
            "<figure>{}<figcaption><b>{}</b> {}<br>{}</figcaption></figure>",
            picture.svg,
            escape(&world.path),
            escape(&world.prompt),
            escape(&caption(world))
        );
    }
    out.push_str("</div>\n");
}

fn caption(w: &WorldMeasures) -> String {
    let mut text = format!(
        "{} rooms, {:.0} m2, {} objects, NAV {}",
        w.layout.rooms,
        w.layout.floor_area_m2,
        w.layout.objects,
        crate::figures::Form::Percent.text(w.navigability.house)
    );
    let faults = [
        ("in collision", w.collisions.pairs.len()),
        ("out of bounds", w.out_of_bounds.objects.len()),
        ("unsupported", w.support.unsupported.len()),
        ("before an opening", w.openings.blocked.len()),
        ("behind private rooms", w.navigability.behind_private.len()),
    ];
    for (what, count) in faults.into_iter().filter(|(_, n)| *n > 0) {
        let _ = write!(text, ", {count} {what}");
    }
    text
}

/// Returns which worlds to draw when not all can be: evenly from first to last, so from every group.
pub fn chosen(evaluation: &Evaluation, most: usize) -> Vec<usize> {
    let count = evaluation.worlds.len();
    if count <= most {
        return (0..count).collect();
    }
    let step = |k: usize| k * count / most.max(1);
    (0..most).map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::evaluation;
    use crate::measure::measure;
    use crate::sample;

    #[test]
    fn a_page_holds_tables_and_plans_and_loads_nothing() {
        let mut world = sample::world();
        world.scene_graph.prompt = "<script>alert(1)</script>".into();
        let worlds: Vec<_> = ["a", "b"].map(|p| measure(&world, None, p, &Default::default())).into();
        let picture = Picture { world: 0, svg: crate::picture::svg(&world, &worlds[0]) };
        let text = page(&evaluation(worlds, &[], Vec::new()), "Worlds", &[picture]);
        assert!(text.contains("<h1>Worlds</h1>") && text.contains("Plans (1 of 2)") && text.contains("&lt;script&gt;"));
        assert!(!text.contains("<script") && !text.contains("src=") && !text.contains("href="));
        assert_eq!(text.matches("<table>").count(), text.matches("</table>").count());
    }

    #[test]
    fn every_figure_is_in_a_table_once() {
        for figure in FIGURES {
            assert_eq!(TABLES.iter().filter(|(_, names)| names.contains(&figure.name)).count(), 1, "{}", figure.name);
        }
    }

    #[test]
    fn pictures_are_taken_evenly() {
        let worlds = (0..10).map(|i| measure(&sample::world(), None, &i.to_string(), &Default::default())).collect();
        let all = evaluation(worlds, &[], Vec::new());
        assert_eq!(chosen(&all, 3), [0, 3, 6]);
        assert_eq!(chosen(&all, 60).len(), 10);
        assert!(chosen(&all, 0).is_empty());
    }
}
