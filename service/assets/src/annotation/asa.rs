//! ASA annotation files of Arena (`annotation.yaml` beside a model): read with care, written in one form.
//!
//! Old files have bare tags and lists for colors, materials and interactions; they are taken too. Reading stops at sizes
//! that no annotation has.

use std::fmt::Write as _;

use d3dgen_model::domain::Mount;
use serde::Deserialize;

use super::{Annotation, FrontAxis};

/// Larger files are no annotation, bytes.
const LARGEST: usize = 1 << 20;

/// What a metadata file says; what it leaves out is none or empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Asa {
    /// Name of the asset.
    pub name: Option<String>,
    /// Free description.
    pub description: Option<String>,
    /// Note of the author.
    pub note: Option<String>,
    /// Bounding box, m, in the model frame of the file.
    pub bounding_box_m: Option<[[f64; 2]; 3]>,
    /// Front axis.
    pub face: Option<FrontAxis>,
    /// Path below the library, without the domain.
    pub path: Option<String>,
    /// `key::value` tags in their order; bare ones have an empty key.
    pub tags: Vec<(String, String)>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Raw {
    name: Option<String>,
    desc: Option<String>,
    description: Option<String>,
    note: Option<String>,
    path: Option<String>,
    face: Option<serde_json::Value>,
    bounding_box: Option<Vec<Vec<f64>>>,
    tags: Option<Vec<String>>,
    tag: Option<Vec<String>>,
    color: Option<OneOrMany>,
    material: Option<OneOrMany>,
    hoi: Option<OneOrMany>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

impl OneOrMany {
    fn list(self) -> Vec<String> {
        match self {
            Self::One(text) => vec![text],
            Self::Many(list) => list,
        }
    }
}

/// Reads an annotation file.
///
/// # Errors
/// What is wrong, for people: too large, no YAML, or fields of another form.
pub fn read(text: &str) -> Result<Asa, String> {
    if text.len() > LARGEST {
        return Err(format!("is {} bytes, an annotation has at most {LARGEST}", text.len()));
    }
    let raw: Raw = serde_saphyr::from_str(text).map_err(|e| format!("is no ASA annotation: {e}"))?;
    let filled = |text: Option<String>| text.map(|t| t.trim().to_owned()).filter(|t| !t.is_empty());
    let bounding_box_m = raw.bounding_box.as_deref().and_then(|rows| match rows {
        [x, y, z] => {
            let pair = |row: &Vec<f64>| match row[..] {
                [a, b] if a.is_finite() && b.is_finite() && a <= b => Some([a, b]),
                _ => None,
            };
            Some([pair(x)?, pair(y)?, pair(z)?])
        }
        _ => None,
    });
    let face = raw.face.and_then(|v| match v {
        serde_json::Value::String(name) => FrontAxis::from_name(&name),
        other => FrontAxis::from_name(&other.to_string()),
    });
    let mut tags: Vec<(String, String)> = Vec::new();
    let all = raw.tags.into_iter().chain(raw.tag).flatten();
    for tag in all {
        tags.push(match tag.rsplit_once("::") {
            Some((key, value)) => (word(key), word(value)),
            None => (String::new(), word(&tag)),
        });
    }
    for (key, list) in [("color", raw.color), ("material", raw.material), ("hoi", raw.hoi)] {
        tags.extend(list.map(OneOrMany::list).unwrap_or_default().iter().map(|value| (key.to_owned(), word(value))));
    }
    tags.retain(|(_, value)| !value.is_empty());
    Ok(Asa {
        name: filled(raw.name),
        description: filled(raw.desc).or(filled(raw.description)),
        note: filled(raw.note),
        bounding_box_m,
        face,
        path: filled(raw.path),
        tags,
    })
}

impl Asa {
    /// Returns the values of a facet, in their order.
    pub fn values<'a>(&'a self, key: &'a str) -> impl Iterator<Item = &'a str> {
        self.tags.iter().filter(move |(k, _)| k == key).map(|(_, value)| value.as_str())
    }
}

/// Returns the annotation as an ASA file.
pub fn write(annotation: &Annotation) -> String {
    let mut out = String::from("asa: 1\n");
    let quoted = |text: &str| serde_json::to_string(text).unwrap_or_default();
    out += "bounding_box:\n";
    for [low, high] in annotation.bounding_box_m {
        let _ = writeln!(out, "- [{low:.4}, {high:.4}]");
    }
    let _ = writeln!(out, "desc: {}", quoted(&annotation.description));
    let _ = writeln!(out, "face: {}", quoted(annotation.front.axis.name()));
    let name = annotation.asset_id.rsplit('/').next().unwrap_or_default();
    let _ = writeln!(out, "name: {name}\nnote: {}\npath: Object/{name}\ntags:", quoted(&note(annotation)));
    for tag in tags(annotation) {
        let _ = writeln!(out, "- {tag}");
    }
    out
}

/// Returns the tags of the ASA standard, `key::value`.
pub fn tags(annotation: &Annotation) -> Vec<String> {
    let mut tags: Vec<String> = Vec::new();
    let mut add = |key: &str, value: &str| {
        let tag = format!("{key}::{}", word(value));
        if !tags.contains(&tag) {
            tags.push(tag);
        }
    };
    annotation.domains.iter().for_each(|d| add("domain", d));
    add("kind", &annotation.kind);
    add("mount", mount_name(annotation.mount));
    annotation.affordances.iter().for_each(|a| add("hoi", a));
    annotation.palette.iter().for_each(|s| add("color", &s.name));
    annotation.materials.iter().for_each(|m| add("material", m));
    annotation.room_types.iter().for_each(|r| add("room", r));
    for tag in &annotation.tags {
        match tag.rsplit_once("::") {
            Some((key, value)) => add(key, value),
            None => add("tag", tag),
        }
    }
    tags
}

/// Returns the word that ASA uses.
pub fn mount_name(mount: Mount) -> &'static str {
    match mount {
        Mount::Floor => "floor",
        Mount::Wall => "wall",
        Mount::Ceiling => "ceiling",
        Mount::Surface => "surface",
    }
}

