//! The meshes of COLLADA: sources of numbers, and primitives that index them.

use std::collections::{BTreeSet, HashMap};

use roxmltree::Node;

use super::{Ids, child, children, local};
use crate::readers::builder::{MAX_POINTS, MAX_TRIANGLES, Piece, fan};
use crate::readers::facts::{Facts, Refusal};

/// A mesh.
#[derive(Debug, Default)]
pub struct Geometry {
    pub points: Vec<[f64; 3]>,
    pub parts: Vec<Part>,
}

/// The primitives of one element.
#[derive(Debug, Default)]
pub struct Part {
    /// The symbol of its material.
    pub material: Option<String>,
    /// Corners of triangles: index of the point, and of the texture coordinate.
    pub triangles: Vec<[(u32, u32); 3]>,
    /// Points that it uses, also for lines.
    pub used: BTreeSet<u32>,
    uvs: Vec<[f32; 2]>,
}

impl Geometry {
    /// Reads a mesh.
    ///
    /// # Errors
    ///
    /// When it is too large.
    pub fn read(mesh: Node, ids: &Ids, facts: &mut Facts) -> Result<Self, Refusal> {
        let mut geometry = Self::default();
        let vertices = child(mesh, "vertices");
        let input = vertices.and_then(|v| children(v, "input").find(|i| i.attribute("semantic") == Some("POSITION")));
        let source = input.and_then(|i| ids.get(local(i.attribute("source"))?).copied());
        let corners = source.map(|s| numbers::<f64, 3>(s, facts)).transpose()?.unwrap_or_default();
        geometry.points = corners;
        const KINDS: &[&str] = &["triangles", "polylist", "polygons", "tristrips", "trifans", "lines"];
        let mut total = 0;
        for element in mesh.children().filter(|c| KINDS.contains(&c.tag_name().name())) {
            let part = Part::read(element, ids, geometry.points.len(), facts)?;
            total += part.triangles.len();
            if total > MAX_TRIANGLES {
                return Err(format!("has more than {MAX_TRIANGLES} triangles; simplify it first").into());
            }
            geometry.parts.push(part);
        }
        Ok(geometry)
    }

    /// Returns the triangles of a part with the corners they use.
    pub fn piece(&self, part: &Part, name: &str, material: Option<usize>) -> Piece {
        let mut piece = Piece { name: name.to_owned(), material, ..Piece::default() };
        let mut index: HashMap<(u32, u32), u32> = HashMap::new();
        for corners in &part.triangles {
            piece.triangles.push(corners.map(|corner| {
                *index.entry(corner).or_insert_with(|| {
                    let point = self.points.get(corner.0 as usize).copied().unwrap_or([f64::NAN; 3]);
                    piece.positions.push(point.map(|v| v as f32));
                    piece.uvs.push(part.uvs.get(corner.1 as usize).copied().unwrap_or_default());
                    piece.positions.len() as u32 - 1
                })
            }));
        }
        if part.uvs.is_empty() {
            piece.uvs.clear();
        }
        piece
    }
}

