//! stub to be replaced
use d3dgen_model::domain::Domain;
use d3dgen_model::world::World;
use super::{Exporter, File};
use crate::Error;
pub struct Plan;
impl Exporter for Plan {
    fn name(&self) -> &'static str { "plan" }
    fn about(&self) -> &'static str { "x xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx" }
    fn export(&self, _: &World, _: &Domain) -> Result<Vec<File>, Error> { Ok(vec![File::new("plan.svg", "")]) }
}
