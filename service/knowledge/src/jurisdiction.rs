//! Which rules apply in a place: subdivision, country, region, international, nearest first.

use d3dgen_model::domain::{Adjacency, Domain};
use d3dgen_model::knowledge::LOCAL;

/// Regions whose rules their member states follow, with ISO 3166-1 codes.
const REGIONS: [(&str, &[&str]); 1] = [(
    "EU",
    &[
        "AT", "BE", "BG", "CY", "CZ", "DE", "DK", "EE", "ES", "FI", "FR", "GR", "HR", "HU", "IE", "IT", "LT", "LU",
        "LV", "MT", "NL", "PL", "PT", "RO", "SE", "SI", "SK",
    ],
)];

/// Code of rules that hold everywhere.
pub const INTERNATIONAL: &str = "INT";

/// Returns the jurisdictions of a place, nearest first: `US-CA` gives `LOCAL`, `US-CA`, `US`, `INT`.
///
/// Rules that the owner of the building sets (`LOCAL`) hold everywhere.
/// `None` (no country known) gives international rules only.
pub fn chain(country_code: Option<&str>) -> Vec<String> {
    let mut out = vec![LOCAL.to_owned()];
    if let Some(code) = country_code.map(str::to_ascii_uppercase).filter(|c| !c.is_empty() && c != INTERNATIONAL) {
        let country = code.split('-').next().unwrap_or(&code).to_owned();
        if country != code {
            out.push(code);
        }
        let regions = REGIONS.iter().filter(|(_, members)| members.contains(&country.as_str()));
        let regions: Vec<String> = regions.map(|(name, _)| (*name).to_owned()).collect();
        out.push(country);
        out.extend(regions);
    }
    out.push(INTERNATIONAL.to_owned());
    out
}

/// Returns how wide a place is that rules hold in: 0 for one building and parts of countries, then countries, regions, the world.
pub fn breadth(code: &str) -> u8 {
    match code {
        LOCAL => 0,
        INTERNATIONAL => 3,
        code if REGIONS.iter().any(|(name, _)| *name == code) => 2,
        code if code.contains('-') => 0,
        _ => 1,
    }
}

/// Returns the jurisdictions of a country and of its division, nearest first; none where no country is known.
pub fn national(country_code: Option<&str>) -> Vec<String> {
    let mut all = chain(country_code);
    all.retain(|code| code != LOCAL && code != INTERNATIONAL && !REGIONS.iter().any(|(region, _)| region == code));
    all
}

/// Returns true where a rule of these jurisdictions holds; one without any holds everywhere.
pub fn holds(jurisdictions: &[String], country_code: Option<&str>) -> bool {
    jurisdictions.is_empty() || chain(country_code).iter().any(|code| jurisdictions.contains(code))
}

/// Returns the adjacency rules of a domain that hold in a country; without one, those that hold everywhere.
pub fn rules_here<'d>(domain: &'d Domain, country_code: Option<&str>) -> impl Iterator<Item = &'d Adjacency> {
    domain.adjacency.iter().filter(move |rule| holds(&rule.jurisdictions, country_code))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_first() {
        let cases: [(Option<&str>, &[&str]); 5] = [
            (None, &["LOCAL", "INT"]),
            (Some("US"), &["LOCAL", "US", "INT"]),
            (Some("US-NC"), &["LOCAL", "US-NC", "US", "INT"]),
            (Some("de"), &["LOCAL", "DE", "EU", "INT"]),
            (Some("EU"), &["LOCAL", "EU", "INT"]),
        ];
        for (code, expected) in cases {
            assert_eq!(chain(code), expected, "{code:?}");
        }
    }

    #[test]
    fn rules_hold_in_their_parts_too() {
        let cases: [(&[&str], Option<&str>, bool); 9] = [
            (&[], None, true),
            (&[], Some("DE"), true),
            (&["US"], Some("US"), true),
            (&["US"], Some("US-CA"), true),
            (&["US-CA"], Some("US"), false),
            (&["CN", "EU"], Some("DE"), true),
            (&["US"], Some("DE"), false),
            (&["US"], None, false),
            (&["INT"], None, true),
        ];
        for (of, country, expected) in cases {
            let of: Vec<String> = of.iter().map(|&code| code.to_owned()).collect();
            assert_eq!(holds(&of, country), expected, "{of:?} in {country:?}");
        }
    }
}
