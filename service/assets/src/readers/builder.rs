//! Collects what a reader finds into a model, within bounds, and judges at the end whether it is one.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use d3dgen_mesh::{Body, Collision, Joint, Material, Mesh, Model3d, Texture, Visual};

use super::facts::{Bounds, Facts, Feature, ReadModel, Refusal};
use super::folder::{Folder, MAX_PICTURE_BYTES};
use super::frame::{Extent, Matrix, turned};

/// The most triangles of a model.
pub const MAX_TRIANGLES: usize = 4_000_000;
/// The most corners of a model, and of one list in a file.
pub const MAX_POINTS: usize = 8_000_000;
/// The most pieces of a model.
const MAX_VISUALS: usize = 50_000;
/// The most bytes of all pictures that are kept with a model.
const MAX_PICTURES_BYTES: u64 = 48 << 20;
/// The most names of parts that are kept for a message.
const MAX_NAMES: usize = 100;
/// Larger things are no objects but errors of numbers, m.
const LARGEST_M: f64 = 1e6;
/// Smaller things are not there, m.
const SMALLEST_M: f64 = 1e-9;

/// So far from the origin a number of 32 bits is a millimeter off.
const FAR_M: f64 = 1e4;
/// The most pixels of a picture that is kept.
const MAX_PIXELS: u64 = 128 << 20;

/// Triangles as a reader finds them, in a frame of their own.
#[derive(Debug, Default)]
pub struct Piece {
    /// Name, unchecked.
    pub name: String,
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// One a position, v up, or none.
    pub uvs: Vec<[f32; 2]>,
    /// Indices, unchecked.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the material.
    pub material: Option<usize>,
}

/// Collects a model.
#[derive(Debug)]
pub struct Builder {
    /// What the file says.
    pub facts: Facts,
    /// The box of what is seen, in the axes and units of the file.
    pub extent: Extent,
    /// Materials so far.
    pub materials: Vec<Material>,
    /// How the bodies beyond the first move.
    pub joints: Vec<Joint>,
    /// The one part of a mesh file that is wanted, while such a file is read.
    wanted: Option<WantedPart>,
    textures: Vec<Texture>,
    by_path: BTreeMap<String, usize>,
    picture_bytes: u64,
    bodies: Vec<Body>,
    triangles: usize,
    points: usize,
    visuals: usize,
    dropped: usize,
    /// Turns the axes of the file to z up, in meters.
    zup_from_file: Matrix,
    meters_per_unit: f64,
}

/// A part of a mesh file that is asked for by its name.
#[derive(Debug, Default)]
struct WantedPart {
    name: String,
    is_found: bool,
    /// The other parts there are.
    others: BTreeSet<String>,
}

/// Returns the triangles of a polygon, as a fan around its first corner; none of fewer than three corners.
pub fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])
}

impl Builder {
    /// Returns an empty one for a format without axis and unit.
    pub fn new(format: &str) -> Self {
        Self {
            facts: Facts { format: format.to_owned(), ..Facts::default() },
            extent: Extent::default(),
            materials: Vec::new(),
            joints: Vec::new(),
            wanted: None,
            textures: Vec::new(),
            by_path: BTreeMap::new(),
            picture_bytes: 0,
            bodies: vec![Body { name: "body".into(), ..Body::default() }],
            triangles: 0,
            points: 0,
            visuals: 0,
            dropped: 0,
            zup_from_file: Matrix::IDENTITY,
            meters_per_unit: 1.0,
        }
    }

