//! Wavefront OBJ with its MTL files.
//!
//! The format has no unit and no axis: lengths are taken as meters and z as up, which plausibility may correct. The box
//! is that of the corners which faces use.

use std::collections::BTreeMap;

use d3dgen_mesh::Material;

use super::builder::{Builder, MAX_POINTS, MAX_TRIANGLES, Piece, fan};
use super::facts::{Feature, ReadModel, Refusal, TextureFact};
use super::folder::Folder;
use super::frame::Matrix;
use super::{Reader, Source};

/// The largest MTL file that is read.
const MAX_MTL_BYTES: u64 = 8 << 20;

/// Reads OBJ.
pub struct Obj;

impl Reader for Obj {
    fn name(&self) -> &'static str {
        "obj"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["obj"]
    }

    fn recognizes(&self, head: &[u8], ending: &str) -> bool {
        ending == "obj" && !head.contains(&0) && !head.trim_ascii_start().starts_with(b"<")
    }

    fn read(&self, source: &Source) -> Result<ReadModel, Refusal> {
        let mut builder = Builder::new("obj");
        match fill(&mut builder, source.bytes, source.folder, &Matrix::IDENTITY, 0) {
            Ok(()) => builder.finish(&source.name),
            Err(refusal) => Err(builder.refuse(refusal)),
        }
    }
}

#[derive(Default)]
struct Text {
    points: Vec<[f64; 3]>,
    uvs: Vec<[f32; 2]>,
    /// Corners of faces as indices of points and texture coordinates, with the material, cut into triangles.
    corners: Vec<([(u32, u32); 3], usize)>,
    /// Objects and groups, each with the first of the triangles that it has.
    parts: Vec<(String, usize)>,
    used: Vec<bool>,
    materials: Vec<String>,
    libraries: Vec<String>,
    objects: u64,
    groups: std::collections::BTreeSet<String>,
    triangles: u64,
    negative: u64,
    ngons: u64,
    missing: u64,
}

/// Reads an OBJ text into a body of a builder, put in place by a matrix.
pub fn fill(builder: &mut Builder, bytes: &[u8], folder: &Folder, place: &Matrix, body: usize) -> Result<(), Refusal> {
    let mut text = parse(&String::from_utf8_lossy(bytes))?;
    if builder.wants_one_part() {
        text.keep_parts(|name| builder.wants(&[name]));
    }
    text.note_used();
    note(builder, &text, place);
    let worn = materials(builder, &text, folder);
    /// Where in a piece a corner stands that is a point with a texture coordinate.
    type Corners = BTreeMap<(u32, u32), u32>;
    // One piece a material, with the corners it uses.
    let mut pieces: BTreeMap<usize, (Piece, Corners)> = BTreeMap::new();
    for (corners, material) in &text.corners {
        let (piece, index) = pieces.entry(*material).or_default();
        let triangle = corners.map(|corner| {
            *index.entry(corner).or_insert_with(|| {
                let point = text.points.get(corner.0 as usize).copied().unwrap_or([f64::NAN; 3]);
                piece.positions.push(point.map(|v| v as f32));
                piece.uvs.push(text.uvs.get(corner.1 as usize).copied().unwrap_or_default());
                piece.positions.len() as u32 - 1
            })
        });
        piece.triangles.push(triangle);
    }
    for (material, (mut piece, _)) in pieces {
        if text.uvs.is_empty() {
            piece.uvs.clear();
        }
        // The first number stands for faces before any material is named.
        let name = material.checked_sub(1).and_then(|m| text.materials.get(m));
        piece.material = name.and_then(|n| worn.get(n).copied());
        piece.name = name.cloned().unwrap_or_default();
        builder.add(body, piece, place)?;
    }
    Ok(())
}

