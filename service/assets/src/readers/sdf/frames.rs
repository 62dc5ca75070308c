//! The poses of links, joints and models in the frame of their model, through `relative_to` and frames of their own.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::{children, numbers, words};
use crate::readers::frame::Matrix;

/// The longest chain of frames.
const MAX_CHAIN: usize = 64;

/// Named frames: each with the frame it is in, and its pose there.
pub struct Frames {
    named: BTreeMap<String, (Option<String>, Matrix)>,
    /// Those of the models in the model.
    models: BTreeMap<String, Frames>,
}

impl Frames {
    /// Reads the frames of a model, without those of the models in it.
    pub fn of(model: Node) -> Self {
        let mut named = BTreeMap::new();
        for (kind, other) in [("link", None), ("frame", Some("attached_to")), ("joint", None)] {
            for element in children(model, kind) {
                let Some(name) = element.attribute("name") else { continue };
                let (relative, matrix) = pose(element);
                // A joint is where its child is; a frame where it is attached.
                let by_kind = match kind {
                    "joint" => words(element, "child").map(str::to_owned),
                    _ => other.and_then(|o| element.attribute(o)).map(str::to_owned),
                };
                named.entry(name.to_owned()).or_insert((relative.or(by_kind), matrix));
            }
        }
        Self { named, models: BTreeMap::new() }
    }

    /// Adds a model in the model: the element that has its pose, what undoes the frame that the pose is of, and its own
    /// frames.
    pub fn add_model(&mut self, name: &str, posed: Node, back: &Matrix, frames: Frames) {
        let (relative, matrix) = pose(posed);
        self.named.entry(name.to_owned()).or_insert((relative, matrix * *back));
        self.models.insert(name.to_owned(), frames);
    }

    /// Returns the matrix from a link, joint, frame or model to this model.
    pub fn place(&self, name: &str) -> Matrix {
        self.resolved(Some(name), 0)
    }

    /// Returns the matrix from an element in a link to that link.
    pub fn pose(&self, element: Node, link: Option<&str>) -> Matrix {
        let (relative, matrix) = pose(element);
        match (relative, link) {
            (Some(frame), Some(link)) if frame != link => {
                let model_from_link = self.resolved(Some(link), 0);
                let link_from_model = model_from_link.inverse().unwrap_or(Matrix::IDENTITY);
                link_from_model * self.resolved(Some(&frame), 0) * matrix
            }
            _ => matrix,
        }
    }

    fn resolved(&self, name: Option<&str>, steps: usize) -> Matrix {
        let Some(name) = name.filter(|_| steps < MAX_CHAIN) else { return Matrix::IDENTITY };
        if let Some((parent, matrix)) = self.named.get(name) {
            return self.resolved(parent.as_deref(), steps + 1) * *matrix;
        }
        match name.split_once("::") {
            Some((model, rest)) => match self.models.get(model) {
                Some(inner) => self.resolved(Some(model), steps + 1) * inner.resolved(Some(rest), steps + 1),
                None => Matrix::IDENTITY,
            },
            None => Matrix::IDENTITY,
        }
    }
}

fn pose(element: Node) -> (Option<String>, Matrix) {
    let Some(pose) = super::child(element, "pose") else { return (None, Matrix::IDENTITY) };
    let mut values = numbers(pose.text().unwrap_or_default());
    let turn = match (pose.attribute("rotation_format"), values.as_slice()) {
        (Some("quat_xyzw"), &[_, _, _, x, y, z, w]) => Matrix::rotation([x, y, z, w]),
        _ => {
            values.resize(6, 0.0);
            let unit = if pose.attribute("degrees") == Some("true") { std::f64::consts::PI / 180.0 } else { 1.0 };
            Matrix::roll_pitch_yaw([values[3], values[4], values[5]].map(|v| v * unit))
        }
    };
    let relative = pose.attribute("relative_to").filter(|r| !r.is_empty() && *r != "__model__").map(str::to_owned);
    (relative, Matrix::translation([values[0], values[1], values[2]]) * turn)
}
