//! The figures of the tables: one list of name, heading, meaning and value, read by every output.

use std::collections::BTreeMap;

use crate::evaluation::WorldMeasures;
use crate::metrics::round;

/// A figure that every world has or has not; groups show its mean.
pub struct Figure {
    /// Snake-case name in the JSON document.
    pub name: &'static str,
    /// Column heading.
    pub title: &'static str,
    /// What it means, one sentence.
    pub about: &'static str,
    /// How it is printed.
    pub form: Form,
    /// Value in a world.
    pub of: fn(&WorldMeasures) -> Option<f64>,
}

/// How a figure is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// With this many decimals.
    Decimals(usize),
    /// A share as a percentage.
    Percent,
}

impl Form {
    /// Returns the figure as text.
    pub fn text(self, value: f64) -> String {
        match self {
            Self::Decimals(n) => format!("{value:.n$}"),
            Self::Percent => {
                let percent = 100.0 * value;
                let whole = percent == 0.0 || percent == 100.0;
                // what is not all must not read as all
                let shown = if percent < 100.0 { percent.min(99.99) } else { percent };
                if whole {
                    format!("{percent:.0} %")
                } else if shown > 99.9 {
                    format!("{shown:.2} %")
                } else {
                    format!("{shown:.1} %")
                }
            }
        }
    }
}

const fn figure(
    name: &'static str,
    title: &'static str,
    form: Form,
    of: fn(&WorldMeasures) -> Option<f64>,
    about: &'static str,
) -> Figure {
    Figure { name, title, about, form, of }
}

fn yes(holds: bool) -> Option<f64> {
    Some(f64::from(u8::from(holds)))
}

use Form::{Decimals, Percent};

/// The figures in order of the tables: the paper's, the field's, ours.
pub const FIGURES: &[Figure] = &[
    figure("objects", "objects", Decimals(1), |w| Some(w.layout.objects.into()), "objects of a world"),
    figure(
        "objects_per_room",
        "a room",
        Decimals(1),
        |w| Some(w.layout.objects_per_room),
        "objects by rooms, circulation counted as rooms",
    ),
    figure("objects_per_m2", "a m2", Decimals(2), |w| Some(w.layout.objects_per_m2), "objects by net floor area"),
    figure(
        "doors",
        "doors",
        Decimals(1),
        |w| Some((w.layout.doors + w.layout.passages).into()),
        "doors and open passages",
    ),
    figure("walls", "walls", Decimals(1), |w| Some(w.layout.walls.into()), "straight pieces of wall"),
    figure(
        "floor_area_m2",
        "floor m2",
        Decimals(1),
        |w| Some(w.layout.floor_area_m2),
        "net floor area by the shoelace formula",
    ),
    figure(
        "object_spacing_m",
        "spacing m",
        Decimals(2),
        |w| w.layout.object_spacing_m,
        "distance from an object on the floor to the nearest other in its room",
    ),
    figure(
        "material_diversity_bit",
        "materials bit",
        Decimals(2),
        |w| Some(w.layout.material_diversity_bit),
        "entropy of the surface materials over the rooms",
    ),
    figure(
        "room_count_fidelity",
        "rooms exact",
        Percent,
        |w| yes(w.fidelity.exact),
        "worlds with exactly the rooms asked for, by number and type",
    ),
    figure(
        "adjacency",
        "adjacency",
        Percent,
        |w| Some(w.adjacency.required_share),
        "required connections that are built",
    ),
    figure(
        "not_rectangular",
        "not rect.",
        Percent,
        |w| yes(w.layout.rooms_not_rectangular + w.layout.outlines_not_rectangular > 0),
        "worlds with a room, a corridor or an outline that is no rectangle",
    ),
    figure("col", "COL", Percent, |w| Some(w.collisions.object_share), "objects in collision"),
    figure(
        "col_scene",
        "COL worlds",
        Percent,
        |w| yes(!w.collisions.pairs.is_empty()),
        "worlds with any object in collision",
    ),
    figure("oob", "OOB", Percent, |w| Some(w.out_of_bounds.object_share), "objects out of bounds"),
    figure("sup", "SUP", Percent, |w| Some(w.support.object_share), "objects that something holds"),
    figure(
        "nav",
        "NAV",
        Percent,
        |w| Some(w.navigability.house),
        "free floor in one piece, the house with walls and doors",
    ),
    figure(
        "nav_rooms",
        "NAV rooms",
        Percent,
        |w| Some(w.navigability.rooms_mean),
        "free floor in one piece, each room by itself",
    ),
    figure("acc", "ACC", Percent, |w| w.accessibility.mean, "free floor where objects are used"),
    figure(
        "oc_doors",
        "OC doors",
        Percent,
        |w| Some(w.openings.door_sides_blocked),
        "door sides with an object before them",
    ),
    figure(
        "oc_doors_full",
        "OC full width",
        Percent,
        |w| Some(w.openings.door_sides_blocked_full_width),
        "the same with boxes as deep as the opening is wide, whatever fills it",
    ),
    figure(
        "oc_windows",
        "OC windows",
        Percent,
        |w| Some(w.openings.windows_blocked),
        "windows with an object before them",
    ),
    figure(
        "public",
        "public",
        Percent,
        |w| Some(w.navigability.reached_in_public),
        "rooms reached without walking through a bedroom or bathroom",
    ),
    figure(
        "mandatory",
        "law kept",
        Percent,
        |w| w.compliance.as_ref().and_then(|c| c.mandatory.satisfied_share()),
        "decided constraints of regulations and standards that hold",
    ),
    figure(
        "advice",
        "advice kept",
        Percent,
        |w| w.compliance.as_ref().and_then(|c| c.advice.satisfied_share()),
        "decided recommendations that hold",
    ),
    figure("robots", "robots fit", Percent, robots, "robots that reach all their goals and their dock"),
    figure(
        "sound",
        "sound",
        Percent,
        |w| w.sound.and_then(yes),
        "worlds without a broken hard rule, by their own reports",
    ),
    figure(
        "time_ms",
        "time ms",
        Decimals(1),
        |w| (!w.stage_ms.is_empty()).then(|| w.stage_ms.values().sum()),
        "time of all stages and the check",
    ),
];

