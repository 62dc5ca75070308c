//! Sentences that say more than is known: a comparison in words that are not known, remarks in brackets.
//!
//! A wrong rule is worse than none: none of these may become a minimum.

use d3dgen_research::extract::Extractor;

/// Returns what is found, as `minimum 1.3`, joined.
fn rules(text: &str, lang: &str) -> String {
    let found = Extractor::shared().extract(text, lang);
    let shown = found.iter().map(|f| format!("{} {:?}", f.constraint.constraint_type.name(), f.si));
    shown.collect::<Vec<_>>().join(", ")
}

#[test]
fn a_comparison_in_unknown_words_makes_no_rule() {
    for (lang, text) in [
        ("da", "Trinnets højde må ikke være større end 0,18 m."),
        ("", "Trinnets højde må ikke være større end 0,18 m."),
        ("sv", "Trappans höjd får inte vara större än 0,18 m."),
        ("", "Trappstegens höjd skall inte överskrida 0,18 m på någon våning."),
        ("pl", "Wysokość stopnia musi być poniżej 0,18 m."),
        ("cs", "Výška schodu musí být pod 0,18 m."),
        ("fi", "Portaan korkeus saa olla alle 0,18 m."),
        ("en", "A corridor shall be no skimpier than 1.4 m."),
        ("de", "Flure müssen lockerer als 1,4 m sein."),
    ] {
        assert_eq!(rules(text, lang), "", "{lang}: {text}");
    }
}

#[test]
fn a_comparison_that_is_known_makes_its_rule_in_any_language() {
    for (lang, text, expected) in [
        ("da", "Gangens fri bredde skal være mindst 1,3 m.", "minimum [1.3]"),
        ("", "Dørtrin må maksimalt være 2,5 cm.", "maximum [0.025]"),
        ("ko", "복도 폭은 1.2m보다 좁아서는 안 된다.", "minimum [1.2]"),
        ("zh", "严禁使用宽度小于0.8米的通道。", "minimum [0.8]"),
        ("es", "Los umbrales nunca superarán los 2 cm.", "maximum [0.02]"),
        ("fr", "Le seuil n'excède pas 2 cm.", "maximum [0.02]"),
    ] {
        assert_eq!(rules(text, lang), expected, "{lang}: {text}");
    }
}

#[test]
fn a_remark_in_brackets_is_no_rule() {
    let found = rules("Ramps must not be steeper than 1:20 (5 cm of rise a metre).", "en");
    assert_eq!(found, "maximum [0.05]");
    let found = rules("Corridors shall be at least 1.5 m wide (the old ones had 1.2 m).", "en");
    assert!(!found.contains("1.2"), "{found}");
}
