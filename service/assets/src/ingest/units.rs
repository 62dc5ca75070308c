//! One unit a folder: files that people put side by side are mostly in the same, and lie alike.

use std::collections::BTreeMap;

use super::{Outcome, Summary, Wanted};
use crate::database::Database;
use crate::error::Error;

/// Files of a folder that must be known for what they are, and the share of them that must agree.
const VOTES: usize = 3;
const AGREE: f64 = 0.75;

/// One file as it was taken.
struct Taken {
    /// Place in the list.
    place: usize,
    factor: f64,
    /// Whether it is known what it is.
    is_known: bool,
}

/// Returns the files that were taken in another unit than most beside them, to be judged again with that in mind.
pub(super) fn unlike_their_neighbors(
    database: &Database,
    mut wanted: Vec<Wanted>,
    summary: &Summary,
) -> Result<Vec<Wanted>, Error> {
    let mut folders: BTreeMap<(String, String), Vec<Taken>> = BTreeMap::new();
    for (place, file) in wanted.iter().enumerate() {
        let Some(Outcome::Added { asset_id } | Outcome::Updated { asset_id }) = summary.files.get(&file.path) else {
            continue;
        };
        let Some(annotation) = database.get(asset_id)? else { continue };
        let [row, ..] = annotation.model_from_file;
        let factor = row[..3].iter().map(|v| v * v).sum::<f64>().sqrt();
        let (folder, name) = file.path.rsplit_once('/').unwrap_or(("", &file.path));
        let ending = name.rsplit_once('.').map(|(_, e)| e.to_lowercase()).unwrap_or_default();
        let taken = Taken { place, factor, is_known: annotation.object.is_some() };
        folders.entry((folder.to_owned(), ending)).or_default().push(taken);
    }
    let mut units: BTreeMap<usize, f64> = BTreeMap::new();
    for files in folders.values() {
        if let Some(unit) = agreed(files) {
            units.extend(files.iter().filter(|f| !same(f.factor, unit)).map(|f| (f.place, unit)));
        }
    }
    let mut place = 0;
    wanted.retain_mut(|file| {
        file.unit_beside = units.get(&place).copied();
        place += 1;
        file.unit_beside.is_some()
    });
    Ok(wanted)
}

/// Returns the factor that most files which are known share.
fn agreed(files: &[Taken]) -> Option<f64> {
    let votes: Vec<f64> = files.iter().filter(|f| f.is_known).map(|f| f.factor).collect();
    let count = |unit: f64| votes.iter().filter(|v| same(**v, unit)).count();
    let unit = votes.iter().copied().max_by_key(|v| count(*v))?;
    (votes.len() >= VOTES && count(unit) as f64 >= AGREE * votes.len() as f64).then_some(unit)
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 0.01 * a.abs().max(b.abs())
}