/// Returns the mount of an ASA word.
pub fn mount_from_name(name: &str) -> Option<Mount> {
    [Mount::Floor, Mount::Wall, Mount::Ceiling, Mount::Surface].into_iter().find(|m| mount_name(*m) == name)
}

fn note(annotation: &Annotation) -> String {
    let changes = annotation.changes.iter().map(|c| format!("{} {} -> {}", c.what, c.from, c.to));
    changes.collect::<Vec<_>>().join("; ")
}

/// Returns a tag segment: lower case, `[a-z0-9_]`, with the colons that part keys.
fn word(text: &str) -> String {
    let kept = text.trim().chars().map(|c| match c {
        'a'..='z' | '0'..='9' | '_' | ':' => c,
        'A'..='Z' => c.to_ascii_lowercase(),
        _ => '_',
    });
    kept.collect::<String>().trim_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_all_ages_are_read() {
        let new = read(
            "asa: 1\nbounding_box:\n- [-0.5, 0.5]\n- [-1.05, 1.05]\n- [0.0, 1.1]\ndesc: A bed.\nface: -y\n\
             name: Patient_Bed_A\nnote: ''\npath: Object/Patient_Bed_A\ntags:\n- domain::hospital\n- hoi::lie\n- white\n",
        )
        .expect("current form");
        assert_eq!((new.face, &new.note), (Some(FrontAxis::MinusY), &None));
        assert_eq!(new.bounding_box_m.map(|b| b[2]), Some([0.0, 1.1]));
        assert_eq!(new.values("hoi").collect::<Vec<_>>(), ["lie"]);
        assert_eq!(new.values("").collect::<Vec<_>>(), ["white"]);
        let old = read(
            "name: x\ndescription: old\nface: 90\ncolor: [Red, 'dark blue']\nhoi: sit\ntags: [bare]\nlights: []\n",
        );
        let old = old.expect("legacy form");
        assert_eq!(old.face, Some(FrontAxis::MinusY));
        assert_eq!(old.values("color").collect::<Vec<_>>(), ["red", "dark_blue"]);
        assert_eq!(read("face: 135\n").expect("angle").face, Some(FrontAxis::Any));
        assert_eq!(read("face: sideways\n").expect("garbage").face, None);
    }

    #[test]
    fn what_is_no_annotation_is_refused() {
        for text in ["[1, 2", "name: [a, b]\n", "bounding_box: yes\n", &"x".repeat(LARGEST + 1)] {
            assert!(read(text).is_err(), "{:.40}", text);
        }
        let bomb = "a: &a [x,x,x,x,x,x,x,x,x]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a]\nc: &c [*b,*b,*b,*b,*b,*b,*b,*b,*b]\n\
                    d: &d [*c,*c,*c,*c,*c,*c,*c,*c,*c]\ne: &e [*d,*d,*d,*d,*d,*d,*d,*d,*d]\nname: n\n";
        let _ = read(bomb); // ends, whatever it says
    }
}
