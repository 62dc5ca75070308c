//! What is asked for: the words, and the flags that overrule them.

use d3dgen_model::brief::Brief;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::stage::Error;
use d3dgen_model::style::Style;

/// Most rooms one world is planned for.
pub(crate) const MAX_ROOMS: u32 = 500;

/// The same as numbers of prompts are written.
pub(crate) const MANY: i64 = MAX_ROOMS as i64;

/// Largest building, m^2.
pub(crate) const MAX_AREA_M2: f64 = 200_000.0;

/// What to build: a prompt, and flags that overrule it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// What people ask for, in English, German, French, Spanish, Chinese or Korean.
    pub prompt: String,
    /// The facts to plan, where somebody states them: the prompt is not read then.
    pub brief: Option<Brief>,
    /// Seed of every random choice.
    pub seed: u64,
    /// Domain id; read from the prompt when absent.
    pub domain: Option<String>,
    /// Country as ISO 3166-1 alpha-2 code or name; read from the prompt when absent.
    pub country: Option<String>,
    /// Rooms in total, circulation aside.
    pub rooms: Option<u32>,
    /// Net floor area in total, m^2.
    pub area_m2: Option<f64>,
    /// Radius of the largest robot, m.
    pub robot_radius_m: Option<f64>,
    /// Body of the robot that the building is for, and whether it is made so that it fits.
    pub robot: RobotBody,
    /// How the building is to be; what is absent is read from the prompt.
    pub style: Style,
}

/// Returns the refusal of a request.
pub(crate) fn refused(message: String) -> Error {
    Error::Refused { stage: "scene_graph", message }
}