    /// Notes the axis that points up and the unit, each with whether the file says so.
    ///
    /// # Errors
    ///
    /// When the unit is no length above 0.
    pub fn set_frame(&mut self, up: (&str, bool), meters_per_unit: (f64, bool)) -> Result<(), Refusal> {
        self.facts.up_axis = Some(up.0.to_owned());
        self.facts.up_axis_authored = up.1;
        let unit = meters_per_unit.0;
        if !(unit.is_finite() && unit > 0.0 && (1e-12..=1e12).contains(&unit)) {
            return Err(format!("says that its unit is {unit} m; a unit is a length such as 1, 0.01 or 0.0254").into());
        }
        self.facts.meters_per_unit = Some(unit);
        self.facts.meters_per_unit_authored = meters_per_unit.1;
        self.meters_per_unit = unit;
        self.zup_from_file = Matrix::zup_from(Some(up.0)) * Matrix::scale([unit; 3]);
        Ok(())
    }

    /// Begins another body; returns its index. The first is there from the beginning.
    pub fn body(&mut self, name: &str) -> usize {
        self.bodies.push(Body { name: name.to_owned(), ..Body::default() });
        self.bodies.len() - 1
    }

    /// Names a body, and says how heavy it is where the file does.
    pub fn set_body(&mut self, index: usize, name: &str, mass_kg: f64) {
        if let Some(body) = self.bodies.get_mut(index) {
            body.name = name.to_owned();
            body.mass_kg = mass_kg;
        }
    }

    /// Adds the mass of something that is part of a body, kg.
    pub fn add_mass(&mut self, index: usize, mass_kg: f64) {
        if let Some(body) = self.bodies.get_mut(index) {
            body.mass_kg += mass_kg;
        }
    }

    /// Adds a shape that collides to a body, in the frame of the model.
    pub fn collide(&mut self, index: usize, shape: Collision) {
        if let Some(body) = self.bodies.get_mut(index) {
            body.collisions.push(shape);
        }
    }

    /// Returns the box around all shapes that collide, m.
    pub fn collision_bounds(&self) -> Option<Bounds> {
        let mut extent = Extent::default();
        let all = self.bodies.iter().flat_map(|b| &b.collisions);
        all.flat_map(Collision::bounds).for_each(|corner| extent.add(corner));
        extent.scaled(1.0)
    }

    /// Takes away all shapes that collide.
    pub fn clear_collisions(&mut self) {
        self.bodies.iter_mut().for_each(|b| b.collisions.clear());
    }

    /// Returns the meshes that a body shows so far.
    pub fn meshes(&self, index: usize) -> Vec<&Mesh> {
        self.bodies.get(index).into_iter().flat_map(|b| &b.visuals).map(|v| &v.mesh).collect()
    }

    /// Returns how many pieces a body shows so far.
    pub fn piece_count(&self, index: usize) -> usize {
        self.bodies.get(index).map_or(0, |b| b.visuals.len())
    }

    /// Gives a material to the pieces of a body, from one on, that have none.
    pub fn paint(&mut self, index: usize, from: usize, material: usize) {
        let pieces = self.bodies.get_mut(index).into_iter().flat_map(|b| b.visuals.iter_mut().skip(from));
        pieces.filter(|v| v.material.is_none()).for_each(|v| v.material = Some(material));
    }

    /// Asks for one part of the mesh files that are read from now on, or for all parts again. Returns, when a part was
    /// asked for until now, whether it was there, and the other parts that there were.
    pub fn want_part(&mut self, name: Option<&str>) -> Option<(bool, Vec<String>)> {
        let next = name.map(|n| WantedPart { name: n.to_owned(), ..WantedPart::default() });
        let last = std::mem::replace(&mut self.wanted, next)?;
        Some((last.is_found, last.others.into_iter().collect()))
    }

    /// Tells whether a part of a mesh file is to be read, which has these names.
    pub fn wants(&mut self, names: &[&str]) -> bool {
        let Some(wanted) = &mut self.wanted else { return true };
        if names.contains(&wanted.name.as_str()) {
            wanted.is_found = true;
            return true;
        }
        if let Some(name) = names.iter().find(|n| !n.is_empty()).filter(|_| wanted.others.len() < MAX_NAMES) {
            wanted.others.insert(super::folder::shortened(name));
        }
        false
    }

