//! How a plan is read, beside the file itself.

/// Thickness of inner walls that are drawn as lines, m, where the user does not say it.
pub(crate) const INNER_WALL_M: f64 = 0.12;
/// The same of outer walls, m.
pub(crate) const OUTER_WALL_M: f64 = 0.24;

/// What the user says of a plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Name of the format; recognized from the file when absent.
    pub format: Option<String>,
    /// Length of one unit of the drawing, m, where the file does not say it or says it wrong.
    pub meters_per_unit: Option<f64>,
    /// Storey to read alone; all of them otherwise.
    pub level: Option<String>,
    /// Makes outlines with slanted walls of steps instead of refusing them; walls drawn as lines are in any case.
    pub rectify: bool,
    /// Thickness of walls that are drawn as lines, m: inner and outer ones.
    pub inner_wall_m: Option<f64>,
    /// See `inner_wall_m`.
    pub outer_wall_m: Option<f64>,
    /// What is drawn on layers, where their names do not say it or say it wrong: the name of a layer, class, group or kind.
    pub layers: Vec<(String, LayerUse)>,
    /// Adds doors where rooms cannot be reached.
    pub add_doors: bool,
    /// Adds a window to each room that needs daylight and has none.
    pub add_windows: bool,
}

/// What is drawn on a layer, as the user says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LayerUse {
    /// Walls, by lines or by their faces.
    Wall,
    /// Outlines of rooms.
    Room,
    /// Doors.
    Door,
    /// Windows.
    Window,
    /// Columns.
    Column,
    /// Things that do not belong to the building.
    Furniture,
    /// Nothing that a note has to name.
    Ignore,
}

impl LayerUse {
    /// Every use with the word for it.
    pub const ALL: [(&'static str, Self); 7] = [
        ("wall", Self::Wall),
        ("room", Self::Room),
        ("door", Self::Door),
        ("window", Self::Window),
        ("column", Self::Column),
        ("furniture", Self::Furniture),
        ("ignore", Self::Ignore),
    ];

    /// Returns the use that a word means.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| name.eq_ignore_ascii_case(word.trim())).map(|(_, layer_use)| *layer_use)
    }
}
