//! One file a measure; each says where its definition comes from and what differs from it.

pub mod accessibility;
pub mod adjacency;
pub mod bounds;
pub mod collision;
pub mod compliance;
pub mod distance;
pub mod diversity;
pub mod fidelity;
pub mod layout;
pub mod navigability;
pub mod openings;
pub mod robots;
pub mod support;

/// Returns a share; `whole` of nothing is kept whole.
pub(crate) fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 1.0 } else { round(part as f64 / whole as f64) }
}

/// Returns a figure with the six digits that documents keep.
pub(crate) fn round(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    if rounded == 0.0 { 0.0 } else { rounded } // never -0.0
}
