//! Draws every finish on one sheet: `cargo run -p d3dgen-mesh --example finishes -- out.png`.

use d3dgen_mesh::finish;
use d3dgen_mesh::picture::{Picture, sheet};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::args().nth(1).ok_or("name the file to write: out.png")?;
    let mut tiles = Vec::new();
    for finish in finish::all().iter().filter(|f| f.is_drawn()) {
        let pictures = finish.pictures();
        println!(
            "{:20} {:6} bytes of color, {:6} of normals",
            finish.id,
            pictures.color.len(),
            pictures.normal.as_ref().map_or(0, Vec::len)
        );
        let drawn = image::load_from_memory(&pictures.color)?.to_rgba8();
        let (width, height) = (drawn.width() as usize, drawn.height() as usize);
        tiles.push(Picture { width, height, rgba: drawn.into_raw() });
    }
    std::fs::write(out, sheet(&tiles, 5, 8).png()?)?;
    Ok(())
}
