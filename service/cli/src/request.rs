//! The flags that say what to build, shared by `generate` and `scene-graph` so that both make the same graph.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::style::{Clutter, Style};
use d3dgen_pipeline::scene_graph::Request;

use crate::error::Error;
use crate::input;

/// What the flags say beside the prompt.
#[derive(clap::Args, Clone)]
pub struct RequestArgs {
    /// Seed of all choices: the same seed and request give the same bytes
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Kind of building (`d3dgen domains list`); otherwise read from the prompt
    #[arg(long, value_name = "ID")]
    pub domain: Option<String>,
    /// Country or division whose rules apply: a code (DE, CA-ON), or its name or a city; otherwise read from the prompt
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
    /// Width in m of the robot that the building is for
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub robot_width: Option<f64>,
    /// Length in m of the robot
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub robot_length: Option<f64>,
    /// Height in m of the robot: what hangs above it does not stop it
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub robot_height: Option<f64>,
    /// Radius in m of the circle that the robot turns in; otherwise half the diagonal of its body
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub robot_turning_radius: Option<f64>,
    /// Highest step in m that the robot drives over
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub robot_climb: Option<f64>,
    /// TOML file with measures of the robot (width_m, length_m, height_m, turning_radius_m, climb_m); flags win
    #[arg(long, value_name = "FILE", value_parser = robot_file)]
    pub robot_file: Option<RobotBody>,
    /// Make doors, corridors and gaps wide enough for the robot, or say which robot would fit
    #[arg(long)]
    pub fit_robot: bool,
    /// How many small everyday things stand on furniture: low, normal or high; otherwise read from the prompt
    #[arg(long, value_name = "GRADE", value_parser = clutter)]
    pub clutter: Option<Clutter>,
    /// How the building is to be, in words with commas between: compact or generous, cellular or open, symmetric or
    /// asymmetric, and one of linear, l_shaped, racetrack, courtyard, wings; otherwise read from the prompt
    #[arg(long, value_name = "WORDS", value_parser = style)]
    pub style: Option<Style>,
    /// Plan the facts of a brief.json (`d3dgen brief --out`), and read no prompt
    #[arg(long, value_name = "FILE", conflicts_with = "prompt")]
    pub brief: Option<PathBuf>,
}

/// Returns the robot that a file describes.
fn robot_file(path: &str) -> Result<RobotBody, String> {
    let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    toml::from_str(&text).map_err(|e| e.to_string().trim_end().to_owned())
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
    /// Returns the robot's body: flags, then the file.
    fn robot(&self) -> RobotBody {
        let flags = RobotBody {
            width_m: self.robot_width,
            length_m: self.robot_length,
            height_m: self.robot_height,
            turning_radius_m: self.robot_turning_radius,
            climb_m: self.robot_climb,
            fit: self.fit_robot,
        };
        flags.or(self.robot_file.unwrap_or_default())
    }

    /// Returns the request for a prompt as it was given, or for a brief: that of the flag, or a file named in place of the
    /// prompt.
    ///
    /// # Errors
    /// `Read` and `Document` when the brief or standard input cannot be read.
    pub fn request(&self, given: Option<&str>) -> Result<Request, Error> {
        let named = given.filter(|g| g.ends_with(".json") && Path::new(g).is_file()).map(PathBuf::from);
        let brief = self.brief.clone().or(named).map(|file| input::brief(&file)).transpose()?;
        let text = match &brief {
            Some(brief) => brief.prompt.clone(),
            None => prompt(given.unwrap_or_default())?,
        };
        Ok(Request {
            prompt: text,
            brief,
            seed: self.seed,
            domain: self.domain.clone(),
            country: self.country.clone(),
            rooms: self.rooms,
            area_m2: self.area,
            robot_radius_m: self.robot_radius,
            robot: self.robot(),
            style: Style { clutter: self.clutter, ..self.style.unwrap_or_default() },
        })
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
