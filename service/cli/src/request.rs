//! The flags that say what to build, shared by `generate` and `scene-graph` so that both make the same graph.

use std::io::{self, Read};

use d3dgen_model::style::{Clutter, Style};
use d3dgen_pipeline::scene_graph::Request;

use crate::error::Error;

/// What the flags say beside the prompt.
#[derive(clap::Args, Clone)]
pub struct RequestArgs {
    /// Seed of all choices: the same seed and request give the same bytes
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Kind of building (`d3dgen domains list`); otherwise read from the prompt
    #[arg(long, value_name = "ID")]
    pub domain: Option<String>,
    /// Country whose rules apply, as a code (DE) or an English name; otherwise read from the prompt
    #[arg(long, value_name = "COUNTRY")]
    pub country: Option<String>,
    /// Number of rooms, corridors not counted
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub rooms: Option<u32>,
    /// Floor area in m2
    #[arg(long, value_name = "M2", allow_negative_numbers = true)]
    pub area: Option<f64>,
    /// Radius in m of the largest robot
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub robot_radius: Option<f64>,
    /// How many small everyday things stand on furniture: low, normal or high; otherwise read from the prompt
    #[arg(long, value_name = "GRADE", value_parser = clutter)]
    pub clutter: Option<Clutter>,
    /// How the building is to be, in words with commas between: compact or generous, cellular or open, symmetric or
    /// asymmetric; otherwise read from the prompt
    #[arg(long, value_name = "WORDS", value_parser = style)]
    pub style: Option<Style>,
}

/// Returns the grade of clutter of a name.
fn clutter(name: &str) -> Result<Clutter, String> {
    Clutter::of(name).ok_or_else(|| format!("clutter `{name}` is not known; known are low, normal, high"))
}

/// Returns the style of words with commas between them.
fn style(words: &str) -> Result<Style, String> {
    Style::of_words(words.split(',').map(str::trim).filter(|w| !w.is_empty()))
}

impl RequestArgs {
    /// Returns the request for a prompt.
    pub fn request(&self, prompt: &str) -> Request {
        Request {
            prompt: prompt.to_owned(),
            seed: self.seed,
            domain: self.domain.clone(),
            country: self.country.clone(),
            rooms: self.rooms,
            area_m2: self.area,
            robot_radius_m: self.robot_radius,
            style: Style { clutter: self.clutter, ..self.style.unwrap_or_default() },
        }
    }
}

/// Returns the prompt, read from standard input for `-`.
///
/// # Errors
/// `Read` when standard input is not text.
pub fn prompt(given: &str) -> Result<String, Error> {
    if given != "-" {
        return Ok(given.to_owned());
    }
    let mut text = String::new();
    io::stdin().read_to_string(&mut text).map_err(|source| Error::Read { path: "standard input".into(), source })?;
    Ok(text.trim().to_owned())
}
