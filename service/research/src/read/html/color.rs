//! Colors of style sheets, as far as it takes to tell text that has the color of its background.
//!
//! What it is not for: drawing.

/// A color.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Color {
    /// Red, green, blue.
    Rgb(u8, u8, u8),
    /// Nothing is drawn.
    Transparent,
    /// One that only a browser can tell.
    Unknown,
}

/// Names of colors that text is hidden with; all others stay unknown.
const NAMES: &[(&str, Color)] = &[
    ("white", Color::WHITE),
    ("black", Color::BLACK),
    ("transparent", Color::Transparent),
    ("snow", Color::Rgb(255, 250, 250)),
    ("ivory", Color::Rgb(255, 255, 240)),
    ("ghostwhite", Color::Rgb(248, 248, 255)),
    ("whitesmoke", Color::Rgb(245, 245, 245)),
    ("floralwhite", Color::Rgb(255, 250, 240)),
    ("mintcream", Color::Rgb(245, 255, 250)),
    ("azure", Color::Rgb(240, 255, 255)),
    ("gray", Color::Rgb(128, 128, 128)),
    ("grey", Color::Rgb(128, 128, 128)),
    ("silver", Color::Rgb(192, 192, 192)),
    ("lightgray", Color::Rgb(211, 211, 211)),
    ("lightgrey", Color::Rgb(211, 211, 211)),
    ("darkgray", Color::Rgb(169, 169, 169)),
    ("red", Color::Rgb(255, 0, 0)),
    ("green", Color::Rgb(0, 128, 0)),
    ("blue", Color::Rgb(0, 0, 255)),
    ("navy", Color::Rgb(0, 0, 128)),
    ("yellow", Color::Rgb(255, 255, 0)),
];

impl Color {
    pub const WHITE: Self = Self::Rgb(255, 255, 255);
    pub const BLACK: Self = Self::Rgb(0, 0, 0);

    /// Tells whether text of this color cannot be seen on a background.
    pub fn vanishes_on(self, background: Self) -> bool {
        match (self, background) {
            (Self::Transparent, _) => true,
            (Self::Rgb(r, g, b), Self::Rgb(r2, g2, b2)) => {
                [(r, r2), (g, g2), (b, b2)].iter().all(|(x, y)| x.abs_diff(*y) <= 16)
            }
            _ => false,
        }
    }
}

/// Returns the color that a value names.
pub fn color(value: &str) -> Color {
    let value = value.trim().to_ascii_lowercase();
    let named = NAMES.iter().find(|(name, _)| *name == value).map(|(_, c)| *c);
    named.or_else(|| value.strip_prefix('#').and_then(hex)).or_else(|| function(&value)).unwrap_or(Color::Unknown)
}

fn hex(digits: &str) -> Option<Color> {
    let digit = |i: usize| digits.get(i..=i).and_then(|d| u8::from_str_radix(d, 16).ok());
    let pair = |i: usize| digits.get(i..i + 2).and_then(|d| u8::from_str_radix(d, 16).ok());
    let (r, g, b, alpha) = match digits.len() {
        3 => (digit(0)? * 17, digit(1)? * 17, digit(2)? * 17, 255),
        4 => (digit(0)? * 17, digit(1)? * 17, digit(2)? * 17, digit(3)? * 17),
        6 => (pair(0)?, pair(2)?, pair(4)?, 255),
        8 => (pair(0)?, pair(2)?, pair(4)?, pair(6)?),
        _ => return None,
    };
    Some(if alpha < 13 { Color::Transparent } else { Color::Rgb(r, g, b) })
}

/// Reads `rgb(255, 255, 255)`, `rgba(0 0 0 / 0)`, `rgb(100% 100% 100%)`, and `hsl` where it is white or black.
fn function(value: &str) -> Option<Color> {
    let (name, rest) = value.split_once('(')?;
    let parts: Vec<f64> = rest
        .trim_end_matches(')')
        .split([',', ' ', '/'])
        .filter(|p| !p.is_empty())
        .map(|p| match p.strip_suffix('%') {
            Some(percent) => percent.parse::<f64>().map(|n| if name.starts_with("rgb") { n * 2.55 } else { n }),
            None => p.trim_end_matches("deg").parse(),
        })
        .collect::<Result<_, _>>()
        .ok()?;
    let [a, b, c, rest @ ..] = parts.as_slice() else { return None };
    if rest.first().is_some_and(|alpha| *alpha < 0.05) {
        return Some(Color::Transparent);
    }
    let byte = |x: f64| x.clamp(0.0, 255.0).round() as u8;
    match name {
        "rgb" | "rgba" => Some(Color::Rgb(byte(*a), byte(*b), byte(*c))),
        "hsl" | "hsla" if *c >= 97.0 => Some(Color::WHITE),
        "hsl" | "hsla" if *c <= 3.0 => Some(Color::BLACK),
        _ => None,
    }
}
