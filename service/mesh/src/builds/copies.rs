//! Copies of parts and bodies: repeated along a way or around an upright line, and mirrored.

use d3dgen_model::domain::{Mirror, Repeat};

use super::scope::Scope;
use crate::affine::{Affine, scale};
use crate::error::Error;

/// Most copies of one part or joint.
const MOST: f64 = 500.0;

/// Returns the moves of the copies; one that does nothing when there is no `repeat`.
///
/// # Errors
/// `Build` when the count is too large or a formula has no value.
pub(super) fn repeats(scope: &Scope<'_>, repeat: Option<&Repeat>, place: &str) -> Result<Vec<Affine>, Error> {
    let Some(repeat) = repeat else { return Ok(vec![Affine::IDENTITY]) };
    let local = scope.local(0, 1);
    let at = |field: &'static str| move || format!("{place}, repeat/{field}");
    let count = local.value(&repeat.count, &at("count"))?.round();
    if count > MOST {
        return Err(scope.error(at("count")(), format!("is {count}, the limit is {MOST}")));
    }
    let count = count.max(0.0) as usize;
    let step = repeat.step.as_ref().map(|s| local.values(s, &at("step"))).transpose()?.unwrap_or_default();
    let around = repeat.around.as_ref().map(|a| local.values(a, &at("around"))).transpose()?;
    let number = |formula: &Option<_>, field, other: f64| match formula {
        Some(formula) => local.value(formula, &at(field)),
        None => Ok(other),
    };
    let start = number(&repeat.start_deg, "start_deg", 0.0)?;
    let span = number(&repeat.span_deg, "span_deg", 360.0)?;
    // A full turn ends where it begins; a part of one has a copy at each end.
    let pieces = if span.abs() >= 360.0 { count } else { count.saturating_sub(1).max(1) };
    Ok((0..count)
        .map(|i| {
            let shift = Affine::shift(scale(step, i as f64));
            match around {
                None => shift,
                Some([x, y]) => {
                    let deg = start + span * i as f64 / pieces as f64;
                    shift.after(&Affine::turn(2, deg, [x, y, 0.0]))
                }
            }
        })
        .collect())
}

/// Returns the reflections of a mirrored part, first the one that does nothing.
pub(super) fn mirrors(scope: &Scope<'_>, mirror: Option<Mirror>) -> Vec<Affine> {
    let x = Affine::mirror(0, scope.size[0]);
    let y = Affine::mirror(1, scope.size[1]);
    match mirror {
        None => vec![Affine::IDENTITY],
        Some(Mirror::X) => vec![Affine::IDENTITY, x],
        Some(Mirror::Y) => vec![Affine::IDENTITY, y],
        Some(Mirror::Xy) => vec![Affine::IDENTITY, x, y, x.after(&y)],
    }
}
