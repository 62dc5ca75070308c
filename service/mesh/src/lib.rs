//! 3D models of objects: in memory, made from a description, as files, and as pictures.
//!
//! Frame of every model: meters, z up, x to the right of somebody who looks at its front, the front at -y, origin in
//! the middle of the footprint on the underside (of a wall object: in the middle of its box's underside too).

pub mod builds;
pub mod coarse;
pub mod dynamics;
pub mod error;
pub mod finish;
pub mod mass;
pub mod model3d;
pub mod parts;
pub mod picture;
pub mod sweep;
pub mod world3d;
pub mod writers;

mod affine;
mod surface;

pub use builds::{Library, generate, generate_by, triangulate};
pub use error::Error;
pub use finish::Finish;
pub use model3d::{Body, Collision, Joint, JointKind, Material, Mesh, Model3d, Texture, Visual};
pub use world3d::World3d;