fn parse(content: &str) -> Result<Text, Refusal> {
    let mut text = Text::default();
    let mut material = 0;
    for (number, line) in content.lines().enumerate() {
        let at = |what: &str| Refusal::new(format!("line {}: {what}", number + 1));
        let mut words = line.split_whitespace();
        let Some(key) = words.next() else { continue };
        match key {
            "v" => {
                let mut point = [f64::NAN; 3];
                for value in &mut point {
                    *value = number_of(words.next()).ok_or_else(|| at("`v` needs three numbers"))?;
                }
                text.points.push(point);
            }
            "vt" => {
                let mut next = || number_of(words.next()).unwrap_or(0.0) as f32;
                let uv = [next(), next()];
                text.uvs.push(uv);
            }
            "f" => face(&mut text, words, material).map_err(|what| at(&what))?,
            "usemtl" => {
                let name = rest(line, key);
                let index = text.materials.iter().position(|m| m == name).unwrap_or_else(|| {
                    text.materials.push(name.to_owned());
                    text.materials.len() - 1
                });
                material = index + 1;
            }
            "mtllib" => text.libraries.push(rest(line, key).to_owned()),
            "o" | "g" => {
                text.objects += u64::from(key == "o");
                text.groups.insert(line.trim().to_owned());
                text.parts.push((rest(line, key).to_owned(), text.corners.len()));
            }
            _ => {}
        }
        if text.points.len().max(text.uvs.len()) > MAX_POINTS || text.corners.len() > MAX_TRIANGLES {
            return Err(format!("has more than {MAX_POINTS} corners or {MAX_TRIANGLES} triangles").into());
        }
    }
    Ok(text)
}

impl Text {
    /// Keeps the triangles of some objects and groups.
    fn keep_parts(&mut self, mut is_kept: impl FnMut(&str) -> bool) {
        let ends = self.parts.iter().skip(1).map(|p| p.1).chain([self.corners.len()]);
        let ranges: Vec<(usize, usize)> =
            self.parts.iter().zip(ends).filter(|((name, _), _)| is_kept(name)).map(|((_, a), b)| (*a, b)).collect();
        let all = std::mem::take(&mut self.corners);
        self.corners = ranges.iter().flat_map(|(a, b)| all.get(*a..*b).unwrap_or_default().iter().copied()).collect();
        self.triangles = self.corners.len() as u64;
    }

    /// Notes which points faces use.
    fn note_used(&mut self) {
        self.used.resize(self.points.len(), false);
        for (point, _) in self.corners.iter().flat_map(|(corners, _)| corners) {
            match self.used.get_mut(*point as usize) {
                Some(used) => *used = true,
                None => self.missing += 1,
            }
        }
    }
}

/// Returns what stands behind the first word of a line.
fn rest<'a>(line: &'a str, key: &str) -> &'a str {
    line.trim().get(key.len()..).unwrap_or_default().trim()
}

/// Returns a number; decimal commas, as some programs write, are points.
fn number_of(word: Option<&str>) -> Option<f64> {
    let word = word?;
    word.parse().ok().or_else(|| word.replace(',', ".").parse().ok())
}

fn face<'a>(text: &mut Text, words: impl Iterator<Item = &'a str>, material: usize) -> Result<(), String> {
    let mut corners: Vec<(u32, u32)> = Vec::with_capacity(4);
    for word in words {
        let mut parts = word.split('/');
        let mut index = |count: usize, needed: bool| -> Result<u32, String> {
            let part = parts.next().unwrap_or_default();
            if part.is_empty() && !needed {
                return Ok(u32::MAX);
            }
            let value: i64 = part.parse().map_err(|_| format!("`{}` is no index", super::folder::shortened(part)))?;
            if needed && value < 0 {
                text.negative += 1;
            }
            let index = if value < 0 { count as i64 + value } else { value - 1 };
            // What is not there is counted, and its triangles are left out.
            Ok(u32::try_from(index).unwrap_or(u32::MAX))
        };
        corners.push((index(text.points.len(), true)?, index(text.uvs.len(), false)?));
        if corners.len() > MAX_POINTS {
            return Err("has too many corners".into());
        }
    }
    text.ngons += u64::from(corners.len() > 4);
    text.triangles += corners.len().saturating_sub(2) as u64;
    text.corners.extend(fan(&corners).map(|triangle| (triangle, material)));
    Ok(())
}

fn note(builder: &mut Builder, text: &Text, place: &Matrix) {
    let any = text.used.iter().any(|u| *u);
    for (point, used) in text.points.iter().zip(&text.used) {
        if *used || !any {
            builder.extent.add(place.point(*point));
        }
    }
    let facts = &mut builder.facts;
    facts.mesh_count += text.objects.max(1);
    facts.triangle_count += text.triangles;
    facts.feature("negative_indices", Feature::Count(text.negative));
    facts.feature("ngons", Feature::Count(text.ngons));
    facts.feature("groups", Feature::Count(text.groups.len() as u64));
    if text.missing > 0 {
        facts.warn(format!("{} corners of faces name points that are not there", text.missing));
    }
}

