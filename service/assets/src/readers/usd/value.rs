//! Values of attributes as plain numbers and texts, at the earliest time.

use openusd::sdf::Value;
use openusd::usd::{Prim, TimeCode};

use crate::readers::frame::Matrix;

/// Returns the value of an attribute at the earliest time.
pub fn value(prim: &Prim, name: &str) -> Option<Value> {
    prim.attribute(name).get_at::<Value>(TimeCode::EARLIEST).ok().flatten()
}

/// Returns a word.
pub fn token(value: &Value) -> Option<String> {
    match value {
        Value::Token(token) => Some(token.as_str().to_owned()),
        Value::String(text) => Some(text.clone()),
        _ => None,
    }
}

/// Returns a word that an attribute has.
pub fn token_of(prim: &Prim, name: &str) -> Option<String> {
    value(prim, name).as_ref().and_then(token)
}

/// Returns words.
pub fn tokens(value: Value) -> Vec<String> {
    match value {
        Value::TokenVec(tokens) => tokens.iter().map(|t| t.as_str().to_owned()).collect(),
        Value::StringVec(texts) => texts,
        _ => Vec::new(),
    }
}

/// Returns a number.
pub fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Double(v) => Some(*v),
        Value::Float(v) => Some(f64::from(*v)),
        Value::Half(v) => Some(f64::from(v.to_f32())),
        Value::Int(v) => Some(f64::from(*v)),
        Value::Uint(v) => Some(f64::from(*v)),
        Value::Int64(v) => Some(*v as f64),
        Value::Uint64(v) => Some(*v as f64),
        _ => None,
    }
}

/// Returns a number that an attribute has.
pub fn number_of(prim: &Prim, name: &str) -> Option<f64> {
    value(prim, name).as_ref().and_then(number)
}

/// Returns three numbers.
pub fn three(value: &Value) -> Option<[f64; 3]> {
    match value {
        Value::Vec3d(v) => Some([v.x, v.y, v.z]),
        Value::Vec3f(v) => Some([v.x, v.y, v.z].map(f64::from)),
        Value::Vec3h(v) => Some([v.x, v.y, v.z].map(|v| f64::from(v.to_f32()))),
        _ => None,
    }
}

/// Returns a list of three numbers each.
pub fn threes(value: Value) -> Option<Vec<[f32; 3]>> {
    match value {
        Value::Vec3fVec(v) => Some(v.into_iter().map(|v| [v.x, v.y, v.z]).collect()),
        Value::Vec3dVec(v) => Some(v.into_iter().map(|v| [v.x as f32, v.y as f32, v.z as f32]).collect()),
        Value::Vec3hVec(v) => Some(v.into_iter().map(|v| [v.x.to_f32(), v.y.to_f32(), v.z.to_f32()]).collect()),
        _ => None,
    }
}

/// Returns a list of two numbers each.
pub fn twos(value: Value) -> Option<Vec<[f32; 2]>> {
    match value {
        Value::Vec2fVec(v) => Some(v.into_iter().map(|v| [v.x, v.y]).collect()),
        Value::Vec2dVec(v) => Some(v.into_iter().map(|v| [v.x as f32, v.y as f32]).collect()),
        Value::Vec2hVec(v) => Some(v.into_iter().map(|v| [v.x.to_f32(), v.y.to_f32()]).collect()),
        _ => None,
    }
}

/// Returns a list of integers.
pub fn integers(value: Option<Value>) -> Vec<i64> {
    match value {
        Some(Value::IntVec(v)) => v.into_iter().map(i64::from).collect(),
        Some(Value::UintVec(v)) => v.into_iter().map(i64::from).collect(),
        Some(Value::Int64Vec(v)) => v,
        _ => Vec::new(),
    }
}

/// Returns a list of numbers.
pub fn numbers(value: Option<Value>) -> Vec<f64> {
    match value {
        Some(Value::FloatVec(v)) => v.into_iter().map(f64::from).collect(),
        Some(Value::DoubleVec(v)) => v,
        Some(Value::HalfVec(v)) => v.into_iter().map(|v| f64::from(v.to_f32())).collect(),
        _ => Vec::new(),
    }
}