impl Part {
    fn read(element: Node, ids: &Ids, points: usize, facts: &mut Facts) -> Result<Self, Refusal> {
        let mut part = Self { material: element.attribute("material").map(str::to_owned), ..Self::default() };
        let mut stride = 1;
        let (mut point_at, mut uv_at) = (0, None);
        for input in children(element, "input") {
            let offset: usize = input.attribute("offset").and_then(|o| o.trim().parse().ok()).unwrap_or(0).min(64);
            stride = stride.max(offset + 1);
            match input.attribute("semantic") {
                Some("VERTEX") => point_at = offset,
                Some("TEXCOORD") if uv_at.is_none() => {
                    let source = local(input.attribute("source")).and_then(|s| ids.get(s)).copied();
                    part.uvs = source.map(|s| numbers::<f32, 2>(s, facts)).transpose()?.unwrap_or_default();
                    uv_at = Some(offset);
                }
                _ => {}
            }
        }
        let corner = |group: &[i64]| {
            let index = |at: usize| group.get(at).and_then(|i| u32::try_from(*i).ok()).unwrap_or(u32::MAX);
            (index(point_at), uv_at.map_or(u32::MAX, index))
        };
        let lists: Vec<Vec<(u32, u32)>> = children(element, "p")
            .map(|p| integers(p).map(|all| all.chunks_exact(stride).map(corner).collect()))
            .collect::<Result<_, _>>()?;
        let mut add = |corners: &[(u32, u32)]| part.triangles.extend(fan(corners));
        match element.tag_name().name() {
            "triangles" => lists.iter().flat_map(|l| l.chunks_exact(3)).for_each(add),
            "polylist" => {
                let mut at = 0usize;
                let all = lists.concat();
                for count in child(element, "vcount").map(integers).transpose()?.unwrap_or_default() {
                    let Some(corners) = usize::try_from(count).ok().and_then(|c| all.get(at..at.checked_add(c)?))
                    else {
                        facts.warn("the counts of a polylist are more than its corners");
                        break;
                    };
                    add(corners);
                    at += corners.len();
                }
            }
            "polygons" | "trifans" => lists.iter().for_each(|l| add(l)),
            "tristrips" => {
                for (index, three) in lists.iter().flat_map(|l| l.windows(3).enumerate()) {
                    add(&if index % 2 == 0 { [three[0], three[1], three[2]] } else { [three[1], three[0], three[2]] });
                }
            }
            _ => {}
        }
        part.used = lists.iter().flatten().map(|c| c.0).collect();
        if part.used.last().is_some_and(|last| *last as usize >= points) {
            facts.warn("faces name corners that are not there");
        }
        Ok(part)
    }
}

fn integers(element: Node) -> Result<Vec<i64>, Refusal> {
    let words = element.text().unwrap_or_default().split_whitespace();
    let values: Vec<i64> = words.map(|w| w.parse().unwrap_or(-1)).take(16 * MAX_POINTS + 1).collect();
    if values.len() > 16 * MAX_POINTS { Err("has too many indices; simplify it first".into()) } else { Ok(values) }
}

/// Returns the numbers of a source in groups of `N`; more a group are left out.
fn numbers<T: Parsed, const N: usize>(source: Node, facts: &mut Facts) -> Result<Vec<[T; N]>, Refusal> {
    let Some(array) = child(source, "float_array") else { return Ok(Vec::new()) };
    let words = array.text().unwrap_or_default().split_whitespace();
    let values: Vec<T> = words.map(T::parsed).take(4 * MAX_POINTS + 1).collect();
    if values.len() > 4 * MAX_POINTS {
        return Err(format!("has more than {MAX_POINTS} corners; simplify it first").into());
    }
    let said = array.attribute("count").and_then(|c| c.trim().parse::<usize>().ok());
    if said.is_some_and(|s| s != values.len()) {
        facts.warn("a list of numbers has another count than it says");
    }
    let accessor = child(source, "technique_common").and_then(|t| child(t, "accessor"));
    let params = accessor.map(|a| children(a, "param").count()).filter(|c| *c > 0);
    let stride = accessor.and_then(|a| a.attribute("stride")?.trim().parse().ok()).or(params).unwrap_or(N);
    let groups = values.chunks_exact(stride.max(1));
    Ok(groups.map(|g| std::array::from_fn(|i| g.get(i).copied().unwrap_or(T::ZERO))).collect())
}

/// A number read from text.
trait Parsed: std::str::FromStr + Copy {
    const ZERO: Self;
    const NAN: Self;

    fn parsed(word: &str) -> Self {
        word.parse().unwrap_or(Self::NAN)
    }
}

impl Parsed for f64 {
    const ZERO: Self = 0.0;
    const NAN: Self = f64::NAN;
}

impl Parsed for f32 {
    const ZERO: Self = 0.0;
    const NAN: Self = f32::NAN;
}
