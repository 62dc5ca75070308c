//! Text that is no text, passages of several sentences, and what the evidence is.

use super::*;

/// Returns space, name, kind and figure of what is found, one line each.
fn lines(text: &str, lang: &str) -> Vec<String> {
    let findings = Extractor::shared().extract(text, lang);
    let said = |f: &Finding| {
        assert!(text.get(f.evidence.clone()).is_some_and(|e| !e.is_empty()), "{f:?}");
        let c = &f.constraint;
        format!("{} {} {:?} {}", c.space, c.name, c.constraint_type, &text[f.printed.clone()])
    };
    findings.iter().map(said).collect()
}

#[test]
fn nonsense_never_panics_and_costs_no_more_than_its_length() {
    let long = |piece: &str, bytes: usize| piece.repeat(bytes / piece.len() + 1);
    let pieces = [
        "1 m ",
        "🦀½ ",
        "\u{0}\u{1b}\u{7f}",
        "|1|m|\n",
        "|",
        "at least ",
        "5'-",
        "1:",
        "走廊1",
        "fünfund",
        "a",
        "9",
        "((",
        "not ",
        "İẞß 3 ",
        "- a:\n",
        "1 * n + ",
        "one per ",
        "corridor ",
        "between 1 and ",
    ];
    for (piece, lang) in pieces.iter().zip(["en", "de", "", "🦀"].into_iter().cycle()) {
        Extractor::shared().extract(&long(piece, 30_000), lang);
    }
    Extractor::shared().extract(&long(&pieces.concat(), 1_000_000), "en");
}

#[test]
fn a_wide_table_with_a_long_head_costs_no_more_than_its_length() {
    let head = "very long words ".repeat(20_000);
    let rows = "| corridor | 1.5 m |\n".repeat(20_000);
    let found = Extractor::shared().extract(&format!("| {head} | width |\n|---|---|\n{rows}"), "en");
    assert_eq!(found.len(), 20_000);
}

#[test]
fn evidence_and_figure_are_parts_of_the_text() {
    let text = "Größe egal. Türen müssen mindestens 0,9 m breit sein. Ende.";
    let findings = Extractor::shared().extract(text, "de");
    assert_eq!(findings.len(), 1);
    assert_eq!(&text[findings[0].evidence.clone()], "Türen müssen mindestens 0,9 m breit sein.");
    assert_eq!(&text[findings[0].printed.clone()], "0,9 m");
    assert_eq!(findings[0].si, [0.9]);
}

#[test]
fn list_items_are_read_with_their_lead_in() {
    let text = "The following minimum widths apply:\n- corridors: 1.5 m\n- doors: 0.9 m\n\nThe hall is 12 m long.";
    assert_eq!(lines(text, "en"), ["corridor width Minimum 1.5 m", "door width Minimum 0.9 m"]);
    let inline = "The following apply: - corridors: 1.5 m - doors: 0.9 m";
    assert_eq!(lines(inline, "en"), ["corridor dimension Recommendation 1.5 m", "door dimension Recommendation 0.9 m"]);
    let german = "Folgende Mindestbreiten gelten:\n1. Flure: 1,50 m\n2. Türen: 0,90 m";
    assert_eq!(lines(german, "de"), ["corridor width Minimum 1,50 m", "door width Minimum 0,90 m"]);
}

#[test]
fn headings_and_earlier_sentences_name_the_space() {
    let text = "## Corridors\n\nThe clear width shall be at least 1.5 m. It should preferably be 1.8 m.\n\n## Doors\n\n\
                A width of 0.9 m is required.";
    let expected =
        ["corridor clear_width Minimum 1.5 m", "corridor clear_width Recommendation 1.8 m", "door width Minimum 0.9 m"];
    assert_eq!(lines(text, "en"), expected);
}

#[test]
fn tables_are_read_with_their_caption_and_their_rows_of_occupancy() {
    let caption = "Recommended illuminance\n\n| Room | Value |\n|---|---|\n| Office | 500 lx |\n| Corridor | 100 lx |";
    assert_eq!(
        lines(caption, "en"),
        ["office illuminance Recommendation 500 lx", "corridor illuminance Recommendation 100 lx"]
    );
    let occupancy = "| Persons | Exits required |\n|---|---|\n| up to 100 | 2 |\n| up to 500 | 3 |";
    let findings = Extractor::shared().extract(occupancy, "en");
    let said: Vec<_> = findings
        .iter()
        .map(|f| (f.constraint.constraint_type, f.si.clone(), f.constraint.conditions.join("")))
        .collect();
    let rule = |n: f64, when: &str| (ConstraintType::Minimum, vec![n], when.to_owned());
    assert_eq!(said, [rule(2.0, "up to 100"), rule(3.0, "up to 500")]);
}
