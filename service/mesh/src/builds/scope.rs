//! What names stand for while a build is made at a size.

use std::cell::RefCell;
use std::collections::BTreeMap;

use d3dgen_model::domain::{Build, Formula};
use d3dgen_model::seed::Stream;

use super::size_text;
use crate::error::Error;

/// The figures of a build at a size.
pub(super) struct Scope<'a> {
    pub build: &'a Build,
    pub size: [f64; 3],
    figures: BTreeMap<&'a str, f64>,
}

/// The figures with the number of a copy.
#[derive(Clone, Copy)]
pub(super) struct Local<'a> {
    pub scope: &'a Scope<'a>,
    pub i: usize,
    pub n: usize,
}

impl<'a> Scope<'a> {
    /// Draws the choices and works out the measures.
    ///
    /// # Errors
    /// `Build` with the measure that has no figure.
    pub fn new(build: &'a Build, size: [f64; 3], seed: u64) -> Result<Self, Error> {
        let mut figures = BTreeMap::from([("w", size[0]), ("d", size[1]), ("h", size[2])]);
        for (name, values) in &build.choices {
            let at = if seed == 0 { 0 } else { Stream::new(seed, &format!("{}/{name}", build.id)).below(values.len()) };
            figures.insert(name.as_str(), values.get(at).copied().unwrap_or_default());
        }
        let mut scope = Self { build, size, figures };
        let mut left: Vec<(&str, &Formula)> = build.measures.iter().map(|(name, f)| (name.as_str(), f)).collect();
        while !left.is_empty() {
            let before = left.len();
            left.retain(|(name, formula)| {
                let value = formula.evaluate(&|name| scope.figures.get(name).copied());
                value.map(|v| scope.figures.insert(name, v)).is_none() && value.is_none()
            });
            if left.len() == before {
                let (name, formula) = left[0];
                return Err(scope.error(format!("let {name}"), format!("`{formula}` has no value here")));
            }
        }
        Ok(scope)
    }

    pub fn error(&self, place: impl Into<String>, reason: impl Into<String>) -> Error {
        Error::Build {
            build: self.build.id.clone(),
            size: size_text(self.size),
            place: place.into(),
            reason: reason.into(),
        }
    }

    pub fn local(&'a self, i: usize, n: usize) -> Local<'a> {
        Local { scope: self, i, n }
    }
}

impl Local<'_> {
    /// Returns the value of a formula.
    ///
    /// # Errors
    /// `Build` with the place and the name that has no figure.
    pub fn value(&self, formula: &Formula, place: &dyn Fn() -> String) -> Result<f64, Error> {
        let unknown = RefCell::new(None);
        let figure = |name: &str| match name {
            "i" => Some(self.i as f64),
            "n" => Some(self.n as f64),
            _ => {
                let figure = self.scope.figures.get(name).copied();
                if figure.is_none() {
                    unknown.borrow_mut().get_or_insert_with(|| name.to_owned());
                }
                figure
            }
        };
        formula.evaluate(&figure).ok_or_else(|| {
            let reason = match unknown.borrow().as_deref() {
                Some(name) if !name.is_empty() => format!("`{formula}` names `{name}`, which is no measure"),
                _ => format!("`{formula}` has no value here"),
            };
            self.scope.error(place(), reason)
        })
    }

    /// Returns the values of a list of formulas.
    ///
    /// # Errors
    /// As [`Self::value`].
    pub fn values<const N: usize>(
        &self,
        formulas: &[Formula; N],
        place: &dyn Fn() -> String,
    ) -> Result<[f64; N], Error> {
        let mut out = [0.0; N];
        for (k, (formula, value)) in formulas.iter().zip(&mut out).enumerate() {
            *value = self.value(formula, &|| format!("{}/{k}", place()))?;
        }
        Ok(out)
    }
}
