//! Texture coordinates of what is made, in meters: projected along the nearest axis, and grain along the longer way of each face,
//! as boards are cut.

use crate::model3d::Mesh;
use crate::surface::Surface;

/// How much longer a face is up than across before its grain runs up.
const LONGER: f32 = 1.05;

/// Turns a surface into single precision with its texture coordinates.
pub(super) fn mesh(surface: &Surface, has_grain: bool) -> Mesh {
    let single = |v: f64| if v.abs() < 1e-9 { 0.0 } else { v as f32 };
    let positions: Vec<[f32; 3]> = surface.positions.iter().map(|p| p.map(single)).collect();
    let normals: Vec<[f32; 3]> = surface.normals.iter().map(|n| n.map(single)).collect();
    let uvs = surface.positions.iter().zip(&surface.normals).map(|(p, n)| {
        let axis = (0..3).max_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs())).unwrap_or(2);
        match axis {
            0 => [single(p[1] * n[0].signum()), single(p[2])],
            1 => [single(-p[0] * n[1].signum()), single(p[2])],
            _ => [single(p[0]), single(p[1] * n[2].signum())],
        }
    });
    let mut uvs: Vec<[f32; 2]> = uvs.collect();
    if has_grain {
        turn_lengthwise(&mut uvs, &surface.triangles);
    }
    let distinct = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        a != b && b != c && c != a
    };
    let triangles = surface.triangles.iter().filter(distinct).copied().collect();
    Mesh { positions, normals, uvs, triangles }
}

/// Turns the coordinates of each face that is longer in the second direction by a quarter.
fn turn_lengthwise(uvs: &mut [[f32; 2]], triangles: &[[u32; 3]]) {
    let face_of = faces(uvs.len(), triangles);
    let mut spans = vec![[[f32::MAX, f32::MIN]; 2]; uvs.len()];
    for (uv, face) in uvs.iter().zip(&face_of) {
        for (span, v) in spans[*face].iter_mut().zip(uv) {
            *span = [span[0].min(*v), span[1].max(*v)];
        }
    }
    for (uv, face) in uvs.iter_mut().zip(&face_of) {
        let [across, up] = spans[*face].map(|[low, high]| high - low);
        if up > LONGER * across {
            *uv = [uv[1], -uv[0]];
        }
    }
}

/// Returns the face of each corner, named by one of its corners: what triangles join is one face, for flat ones share none.
fn faces(corners: usize, triangles: &[[u32; 3]]) -> Vec<usize> {
    let mut joined: Vec<usize> = (0..corners).collect();
    fn root(joined: &mut [usize], mut at: usize) -> usize {
        while joined[at] != at {
            joined[at] = joined[joined[at]];
            at = joined[at];
        }
        at
    }
    for [a, b, c] in triangles.iter().map(|t| t.map(|i| i as usize)) {
        let own = root(&mut joined, a);
        for other in [b, c] {
            let other = root(&mut joined, other);
            joined[other] = own;
        }
    }
    (0..corners).map(|i| root(&mut joined, i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A board of this size with its faces towards -y and up.
    fn board(width: f64, depth: f64, height: f64) -> Surface {
        let mut board = Surface::default();
        board.face(&[[0.0, 0.0, 0.0], [width, 0.0, 0.0], [width, 0.0, height], [0.0, 0.0, height]]);
        board.face(&[[0.0, 0.0, height], [width, 0.0, height], [width, depth, height], [0.0, depth, height]]);
        board
    }

    fn spans(mesh: &Mesh, corners: std::ops::Range<usize>) -> [f32; 2] {
        [0, 1].map(|k| {
            let values = || mesh.uvs[corners.clone()].iter().map(move |uv| uv[k]);
            values().fold(f32::MIN, f32::max) - values().fold(f32::MAX, f32::min)
        })
    }

    #[test]
    fn grain_runs_up_a_door_and_along_a_table() {
        let door = mesh(&board(0.9, 0.04, 2.0), true);
        assert_eq!((spans(&door, 0..4), spans(&door, 4..8)), ([2.0, 0.9], [0.9, 0.04]));
        let table = mesh(&board(0.8, 1.6, 0.03), true);
        assert_eq!((spans(&table, 0..4), spans(&table, 4..8)), ([0.8, 0.03], [1.6, 0.8]));
        let tiled = mesh(&board(0.9, 0.04, 2.0), false);
        assert_eq!(spans(&tiled, 0..4), [0.9, 2.0], "what has no grain stays upright");
    }
}
