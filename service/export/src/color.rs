//! Colors of objects: CSS in the documents, RGB in models and pictures, a word in annotations.

use std::str::FromStr;

/// Red, green and blue in 0-1, sRGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rgb(pub [f64; 3]);

impl Rgb {
    /// Returns the color of a CSS text, or a light gray for a text that is none: a wrong color must not stop an export.
    pub fn from_css(text: &str) -> Self {
        svgtypes::Color::from_str(text.trim())
            .map_or(Self([0.8, 0.8, 0.8]), |c| Self([c.red, c.green, c.blue].map(|v| f64::from(v) / 255.0)))
    }

    /// Returns the nearest word of the ASA color vocabulary.
    pub fn word(self) -> &'static str {
        const WORDS: [(&str, [f64; 3]); 14] = [
            ("white", [0.97, 0.97, 0.97]),
            ("gray", [0.55, 0.55, 0.55]),
            ("silver", [0.77, 0.78, 0.8]),
            ("black", [0.08, 0.08, 0.08]),
            ("beige", [0.9, 0.86, 0.76]),
            ("cream", [0.99, 0.96, 0.85]),
            ("tan", [0.8, 0.68, 0.52]),
            ("brown", [0.5, 0.34, 0.2]),
            ("blue", [0.25, 0.45, 0.75]),
            ("green", [0.3, 0.55, 0.3]),
            ("red", [0.78, 0.2, 0.18]),
            ("orange", [0.92, 0.55, 0.2]),
            ("yellow", [0.95, 0.85, 0.3]),
            ("gold", [0.8, 0.65, 0.25]),
        ];
        let distance = |c: [f64; 3]| (0..3).map(|i| (c[i] - self.0[i]).powi(2)).sum::<f64>();
        WORDS.iter().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1))).map_or("gray", |w| w.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn css_texts_become_rgb_and_words() {
        for (css, rgb, word) in [
            ("#ffffff", [1.0, 1.0, 1.0], "white"),
            ("black", [0.0, 0.0, 0.0], "black"),
            ("saddlebrown", [139.0 / 255.0, 69.0 / 255.0, 19.0 / 255.0], "brown"),
            ("no color at all", [0.8, 0.8, 0.8], "silver"),
        ] {
            assert_eq!(Rgb::from_css(css), Rgb(rgb), "{css}");
            assert_eq!(Rgb::from_css(css).word(), word, "{css}");
        }
    }
}