/// Returns quaternions as x, y, z, w.
pub fn quaternions(value: Option<Value>) -> Vec<[f64; 4]> {
    match value {
        Some(Value::QuathVec(v)) => {
            v.into_iter().map(|q| [q.x, q.y, q.z, q.w].map(|v| f64::from(v.to_f32()))).collect()
        }
        Some(Value::QuatfVec(v)) => v.into_iter().map(|q| [q.x, q.y, q.z, q.w].map(f64::from)).collect(),
        Some(Value::QuatdVec(v)) => v.into_iter().map(|q| [q.x, q.y, q.z, q.w]).collect(),
        _ => Vec::new(),
    }
}

/// Returns the matrix from a prim to its parent, and whether the prim leaves its parent's matrix aside.
pub fn local_matrix(prim: &Prim) -> (Matrix, bool) {
    let order = prim.attribute("xformOpOrder").get::<Value>().ok().flatten().map(tokens).unwrap_or_default();
    let reset = order.iter().rposition(|op| op == "!resetXformStack!");
    let mut matrix = Matrix::IDENTITY;
    for op in order.iter().skip(reset.map_or(0, |at| at + 1)) {
        let (inverted, name) = match op.strip_prefix("!invert!") {
            Some(name) => (true, name),
            None => (false, op.as_str()),
        };
        // An order may name what is not there; the rest of it still holds.
        let Some(one) = value(prim, name).and_then(|v| operation(name, &v)) else { continue };
        let one = if inverted { one.inverse().unwrap_or(Matrix::IDENTITY) } else { one };
        matrix = matrix * one;
    }
    (matrix, reset.is_some())
}

fn operation(name: &str, value: &Value) -> Option<Matrix> {
    let kind = name.strip_prefix("xformOp:")?.split(':').next()?;
    const AXES: [[f64; 3]; 3] = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let along = |axis: usize, rest: f64| -> Option<[f64; 3]> {
        let length = number(value)?;
        Some(std::array::from_fn(|i| if i == axis { length } else { rest }))
    };
    let turn = |axis: usize, degrees: f64| Matrix::axis_angle(AXES[axis], degrees.to_radians());
    let matrix = match kind {
        "translate" => Matrix::translation(three(value)?),
        "translateX" => Matrix::translation(along(0, 0.0)?),
        "translateY" => Matrix::translation(along(1, 0.0)?),
        "translateZ" => Matrix::translation(along(2, 0.0)?),
        "scale" => Matrix::scale(three(value)?),
        "scaleX" => Matrix::scale(along(0, 1.0)?),
        "scaleY" => Matrix::scale(along(1, 1.0)?),
        "scaleZ" => Matrix::scale(along(2, 1.0)?),
        "rotateX" => turn(0, number(value)?),
        "rotateY" => turn(1, number(value)?),
        "rotateZ" => turn(2, number(value)?),
        "orient" => Matrix::rotation(unit(match value {
            Value::Quatd(q) => [q.x, q.y, q.z, q.w],
            Value::Quatf(q) => [q.x, q.y, q.z, q.w].map(f64::from),
            Value::Quath(q) => [q.x, q.y, q.z, q.w].map(|v| f64::from(v.to_f32())),
            _ => return None,
        })),
        "transform" => match value {
            Value::Matrix4d(matrix) => Matrix::from_columns(matrix.0),
            _ => return None,
        },
        _ => {
            // Euler angles: the letters say which turn comes first.
            let letters = kind.strip_prefix("rotate").filter(|l| l.len() == 3)?;
            let angles = three(value)?;
            let mut matrix = Matrix::IDENTITY;
            for letter in letters.bytes() {
                let axis = usize::from(letter.checked_sub(b'X').filter(|a| *a < 3)?);
                matrix = turn(axis, angles[axis]) * matrix;
            }
            matrix
        }
    };
    Some(matrix)
}

/// Returns a quaternion of unit length.
pub fn unit(q: [f64; 4]) -> [f64; 4] {
    let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length > 0.0 { q.map(|v| v / length) } else { [0., 0., 0., 1.] }
}