/// Reads the MTL files; returns the index of each material by name.
fn materials(builder: &mut Builder, text: &Text, folder: &Folder) -> BTreeMap<String, usize> {
    let mut worn = BTreeMap::new();
    let mut colors: Vec<(String, [f64; 3])> = Vec::new();
    let mut pictures = std::collections::BTreeSet::new();
    for library in &text.libraries {
        match folder.read(library, MAX_MTL_BYTES) {
            Ok(bytes) => {
                let own = folder.of_named(library).unwrap_or_else(|| folder.clone());
                library_materials(builder, &bytes, &own, &mut worn, &mut colors, &mut pictures);
            }
            Err(refusal) => builder.facts.warn(refusal.reason),
        }
    }
    let facts = &mut builder.facts;
    for name in &text.materials {
        if !facts.material_names.contains(name) {
            facts.material_names.push(name.clone());
        }
    }
    facts.diffuse_colors.extend(colors.iter().filter(|c| text.materials.contains(&c.0)).map(|c| c.1));
    let windows = pictures.iter().any(|p: &String| p.contains('\\') || p.get(1..2) == Some(":"));
    facts.feature("windows_texture_paths", Feature::Flag(windows));
    for path in pictures {
        let resolves = folder.resolve(&path).is_some();
        let fact = TextureFact { path: Some(path), resolves, embedded: None };
        if !facts.textures.contains(&fact) {
            facts.textures.push(fact);
        }
    }
    worn
}

fn library_materials(
    builder: &mut Builder,
    bytes: &[u8],
    folder: &Folder,
    worn: &mut BTreeMap<String, usize>,
    colors: &mut Vec<(String, [f64; 3])>,
    pictures: &mut std::collections::BTreeSet<String>,
) {
    let mut current: Option<usize> = None;
    for line in String::from_utf8_lossy(bytes).lines() {
        let mut words = line.split_whitespace();
        let Some(key) = words.next() else { continue };
        if key == "newmtl" {
            let name = rest(line, key).to_owned();
            builder.materials.push(Material { name: name.clone(), ..Material::default() });
            worn.insert(name, builder.materials.len() - 1);
            current = Some(builder.materials.len() - 1);
            continue;
        }
        let Some(index) = current else { continue };
        let mut three = || -> Option<[f64; 3]> {
            let mut out = [0.0; 3];
            for value in &mut out {
                *value = number_of(words.next()).filter(|v| v.is_finite())?;
            }
            Some(out)
        };
        let is_picture = key.starts_with("map_") || matches!(key, "bump" | "disp" | "norm");
        let path = is_picture.then(|| picture_path(rest(line, key)).to_owned());
        let texture = path.as_ref().filter(|_| key == "map_Kd").map(|p| builder.picture(folder, p));
        let material = &mut builder.materials[index];
        match key {
            "Kd" => {
                if let Some(color) = three() {
                    colors.push((material.name.clone(), color));
                    material.base_color = color.map(|v| v as f32);
                }
            }
            "Ke" => material.emissive = three().unwrap_or_default().map(|v| v as f32),
            "d" => material.opacity = number_of(words.next()).unwrap_or(1.0).clamp(0.0, 1.0) as f32,
            "Tr" => material.opacity = 1.0 - number_of(words.next()).unwrap_or(0.0).clamp(0.0, 1.0) as f32,
            "Pm" => material.metallic = number_of(words.next()).unwrap_or(0.0).clamp(0.0, 1.0) as f32,
            "Pr" => material.roughness = number_of(words.next()).unwrap_or(0.6).clamp(0.0, 1.0) as f32,
            _ => {}
        }
        material.texture = texture.or(material.texture);
        pictures.extend(path);
    }
}

/// Returns the path of a map statement behind its options, such as `-s 1 1 1` or `-bm 0.5`.
fn picture_path(text: &str) -> &str {
    let mut text = text;
    while let Some(option) = text.strip_prefix('-') {
        let letters = option.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(option.len());
        let (name, mut after) = option.split_at(letters);
        if name.is_empty() || !after.starts_with(char::is_whitespace) {
            break;
        }
        loop {
            let trimmed = after.trim_start();
            let end = trimmed.find(char::is_whitespace).unwrap_or(trimmed.len());
            let (word, behind) = trimmed.split_at(end);
            let numeric =
                !word.is_empty() && word.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'+' | b'-'));
            if !numeric || behind.is_empty() {
                after = trimmed;
                break;
            }
            after = behind;
        }
        text = after;
    }
    text
}