fn robots(w: &WorldMeasures) -> Option<f64> {
    let fit = w.robots.iter().filter(|r| r.fits).count();
    (!w.robots.is_empty()).then(|| fit as f64 / w.robots.len() as f64)
}

/// Returns the mean of each figure over the worlds that have it.
pub fn means<'a>(worlds: impl Iterator<Item = &'a WorldMeasures> + Clone) -> BTreeMap<String, f64> {
    let mean = |figure: &Figure| {
        let (sum, count) = worlds.clone().filter_map(figure.of).fold((0.0, 0u32), |(s, n), v| (s + v, n + 1));
        (count > 0).then(|| (figure.name.to_owned(), round(sum / f64::from(count))))
    };
    FIGURES.iter().filter_map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measure;
    use crate::sample;

    #[test]
    fn figures_are_means_of_those_that_have_them() {
        let (mut world, report) = (sample::world(), sample::report(&[]));
        let sound = measure(&world, Some(&report), "a", &Default::default());
        sample::object_mut(&mut world, "table").pose.z = 0.5;
        let floating = measure(&world, None, "b", &Default::default());
        let found = means([&sound, &floating].into_iter());
        assert_eq!((found["sound"], found["objects"], found["robots"]), (1.0, 5.0, 1.0));
        assert_eq!(found["sup"], 0.8, "table and cup of one of two worlds with five objects");
        assert!(!found.contains_key("time_ms") && !found.contains_key("mandatory"));
    }

    #[test]
    fn almost_all_is_not_printed_as_all() {
        let percent = |v| Percent.text(v);
        assert_eq!(
            (percent(1.0), percent(0.99999), percent(0.5), percent(0.0)),
            ("100 %".into(), "99.99 %".into(), "50.0 %".into(), "0 %".into())
        );
    }
}
