//! Text that is no text, and what the evidence is.

use super::*;

#[test]
fn nonsense_never_panics() {
    let long = |piece: &str| piece.repeat(100_000 / piece.len() + 1);
    let pieces = [
        "1 m ",
        "🦀½ ",
        "\u{0}\u{1b}\u{7f}",
        "|1|m|\n",
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
    ];
    for (piece, lang) in pieces.iter().zip(["en", "de", "", "🦀"].into_iter().cycle()) {
        Extractor::shared().extract(&long(piece), lang);
    }
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
