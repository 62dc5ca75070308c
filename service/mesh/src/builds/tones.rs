//! Tones: the material and the weight that the role of a part gives.

use d3dgen_model::domain::{ObjectType, Tone};

use crate::model3d::Material;

/// What a tone looks like and weighs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Look {
    pub material: Material,
    /// Density of the stuff, kg/m^3.
    pub density: f64,
    /// Thickness of its walls: thicker parts are hollow, m.
    pub wall: f64,
}

/// Stuff: metallic, roughness, density kg/m^3, wall m, and the finish that gives its grain.
type Stuff = (f32, f32, f64, f64, Option<&'static str>);

const WOOD: Stuff = (0.0, 0.55, 650.0, 0.018, Some("Wood_Grain"));
const STEEL: Stuff = (1.0, 0.38, 7850.0, 0.0012, Some("Metal_Brushed"));
const PAINTED_STEEL: Stuff = (0.0, 0.42, 7850.0, 0.001, None);
const FABRIC: Stuff = (0.0, 0.92, 60.0, 10.0, Some("Fabric_Weave"));
const LEATHER: Stuff = (0.0, 0.5, 70.0, 10.0, Some("Leather_Grain"));
const PLASTIC: Stuff = (0.0, 0.45, 1050.0, 0.003, None);
const CERAMIC: Stuff = (0.0, 0.12, 2300.0, 0.008, None);
const GLASS: Stuff = (0.0, 0.06, 2500.0, 0.005, None);
const PAPER: Stuff = (0.0, 0.85, 700.0, 10.0, None);
const RUBBER: Stuff = (0.0, 0.8, 1150.0, 0.01, None);
const LEAF: Stuff = (0.0, 0.7, 150.0, 10.0, None);
const STONE: Stuff = (0.0, 0.6, 2300.0, 0.03, Some("Stone_Grain"));

/// Returns the look of a part: its tone for this object, and its own color when it has one.
pub(super) fn look(tone: Tone, color: Option<&str>, object: &ObjectType) -> Look {
    let own = srgb(&object.color).unwrap_or([0.8; 3]);
    let main = stuff(&object.material);
    // A tone that is what the object is made of has the object's color.
    let is = |words: &[&str], other: [f64; 3]| if words.contains(&object.material.as_str()) { own } else { other };
    let (base, (metallic, roughness, density, wall, finish)) = match tone {
        Tone::Main => (own, main),
        Tone::Dark => (mix(own, [0.0; 3], 0.35), main),
        Tone::Light => (mix(own, [1.0; 3], 0.35), main),
        Tone::Metal => ([0.66, 0.67, 0.69], STEEL),
        Tone::Chrome => ([0.82, 0.83, 0.85], (1.0, 0.12, STEEL.2, STEEL.3, None)),
        Tone::Wood => (is(&["wood"], [0.68, 0.50, 0.32]), WOOD),
        Tone::White => ([0.93, 0.93, 0.92], (0.0, 0.4, PLASTIC.2, PLASTIC.3, None)),
        Tone::Black => ([0.07, 0.07, 0.08], (0.0, 0.4, PLASTIC.2, PLASTIC.3, None)),
        Tone::Glass => ([0.80, 0.90, 0.93], GLASS),
        Tone::Mirror => ([0.86, 0.90, 0.92], (1.0, 0.03, GLASS.2, GLASS.3, None)),
        Tone::Screen => ([0.03, 0.05, 0.10], (0.0, 0.15, PLASTIC.2, PLASTIC.3, None)),
        Tone::Fabric => (is(&["fabric"], [0.52, 0.55, 0.58]), FABRIC),
        Tone::Leather => (is(&["leather"], [0.24, 0.17, 0.13]), LEATHER),
        Tone::Plastic => (is(&["plastic"], [0.72, 0.73, 0.74]), PLASTIC),
        Tone::Rubber => ([0.09, 0.09, 0.09], RUBBER),
        Tone::Ceramic => (is(&["ceramic", "porcelain"], [0.95, 0.95, 0.94]), CERAMIC),
        Tone::Green => ([0.22, 0.43, 0.18], LEAF),
        Tone::Paper => ([0.93, 0.91, 0.85], PAPER),
        Tone::Red => ([0.78, 0.14, 0.12], PAINTED_STEEL),
        Tone::Blue => ([0.16, 0.36, 0.68], PAINTED_STEEL),
        Tone::Yellow => ([0.95, 0.79, 0.15], PAINTED_STEEL),
        Tone::Orange => ([0.93, 0.48, 0.12], PAINTED_STEEL),
        Tone::Signal => ([0.15, 0.85, 0.35], PLASTIC),
        Tone::Skin => ([0.84, 0.66, 0.54], (0.0, 0.6, 985.0, 10.0, None)),
        Tone::Warm => ([1.0, 0.93, 0.78], GLASS),
    };
    let base = color.and_then(srgb).unwrap_or(base);
    let linear = base.map(|v| linear(v) as f32);
    let emissive = match tone {
        Tone::Screen => [0.03, 0.07, 0.16],
        Tone::Signal => linear.map(|v| v * 0.6),
        Tone::Warm => linear.map(|v| v * 0.9),
        _ => [0.0; 3],
    };
    let opacity = if tone == Tone::Glass { 0.35 } else { 1.0 };
    let name = match color {
        Some(color) => format!("Color_{}", color.trim_start_matches('#').to_lowercase()),
        None => format!("{tone:?}"),
    };
    let finish = finish.map(str::to_owned);
    let material = Material { name, base_color: linear, opacity, metallic, roughness, emissive, texture: None, finish };
    Look { material, density, wall }
}

fn stuff(material: &str) -> Stuff {
    match material {
        // Painted or coated sheet: the color of the catalog shows.
        "metal" | "steel" | "aluminum" => PAINTED_STEEL,
        "fabric" | "textile" | "foam" => FABRIC,
        "leather" => LEATHER,
        "plastic" => PLASTIC,
        "ceramic" | "porcelain" => CERAMIC,
        "glass" => GLASS,
        "paper" | "cardboard" | "wax" => PAPER,
        "rubber" => RUBBER,
        "stone" | "concrete" | "marble" => STONE,
        _ => WOOD,
    }
}

/// Reads `#rgb` or `#rrggbb` or one of the commonest color names as sRGB.
pub(crate) fn srgb(text: &str) -> Option<[f64; 3]> {
    let text = text.trim();
    let Some(hex) = text.strip_prefix('#') else { return named(&text.to_ascii_lowercase()) };
    if !hex.chars().all(|c| c.is_ascii_hexdigit()) {
        return None;
    }
    let digits: String = match hex.len() {
        3 => hex.chars().flat_map(|c| [c, c]).collect(),
        6 => hex.to_owned(),
        _ => return None,
    };
    let byte = |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok().map(|v| f64::from(v) / 255.0);
    Some([byte(0)?, byte(1)?, byte(2)?])
}

fn named(name: &str) -> Option<[f64; 3]> {
    const NAMES: [(&str, u32); 17] = [
        ("black", 0x00_0000),
        ("white", 0xff_ffff),
        ("gray", 0x80_8080),
        ("grey", 0x80_8080),
        ("silver", 0xc0_c0c0),
        ("red", 0xff_0000),
        ("maroon", 0x80_0000),
        ("green", 0x00_8000),
        ("blue", 0x00_00ff),
        ("navy", 0x00_0080),
        ("yellow", 0xff_ff00),
        ("orange", 0xff_a500),
        ("brown", 0xa5_2a2a),
        ("saddlebrown", 0x8b_4513),
        ("beige", 0xf5_f5dc),
        ("tan", 0xd2_b48c),
        ("purple", 0x80_0080),
    ];
    let rgb = NAMES.iter().find(|n| n.0 == name)?.1;
    Some([16, 8, 0].map(|shift| f64::from((rgb >> shift) & 255) / 255.0))
}

fn mix(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] * (1.0 - share) + b[i] * share)
}

/// Returns an sRGB channel as linear light.
pub(crate) fn linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}
