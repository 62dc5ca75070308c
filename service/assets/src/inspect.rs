//! One line about a file, without storing it: what `assets inspect` prints.
//!
//! What it is not for: reading the file; that is `readers`.

use serde_json::{Map, Value, json};

use crate::readers::{Facts, ReadModel, Refusal};

/// Returns the line of a file: `file`, `ok`, `error` and the facts, which mean what they mean in the file's own format,
/// and the annotation, when there is one. A file that is refused has as many facts as could be found.
pub fn line(file: &str, result: &Result<ReadModel, Refusal>, annotation: Value) -> Value {
    let mut line = Map::new();
    let (facts, error) = match result {
        Ok(read) => (Some(&read.facts), Value::Null),
        Err(refusal) => (refusal.facts.as_deref(), json!(format!("{file}: {}", refusal.reason))),
    };
    line.insert("file".into(), json!(file));
    line.insert("ok".into(), json!(result.is_ok()));
    line.insert("error".into(), error);
    let none = Facts::default();
    let facts_or_none = facts.unwrap_or(&none);
    for (key, value) in fields(facts_or_none) {
        line.insert(key.into(), if facts.is_some() { value } else { Value::Null });
    }
    line.insert("annotation".into(), annotation);
    Value::Object(line)
}

fn fields(facts: &Facts) -> Vec<(&'static str, Value)> {
    let textures: Vec<Value> = facts.textures.iter().map(|t| t.to_json()).collect();
    let features: Map<String, Value> = facts.features.iter().map(|(k, v)| (k.clone(), v.to_json())).collect();
    vec![
        ("format", json!(facts.format)),
        ("up_axis", json!(facts.up_axis)),
        ("up_axis_authored", json!(facts.up_axis_authored)),
        ("meters_per_unit", json!(facts.meters_per_unit)),
        ("meters_per_unit_authored", json!(facts.meters_per_unit_authored)),
        ("bbox_stage", json!(facts.bbox_stage.map(|b| b.map(rounded)))),
        ("bbox_zup", json!(facts.bbox_zup.map(|b| b.map(rounded)))),
        ("size_zup", json!(facts.size_zup().map(rounded))),
        ("mesh_count", json!(facts.mesh_count)),
        ("triangle_count", json!(facts.triangle_count)),
        ("material_names", json!(facts.material_names)),
        ("diffuse_colors", json!(facts.diffuse_colors.iter().map(|c| rounded(*c)).collect::<Vec<_>>())),
        ("textures", Value::Array(textures)),
        ("features", Value::Object(features)),
        ("warnings", json!(facts.warnings)),
    ]
}

/// Returns numbers to the micrometer, which is finer than anything that is compared.
fn rounded(values: [f64; 3]) -> [f64; 3] {
    values.map(|v| (v * 1e6).round() / 1e6 + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_file_says_why_and_what_is_known() {
        let refusal = Refusal::new("is empty: 0 bytes");
        let value = line("a/b.usdz", &Err(refusal.clone()), Value::Null);
        assert_eq!(value["error"], "a/b.usdz: is empty: 0 bytes");
        assert_eq!((&value["ok"], &value["mesh_count"]), (&json!(false), &Value::Null));
        let facts = Facts { mesh_count: 2, bbox_zup: Some([[0.; 3], [1., 2., 0.1234567]]), ..Facts::default() };
        let value = line("c", &Err(Refusal { facts: Some(Box::new(facts)), ..refusal }), Value::Null);
        assert_eq!((&value["mesh_count"], &value["size_zup"]), (&json!(2), &json!([1.0, 2.0, 0.123457])));
    }
}
