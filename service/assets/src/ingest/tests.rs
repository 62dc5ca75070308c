//! Folders of models, read by a reader that makes boxes of files with three numbers in them.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use tempfile::TempDir;

use super::*;
use crate::measure::tests::boxes;
use crate::sample;

struct Boxes {
    reads: AtomicUsize,
}

impl Reads for Boxes {
    fn read(
        &self,
        files: &[PathBuf],
        _: &Path,
        each: &mut dyn FnMut(usize, Result<Read, String>) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        for (place, file) in files.iter().enumerate() {
            self.reads.fetch_add(1, Ordering::SeqCst);
            let text = std::fs::read_to_string(file).expect("readable");
            let figures: Vec<f32> = text.split_whitespace().filter_map(|f| f.parse().ok()).collect();
            let read = match figures[..] {
                [x, y, z] => Ok(Read {
                    model: boxes(&[[[0.0; 3], [x, y, z]]]),
                    declared: Declared::default(),
                    companions: [file.with_file_name("paint.mtl")].into_iter().filter(|f| f.is_file()).collect(),
                }),
                _ => Err("is no box".to_owned()),
            };
            if each(place, read).is_break() {
                break;
            }
        }
        Ok(())
    }
}

struct Home {
    dir: TempDir,
    database: Database,
    reader: Boxes,
}

impl Home {
    fn new(files: &[(&str, &str)]) -> Self {
        let dir = tempfile::tempdir().expect("a folder");
        let database = Database::open_or_create(&dir.path().join("store"), &d3dgen_store::Options::default());
        let home = Self { dir, database: database.expect("a store"), reader: Boxes { reads: AtomicUsize::new(0) } };
        files.iter().for_each(|(path, text)| home.write(path, text));
        home
    }

    fn write(&self, path: &str, text: &str) {
        let file = self.dir.path().join("models").join(path);
        std::fs::create_dir_all(file.parent().expect("a folder"))
            .and_then(|()| std::fs::write(file, text))
            .expect("written");
    }

    fn ingest(&self, cancelled: &(dyn Fn() -> bool + Sync)) -> Summary {
        let by = Provenance { who: "t".into(), when: "2026-11-21T00:00:00Z".into(), why: "test".into() };
        let options = Options { domain: Some("Test"), by: &by, workers: 2, progress: &|_, _, _| (), cancelled };
        let folder = self.dir.path().join("models");
        ingest(&self.database, &folder, sample::catalog(), &self.reader, &options).expect("walked")
    }

    fn reads(&self) -> usize {
        self.reader.reads.load(Ordering::SeqCst)
    }
}

#[test]
fn folders_are_ingested_once_and_again() {
    let home = Home::new(&[
        ("a/desk.glb", "1.4 0.7 0.72"),
        ("a/copy_of_desk.glb", "1.4 0.7 0.72"),
        ("b/desk.usdz", "1.2 0.6 0.72"),
        ("b/broken.obj", "what"),
        ("b/readme.txt", "no model"),
        (".git/c.glb", "1 1 1"),
    ]);
    let first = home.ingest(&|| false);
    assert_eq!((first.counts(), home.reads()), ([2, 0, 1, 1], 3), "{first:?}");
    assert_eq!(first.refused().collect::<Vec<_>>(), [("b/broken.obj", "is no box")]);
    assert_eq!(home.database.ids().expect("readable"), ["Test/copy_of_desk", "Test/desk"]);
    let model = home.database.model("Test/desk").expect("readable").expect("kept");
    let [min, max] = model.bounds().expect("triangles");
    assert!((min[0] + max[0]).abs() < 1e-6 && min[2].abs() < 1e-6, "{min:?} {max:?}");
    let again = home.ingest(&|| false);
    assert_eq!((again.counts(), home.reads()), ([0, 0, 3, 1], 4), "refused files are tried again");
    home.write("b/desk.usdz", "1.6 0.8 0.72");
    let changed = home.ingest(&|| false);
    assert_eq!(changed.counts(), [0, 1, 2, 1]);
    let annotation = home.database.get("Test/desk").expect("readable").expect("there");
    assert_eq!(annotation.size_m, [1.6, 0.8, 0.72]);
    assert_eq!(annotation.object.as_deref(), Some("desk"));
    assert_eq!(home.database.verify(&mut |_, _| (), &AtomicBool::new(false)).expect("readable"), []);
}