    /// Tells whether one part is asked for.
    pub fn wants_one_part(&self) -> bool {
        self.wanted.is_some()
    }

    /// Adds triangles to a body, put in place in the axes of the file by a matrix. Triangles with corners that are not
    /// there, or are no numbers, are left out.
    ///
    /// # Errors
    ///
    /// When the model becomes too large.
    pub fn add(&mut self, body: usize, piece: Piece, place: &Matrix) -> Result<(), Refusal> {
        self.points += piece.positions.len();
        self.triangles += piece.triangles.len();
        self.visuals += 1;
        if self.triangles > MAX_TRIANGLES || self.points > MAX_POINTS || self.visuals > MAX_VISUALS {
            return Err(format!(
                "has more than {MAX_TRIANGLES} triangles, {MAX_POINTS} corners or {MAX_VISUALS} pieces; simplify it first"
            )
            .into());
        }
        let place = self.zup_from_file * *place;
        let positions: Vec<[f32; 3]> =
            piece.positions.iter().map(|p| place.point(p.map(f64::from)).map(|v| v as f32)).collect();
        let good = |i: &u32| positions.get(*i as usize).is_some_and(|p| p.iter().all(|v| v.is_finite()));
        let mirrored = place.determinant() < 0.0;
        let before = piece.triangles.len();
        let triangles: Vec<[u32; 3]> = piece
            .triangles
            .into_iter()
            .filter(|t| t.iter().all(good))
            .map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] })
            .collect();
        self.dropped += before - triangles.len();
        if triangles.is_empty() {
            return Ok(());
        }
        let uvs = if piece.uvs.len() == positions.len() { piece.uvs } else { Vec::new() };
        let material = piece.material.filter(|m| *m < self.materials.len());
        let mesh = Mesh { positions, normals: Vec::new(), uvs, triangles };
        if let Some(body) = self.bodies.get_mut(body) {
            let name = format!("{}_{}", identifier(&piece.name, "mesh"), body.visuals.len());
            body.visuals.push(Visual { name, mesh, material });
        }
        Ok(())
    }

    /// Returns the index of a picture that stands in the folder of the model, reading it at the first call when it is
    /// there and of a common size.
    pub fn picture(&mut self, folder: &Folder, path: &str) -> usize {
        self.picture_with(path, |most| folder.read(path, most).ok())
    }

    /// Returns the index of a picture that is read by a function, which is told how many bytes it may have.
    pub fn picture_with(&mut self, path: &str, read: impl FnOnce(u64) -> Option<Vec<u8>>) -> usize {
        if let Some(index) = self.by_path.get(path) {
            return *index;
        }
        let left = MAX_PICTURE_BYTES.min(MAX_PICTURES_BYTES.saturating_sub(self.picture_bytes));
        let bytes = read(left).filter(|b| b.len() as u64 <= left);
        let bytes = bytes.and_then(|bytes| match strange_picture(&bytes, path) {
            None => Some(bytes),
            Some(what) => {
                self.facts.warn(format!("the picture `{}` {what} and is left out", super::folder::shortened(path)));
                None
            }
        });
        self.picture_bytes += bytes.as_ref().map_or(0, |b| b.len() as u64);
        self.textures.push(Texture { path: path.to_owned(), bytes });
        self.by_path.insert(path.to_owned(), self.textures.len() - 1);
        self.textures.len() - 1
    }

    /// Returns the model, called after its file.
    ///
    /// # Errors
    ///
    /// When nothing is seen of it, or it is of no possible size; with the facts.
    pub fn finish(mut self, file: &Path) -> Result<ReadModel, Refusal> {
        self.note_boxes();
        if self.dropped > 0 {
            let text = format!("{} triangles left out whose corners are not there or are no numbers", self.dropped);
            self.facts.warn(text);
        }
        let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let model = Model3d {
            name: identifier(&stem, "model"),
            bodies: self.bodies,
            joints: self.joints,
            materials: self.materials,
            textures: self.textures,
        };
        let missing: Vec<&str> =
            self.facts.textures.iter().filter(|t| !t.resolves).filter_map(|t| t.path.as_deref()).collect();
        if let Some(first) = missing.first() {
            let text =
                format!("{} pictures are not there, such as `{}`", missing.len(), super::folder::shortened(first));
            self.facts.warn(text);
        }
        if let Some([min, max]) = model.bounds() {
            let size = (0..3).map(|i| max[i] - min[i]);
            let far = min.iter().chain(&max).fold(0.0, |a: f64, v| a.max(v.abs()));
            if far > FAR_M && far > 10.0 * size.clone().fold(0.0, f64::max) {
                self.facts.warn(format!("is {far:.0} m from its origin, where its corners are inexact"));
            }
            if size.clone().fold(f64::MAX, f64::min) < SMALLEST_M {
                self.facts.warn("has no thickness");
            }
        }
        match possible(&model) {
            Ok(()) => Ok(ReadModel { model, facts: self.facts, companions: Vec::new() }),
            Err(reason) => Err(Refusal { reason, facts: Some(Box::new(self.facts)) }),
        }
    }

    /// Returns a refusal that carries what is known so far.
    pub fn refuse(mut self, reason: Refusal) -> Refusal {
        self.note_boxes();
        Refusal { facts: Some(Box::new(self.facts)), ..reason }
    }

    fn note_boxes(&mut self) {
        self.facts.bbox_stage = self.extent.scaled(self.meters_per_unit);
        self.facts.bbox_zup = match (self.facts.up_axis.as_deref(), self.facts.bbox_stage) {
            (Some(up), Some(bounds)) => Some(turned(bounds, &Matrix::zup_from(Some(up)))),
            _ => None,
        };
        if self.extent.not_finite > 0 {
            self.facts.feature("nonfinite", Feature::Flag(true));
            self.facts.warn(format!("{} corners left out whose coordinates are no numbers", self.extent.not_finite));
        }
    }
}

