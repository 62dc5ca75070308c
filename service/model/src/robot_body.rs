//! The body of one robot that a building is for, as flags, files and requests state it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Measures of a robot; what is absent is that of a usual robot of its kind.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotBody {
    /// Width of its body, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_m: Option<f64>,
    /// Length of its body, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_m: Option<f64>,
    /// Height, m: what hangs above it does not stop it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Radius of the circle it turns in, m; else half the diagonal of its body, and a body 1.4 times as long as wide goes
    /// as its outline does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turning_radius_m: Option<f64>,
    /// Highest step it drives over, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub climb_m: Option<f64>,
    /// True when the building is to be made so that it fits.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fit: bool,
}

/// Least and largest measure of a body, m.
const RANGE_M: [f64; 2] = [0.05, 6.0];
/// How often as long as wide a body is whose circle says little of where it fits: robots drive straight through doors a hand wider
/// than they are (BellaBot, 0.54 m by 0.57 m, through 0.70 m), and what is nearly round loses little by its circle.
const LONG: f64 = 1.4;
/// Largest turning radius that a building is planned for, m.
const MOST_RADIUS_M: f64 = 2.0;

impl RobotBody {
    /// Returns true when nothing is said.
    pub fn is_unknown(&self) -> bool {
        Self { fit: false, ..*self } == Self::default()
    }

    /// Returns the radius of the disc that must find its way, m, rounded up to a millimeter; absent when no measure of it
    /// is known.
    ///
    /// That is the circle it turns in. Of a long one ([`Self::long_m`]) it is half its width: as beds do, it drives straight
    /// through doors, and turns where there is room for that.
    pub fn radius_m(&self) -> Option<f64> {
        if let Some([width, _]) = self.long_m() {
            return Some((width * 500.0 - 1e-6).ceil() / 1000.0);
        }
        let (a, b) = (self.width_m.or(self.length_m), self.length_m.or(self.width_m));
        let half_diagonal = a.zip(b).map(|(a, b)| a.hypot(b) / 2.0);
        // one that turns about its own middle cannot turn in less than it needs
        let radius = match (self.turning_radius_m, self.width_m) {
            (Some(turning), Some(width)) => Some(turning.max(width / 2.0)),
            (turning, _) => turning.or(half_diagonal),
        };
        radius.map(|r| (r * 1000.0 - 1e-6).ceil() / 1000.0)
    }

    /// Returns width and length of a body so long that its way is looked for with its outline, m: `LONG` times as long as
    /// wide, where no turning radius is given.
    pub fn long_m(&self) -> Option<[f64; 2]> {
        let (width, length) = self.width_m.zip(self.length_m).filter(|_| self.turning_radius_m.is_none())?;
        (length >= LONG * width - 1e-9).then_some([width, length])
    }

    /// Returns the radius of the circle it turns about its own middle in, m; absent when no measure of it is known.
    pub fn circle_m(&self) -> Option<f64> {
        self.long_m().map(|[width, length]| width.hypot(length) / 2.0).or_else(|| self.radius_m())
    }

    /// Returns what is wrong with it, in sentences that name the measure.
    pub fn problems(&self) -> Vec<String> {
        let measures = [
            ("width", self.width_m),
            ("length", self.length_m),
            ("height", self.height_m),
            ("turning radius", self.turning_radius_m),
        ];
        let [low, high] = RANGE_M;
        let mut out: Vec<String> = measures
            .into_iter()
            .filter_map(|(name, value)| Some((name, value.filter(|v| !(low..=high).contains(v))?)))
            .map(|(name, value)| format!("a robot's {name} of {value} m is outside {low}-{high} m"))
            .collect();
        if let Some(climb) = self.climb_m.filter(|c| !(0.0..=0.5).contains(c)) {
            out.push(format!("a robot's climb of {climb} m is outside 0-0.5 m"));
        }
        if let Some(radius) = self.circle_m().filter(|r| out.is_empty() && *r > MOST_RADIUS_M) {
            out.push(format!(
                "a robot that turns within {radius:.2} m is too large; {MOST_RADIUS_M} m can be planned for"
            ));
        }
        out
    }

    /// Returns the measures of `self`, and where it has none those of `other`.
    pub fn or(self, other: Self) -> Self {
        Self {
            width_m: self.width_m.or(other.width_m),
            length_m: self.length_m.or(other.length_m),
            height_m: self.height_m.or(other.height_m),
            turning_radius_m: self.turning_radius_m.or(other.turning_radius_m),
            climb_m: self.climb_m.or(other.climb_m),
            fit: self.fit || other.fit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_turns_in_half_its_diagonal_unless_it_says_otherwise() {
        let body = RobotBody { width_m: Some(0.6), length_m: Some(0.8), ..RobotBody::default() };
        assert_eq!(body.radius_m(), Some(0.5));
        assert_eq!(RobotBody { turning_radius_m: Some(0.7), ..body }.radius_m(), Some(0.7));
        assert_eq!(RobotBody { turning_radius_m: Some(0.1), ..body }.radius_m(), Some(0.3), "no narrower than it is");
        assert_eq!(RobotBody { width_m: Some(0.5), ..RobotBody::default() }.radius_m(), Some(0.354));
        assert_eq!(RobotBody::default().radius_m(), None);
        let long = RobotBody { width_m: Some(0.95), length_m: Some(2.1), ..RobotBody::default() };
        assert_eq!((long.radius_m(), long.circle_m().map(|c| c > 1.15)), (Some(0.475), Some(true)), "goes straight");
        let cart = RobotBody { width_m: Some(0.7), length_m: Some(1.0), ..RobotBody::default() };
        assert_eq!((cart.radius_m(), cart.circle_m()), (Some(0.35), Some(0.7_f64.hypot(1.0) / 2.0)), "so does a cart");
        let told = RobotBody { turning_radius_m: Some(1.2), ..long };
        assert_eq!((told.long_m(), told.radius_m()), (None, Some(1.2)), "what is said counts");
        let giant = RobotBody { width_m: Some(4.0), ..RobotBody::default() };
        assert!(giant.problems()[0].contains("too large"), "{:?}", giant.problems());
        assert!(RobotBody { height_m: Some(-1.0), ..body }.problems()[0].contains("height of -1 m"));
    }
}
