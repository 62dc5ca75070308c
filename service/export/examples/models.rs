//! Writes the model of every object of the shipped domains: `cargo run -p d3dgen-export --example models -- [--all-sizes] FOLDER`
//!
//! One folder a model as in a world's `assets/`, for the acceptance checks of `tests/`. Prints how long making and
//! writing them took.

use std::path::Path;
use std::time::{Duration, Instant};

use d3dgen_export::models::{self, ModelRequest};
use d3dgen_mesh::{Library, picture};
use d3dgen_plugins::Registry;

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let all_sizes = arguments.iter().any(|a| a == "--all-sizes");
    arguments.retain(|a| !a.starts_with("--"));
    let [folder] = &arguments[..] else {
        eprintln!("usage: models [--all-sizes] FOLDER");
        std::process::exit(2);
    };
    let registry = Registry::builtin();
    let (mut count, mut bytes, mut spent, mut drawn) = (0, 0, Duration::ZERO, Duration::ZERO);
    for plugin in registry.iter() {
        let domain = plugin.domain();
        let library = Library::shipped().with(&domain.builds);
        let title = title(&domain.id);
        for object in &domain.objects {
            let sizes = if all_sizes { &object.sizes_m[..] } else { &object.sizes_m[..1] };
            for (i, size) in sizes.iter().enumerate() {
                let name =
                    if i == 0 { title_words(&object.id) } else { format!("{}_{}", title_words(&object.id), i + 1) };
                let request =
                    ModelRequest { domain: &title, name: &name, object, size_m: *size, mount: object.mount, seed: 0 };
                let begun = Instant::now();
                let files = models::files(&library, &request).unwrap_or_else(|e| panic!("{}: {e}", object.id));
                spent += begun.elapsed();
                let model = d3dgen_mesh::generate(&library, object, *size, 0).expect("it was made above");
                let begun = Instant::now();
                std::hint::black_box(picture::thumbnail(&model, 256));
                drawn += begun.elapsed();
                for file in files {
                    let path = Path::new(folder).join(&file.path);
                    let parent = path.parent().expect("it lies in the folder");
                    std::fs::create_dir_all(parent)
                        .and_then(|()| std::fs::write(&path, &file.bytes))
                        .expect("writable");
                    bytes += file.bytes.len();
                }
                count += 1;
            }
        }
    }
    let each = |time: Duration| time.as_secs_f64() * 1000.0 / f64::from(count);
    println!(
        "{count} models, {} MB, {:.2} ms each to make and write as all formats, {:.2} ms each to draw at 256 px",
        bytes / 1_000_000,
        each(spent),
        each(drawn)
    );
}

fn title(id: &str) -> String {
    let mut letters = id.chars();
    letters.next().map(|c| c.to_ascii_uppercase()).into_iter().chain(letters).collect()
}

fn title_words(id: &str) -> String {
    id.split('_').map(title).collect::<Vec<_>>().join("_")
}