/// Tells why bytes are no picture that can be kept, when they are none.
fn strange_picture(bytes: &[u8], path: &str) -> Option<&'static str> {
    const BEGINNINGS: &[&[u8]] = &[
        b"\x89PNG",
        b"\xff\xd8\xff",
        b"RIFF",
        b"BM",
        b"II*\0",
        b"MM\0*",
        b"GIF8",
        b"\xabKTX",
        b"DDS ",
        b"\x76\x2f\x31\x01",
        b"#?",
        b"\0\0\0",
    ];
    // TGA begins with nothing of its own.
    let known = BEGINNINGS.iter().any(|b| bytes.starts_with(b)) || path.to_ascii_lowercase().ends_with(".tga");
    if !known {
        return Some("is no picture");
    }
    let side = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map_or(0, u32::from_be_bytes);
    let pixels = u64::from(side(16)) * u64::from(side(20));
    (bytes.starts_with(b"\x89PNG") && pixels > MAX_PIXELS).then_some("says that it has more pixels than can be")
}

/// Tells why a model is none.
fn possible(model: &Model3d) -> Result<(), String> {
    let Some([min, max]) = model.bounds() else {
        return Err("has no geometry that is seen: no triangle of it is visible and whole".into());
    };
    let size = (0..3).map(|i| max[i] - min[i]).fold(0.0, f64::max);
    if size > LARGEST_M {
        return Err(format!("is {size:.3e} m large, which no object is: its coordinates or its unit are wrong"));
    }
    if size < SMALLEST_M {
        return Err(format!("is {size:.3e} m large, which no object is: all its corners are in one place"));
    }
    Ok(())
}

/// Returns a text as a name of `[A-Za-z0-9_]`, or another one when nothing is left of it.
pub fn identifier(text: &str, other: &str) -> String {
    let name: String =
        text.chars().take(64).map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect::<String>();
    let name = name.trim_matches('_');
    if name.is_empty() { other.to_owned() } else { name.to_owned() }
}