#[test]
fn other_materials_make_another_model() {
    let home = Home::new(&[
        ("red/chair.obj", "0.5 0.5 0.9"),
        ("red/paint.mtl", "red"),
        ("red_copy/chair.obj", "0.5 0.5 0.9"),
        ("red_copy/paint.mtl", "red"),
        ("blue/chair.obj", "0.5 0.5 0.9"),
        ("blue/paint.mtl", "blue"),
    ]);
    let first = home.ingest(&|| false);
    assert_eq!(first.counts(), [2, 0, 1, 0], "{first:?}");
    let ids = |summary: &Summary| -> Vec<String> {
        let id = |o: &Outcome| {
            match o {
                Outcome::Added { asset_id } | Outcome::Updated { asset_id } | Outcome::Unchanged { asset_id } => {
                    asset_id
                }
                Outcome::Refused { reason } => reason,
            }
            .clone()
        };
        summary.files.values().map(id).collect()
    };
    // blue, red, red_copy: two look alike and are not.
    let [blue, red, copy] = ids(&first).try_into().expect("three files");
    assert!(blue != red && (copy == red || copy == blue));
    assert_eq!(home.ingest(&|| false).counts(), [0, 0, 3, 0]);
    let reads = home.reads();
    home.write("red/paint.mtl", "dark red");
    let repainted = home.ingest(&|| false);
    assert_eq!((repainted.counts(), home.reads()), ([0, 1, 2, 0], reads + 1), "{repainted:?}");
    assert_eq!(ids(&repainted)[1], red);
    assert_eq!(home.database.verify(&mut |_, _| (), &AtomicBool::new(false)).expect("readable"), []);
}

#[test]
fn what_is_stopped_goes_on() {
    let files: Vec<(String, String)> = (0..70).map(|i| (format!("{i:02}_box.glb"), format!("1 1 {}", 1 + i))).collect();
    let files: Vec<(&str, &str)> = files.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let home = Home::new(&files);
    let reads = &home.reader.reads;
    let first = home.ingest(&|| reads.load(Ordering::SeqCst) > 40);
    let kept = first.counts()[0];
    assert!(first.cancelled && (24..70).contains(&kept), "{kept}");
    assert_eq!(home.database.ids().expect("readable").len(), kept);
    let second = home.ingest(&|| false);
    assert!(!second.cancelled);
    assert_eq!(second.counts(), [70 - kept, 0, kept, 0]);
}

#[test]
fn files_of_a_folder_are_in_one_unit() {
    // Furniture in centimeters, and something that nothing is known of.
    let home = Home::new(&[
        ("kit/office_chair.glb", "62 64 105"),
        ("kit/wardrobe.glb", "120 60 208"),
        ("kit/sofa.glb", "220 95 88"),
        ("kit/zzyzx.glb", "9 7 5"),
        ("alone/zzyzx.glb", "9 7 5.1"),
    ]);
    let first = home.ingest(&|| false);
    assert_eq!(first.counts(), [5, 0, 0, 0], "{first:?}");
    let size = |path: &str| match &first.files[path] {
        Outcome::Added { asset_id } => home.database.get(asset_id).expect("readable").expect("kept").size_m,
        other => panic!("{path}: {other:?}"),
    };
    assert_eq!(size("kit/sofa.glb"), [2.2, 0.95, 0.88]);
    assert_eq!((size("kit/zzyzx.glb"), size("alone/zzyzx.glb")), ([0.09, 0.07, 0.05], [9.0, 7.0, 5.1]));
    assert_eq!(home.ingest(&|| false).counts(), [0, 0, 5, 0]);
}
