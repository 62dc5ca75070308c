//! Units of figures in documents: which SI unit stands for a printed one, and how to get there.
//!
//! What it is not for: finding units in running text (`research` does) and deciding what a figure means.

/// A printed unit in SI terms: `si_value = printed * factor + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Conversion {
    /// Unit in the spelling of knowledge bases (`m`, `m^2`, `m^2/person`).
    pub unit: String,
    /// Multiplier.
    pub factor: f64,
    /// Added after the multiplication; zero but for temperatures.
    pub offset: f64,
}

impl Conversion {
    /// Returns a printed figure in SI, rounded to the twelve digits that a conversion by decimal factors can keep.
    pub fn apply(&self, printed: f64) -> f64 {
        if self.is_identity() {
            return printed;
        }
        let exact = printed * self.factor + self.offset;
        if exact == 0.0 || !exact.is_finite() {
            return exact;
        }
        let digits = 11 - exact.abs().log10().floor() as i32;
        let scale = 10f64.powi(digits);
        (exact * scale).round() / scale
    }

    /// Returns true when figures stay as they are.
    pub fn is_identity(&self) -> bool {
        self.factor == 1.0 && self.offset == 0.0
    }
}

/// Spellings, SI unit, factor. Factors: NIST SP 811 (2008), appendix B; hours and minutes are accepted beside the SI.
const UNITS: &[(&[&str], &str, f64)] = &[
    (&["m", "meter", "meters", "metre", "metres"], "m", 1.0),
    (&["cm", "centimeter", "centimeters", "centimetre", "centimetres"], "m", 0.01),
    (&["mm", "millimeter", "millimeters", "millimetre", "millimetres"], "m", 0.001),
    (&["km", "kilometer", "kilometers", "kilometre", "kilometres"], "m", 1000.0),
    (&["in", "inch", "inches", "\""], "m", 0.0254),
    (&["ft", "foot", "feet", "'"], "m", 0.3048),
    (&["yd", "yard", "yards"], "m", 0.9144),
    (&["m^2", "m2", "m²", "sqm", "sq m", "square meter", "square meters", "square metre", "square metres"], "m^2", 1.0),
    (&["cm^2", "cm2", "cm²"], "m^2", 1e-4),
    (&["mm^2", "mm2", "mm²"], "m^2", 1e-6),
    (&["ft^2", "ft2", "ft²", "sqft", "sq ft", "sf", "square foot", "square feet"], "m^2", 0.092_903_04),
    (&["in^2", "in2", "in²", "sq in", "square inches"], "m^2", 6.4516e-4),
    (&["m^3", "m3", "m³", "cubic meter", "cubic meters"], "m^3", 1.0),
    (&["ft^3", "ft3", "ft³", "cu ft", "cubic feet"], "m^3", 0.028_316_846_592),
    (&["m/s"], "m/s", 1.0),
    (&["mm/s"], "m/s", 0.001),
    (&["km/h", "kph"], "m/s", 1.0 / 3.6),
    (&["mph", "mi/h"], "m/s", 0.44704),
    (&["ft/s", "fps"], "m/s", 0.3048),
    (&["ft/min", "fpm"], "m/s", 0.00508),
    (&["kg"], "kg", 1.0),
    (&["g"], "kg", 0.001),
    (&["lb", "lbs", "pound", "pounds"], "kg", 0.453_592_37),
    (&["lx", "lux"], "lx", 1.0),
    (&["fc", "footcandle", "footcandles", "foot-candle", "foot-candles"], "lx", 10.763_910_417),
    (&["degC", "°C", "C", "celsius"], "degC", 1.0),
    (&["deg", "°", "degree", "degrees"], "deg", 1.0),
    (&["rad"], "deg", 57.295_779_513_082),
    (&["L/s", "l/s"], "L/s", 1.0),
    (&["m^3/h", "m3/h", "m³/h"], "m^3/h", 1.0),
    (&["cfm", "ft^3/min"], "L/s", 0.471_947_443),
    (&["W", "watt", "watts"], "W", 1.0),
    (&["dB", "db", "dB(A)", "dBA"], "dB", 1.0),
    (&["h", "hour", "hours", "hr"], "h", 1.0),
    (&["min", "minute", "minutes"], "min", 1.0),
    (&["s", "sec", "second", "seconds"], "s", 1.0),
    (&["percent", "%", "per cent"], "percent", 1.0),
    (&["ratio", "1"], "ratio", 1.0),
    (&["count", "number"], "count", 1.0),
    (&["boolean", "bool", "yes/no"], "boolean", 1.0),
    (&["ACH", "ach", "1/h"], "ACH", 1.0),
    (&["ppm"], "ppm", 1.0),
];

/// Returns the way from a printed unit to SI; `None` when the unit is not known, and then figures stay as printed.
///
/// The part after a slash that is no unit of the table names what the figure is for: `ft^2/person` gives
/// `m^2/person`.
pub fn conversion(printed: &str) -> Option<Conversion> {
    let word = printed.trim();
    let known = |word: &str| {
        let exact = UNITS.iter().find(|(names, ..)| names.contains(&word));
        exact.or_else(|| {
            UNITS.iter().find(|(names, ..)| names.iter().any(|n| n.len() > 2 && n.eq_ignore_ascii_case(word)))
        })
    };
    if matches!(word, "degF" | "°F" | "F" | "fahrenheit") {
        return Some(Conversion { unit: "degC".into(), factor: 5.0 / 9.0, offset: -160.0 / 9.0 });
    }
    if let Some((_, unit, factor)) = known(word) {
        return Some(Conversion { unit: (*unit).to_owned(), factor: *factor, offset: 0.0 });
    }
    let (figure, per) = word.split_once('/').or_else(|| word.split_once(" per "))?;
    let (_, unit, factor) = known(figure.trim())?;
    let per = per.trim();
    match known(per) {
        Some((_, per_unit, per_factor)) => {
            Some(Conversion { unit: format!("{unit}/{per_unit}"), factor: factor / per_factor, offset: 0.0 })
        }
        None => Some(Conversion { unit: format!("{unit}/{per}"), factor: *factor, offset: 0.0 }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_figures_in_si() {
        let cases = [
            (36.0, "in", 0.9144, "m"),
            (8.0, "feet", 2.4384, "m"),
            (120.0, "sq ft", 11.148_364_8, "m^2"),
            (100.0, "ft^2/person", 9.290_304, "m^2/person"),
            (915.0, "mm", 0.915, "m"),
            (68.0, "degF", 20.0, "degC"),
            (3.6, "km/h", 1.0, "m/s"),
            (7.0, "m²", 7.0, "m^2"),
            (2.0, "W/ft^2", 21.527_820_833_4, "W/m^2"),
            (0.2, "in per occupant", 0.00508, "m/occupant"),
        ];
        for (printed, unit, value, si) in cases {
            let to = conversion(unit).unwrap_or_else(|| panic!("{unit}"));
            assert_eq!(to.unit, si);
            assert!((to.apply(printed) - value).abs() < 1e-9 * value.abs(), "{printed} {unit}: {}", to.apply(printed));
        }
        for unknown in ["", "furlong", "other", "rooms", "/person"] {
            assert_eq!(conversion(unknown), None, "{unknown}");
        }
    }

    #[test]
    fn si_stays_as_it_is() {
        for unit in ["m", "m^2", "lx", "count", "boolean", "ratio", "L/s", "ACH", "W/m^2"] {
            let to = conversion(unit).unwrap_or_else(|| panic!("{unit}"));
            assert_eq!((to.unit.as_str(), to.apply(0.1 + 0.2)), (unit, 0.1 + 0.2));
        }
    }
}
