//! Messages whose JSON is no object with a key for each field.

/// The JSON of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// An object with a key for each field.
    Object,
    /// An array with a place for each field.
    Tuple,
    /// The list that is its only field.
    List,
    /// What its set field holds, told apart by the kind of JSON.
    Plain,
    /// An object whose key of this name says which field is set; the other keys are that field's.
    Tagged(&'static str),
}

/// Every message that is no object.
const FORMS: &[(&str, Form)] = &[
    ("AreaLimits", Form::Tuple),
    ("AssetOrigin", Form::Tagged("from")),
    ("Bounds", Form::Tuple),
    ("ConstraintValue", Form::Plain),
    ("Corner", Form::Tuple),
    ("Direction", Form::Tuple),
    ("Extent", Form::Tuple),
    ("Formula", Form::Plain),
    ("FormulaPair", Form::Tuple),
    ("FormulaPoint", Form::Tuple),
    ("FormulaSpan", Form::Tuple),
    ("GroupSizes", Form::Tuple),
    ("Inertia", Form::Tuple),
    ("JointLimits", Form::Tuple),
    ("NumberList", Form::List),
    ("Polygon", Form::List),
    ("RoomPair", Form::Tuple),
    ("Sides", Form::Tuple),
    ("Size", Form::Tuple),
    ("Stretch", Form::Tuple),
    ("StringList", Form::List),
    ("TimeSpan", Form::Tuple),
    ("Transform", Form::Tuple),
    ("TransformRow", Form::Tuple),
    ("ValueList", Form::List),
    ("ValueTable", Form::List),
    ("Vector", Form::Tuple),
];

/// Words of documents that no name of an enum value can be.
const SIGNS: &[(&str, &str)] = &[("minus_", "-"), ("plus_", "+")];

/// Returns the form of a message.
pub fn of(message: &str) -> Form {
    FORMS.iter().find(|(name, _)| *name == message).map_or(Form::Object, |(_, form)| *form)
}

/// Returns the word of a document for an enum value without its prefix: `MINUS_X` is `-x`.
pub fn word(value: &str) -> String {
    let mut word = value.to_ascii_lowercase();
    for (spoken, sign) in SIGNS {
        word = word.replace(spoken, sign);
    }
    word
}

/// Returns the field of a plain message for a JSON value; none for what no document holds.
pub fn plain(message: &str, value: &serde_json::Value) -> Option<&'static str> {
    use serde_json::Value;
    let formula = message == "Formula";
    Some(match value {
        Value::Number(n) if !formula && n.is_i64() => "whole_number",
        Value::Number(_) => "number",
        Value::String(_) => "text",
        Value::Bool(_) if !formula => "flag",
        Value::Array(_) if !formula => "list",
        Value::Object(o) if !formula => match (o.len(), o.get("min"), o.get("max"), o.get("expr")) {
            (2, Some(Value::Number(_)), Some(Value::Number(_)), _) => "range",
            (1, _, _, Some(Value::String(_))) => "expression",
            _ => "table",
        },
        _ => return None,
    })
}

/// Key of the object around a plain value, where it has one.
pub const EXPRESSION: (&str, &str) = ("expression", "expr");
