//! Whether a data set is whole: every file is as it was summed, every row has its world and every world its row.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row as Record};

use crate::assemble::{INDEX, SUMS};
use crate::digest::{of_members, sha256, sha256_of_file};
use crate::error::Error;
use crate::pack::scan;
use crate::part::SPEC;
use crate::shelf::{MODEL_SHARD, tars};
use crate::spec::Spec;

/// Most problems that are kept: one that runs through a whole data set need not be said a million times.
const MOST: usize = 50;

/// What was found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Worlds of the index.
    pub worlds: u64,
    /// Files that were looked at.
    pub files: u64,
    /// Bytes of the shards that were read.
    pub bytes: u64,
    /// What is wrong, each with its file; the first fifty.
    pub problems: Vec<String>,
}

impl Verdict {
    fn add(&mut self, problem: impl Into<String>) {
        if self.problems.len() < MOST {
            self.problems.push(problem.into());
        }
    }
}

/// A world as the index has it.
#[derive(Debug, Clone)]
struct Listed {
    shard: String,
    content: String,
    files: BTreeSet<String>,
    models: Vec<String>,
}

/// Looks at every file of a data set; `news` hears of each, and ends the work by an error.
///
/// # Errors
/// `Read` when the folder is no data set; what `news` returns. What is wrong with its files is in the verdict.
pub fn verify(folder: &Path, news: &mut dyn FnMut(&str) -> Result<(), Error>) -> Result<Verdict, Error> {
    let mut verdict = Verdict::default();
    let spec = folder.join(SPEC);
    let text = fs::read_to_string(&spec).map_err(Error::read(&spec))?;
    if let Err(e) = Spec::from_toml(&text, SPEC) {
        verdict.add(e.to_string());
    }
    check_sums(folder, &mut verdict, news)?;
    let mut listed = HashMap::new();
    let mut splits: BTreeMap<String, String> = BTreeMap::new();
    for path in indices(folder)? {
        if let Err(e) = read_index(&path, &mut listed, &mut splits, &mut verdict) {
            verdict.add(e.to_string());
        }
    }
    verdict.worlds = listed.len() as u64;
    let mut seen = Seen::default();
    for path in tars(folder)? {
        news(&relative(folder, &path))?;
        if let Err(e) = read_shard(folder, &path, &listed, &mut seen, &mut verdict) {
            verdict.add(e.to_string());
        }
    }
    let mut missing: Vec<&String> = listed.keys().filter(|key| !seen.keys.contains(*key)).collect();
    missing.sort();
    missing.into_iter().for_each(|key| verdict.add(format!("{key}: no shard has it")));
    let models: BTreeSet<&String> = listed.values().flat_map(|l| &l.models).collect();
    let lost = models.into_iter().filter(|m| !seen.models.contains(*m));
    lost.for_each(|m| verdict.add(format!("{m}: no shard has this model")));
    Ok(verdict)
}

#[derive(Default)]
struct Seen {
    keys: HashSet<String>,
    contents: HashMap<String, String>,
    models: HashSet<String>,
}

fn relative(folder: &Path, path: &Path) -> String {
    path.strip_prefix(folder).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

/// Returns the files of the index, sorted.
pub(crate) fn indices(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let index = folder.join(INDEX);
    let entries = fs::read_dir(&index).map_err(Error::read(&index))?;
    let mut paths =
        entries.map(|e| e.map(|e| e.path())).collect::<std::io::Result<Vec<_>>>().map_err(Error::read(&index))?;
    paths.retain(|p| p.extension().is_some_and(|e| e == "parquet"));
    paths.sort();
    Ok(paths)
}

fn check_sums(
    folder: &Path,
    verdict: &mut Verdict,
    news: &mut dyn FnMut(&str) -> Result<(), Error>,
) -> Result<(), Error> {
    let path = folder.join(SUMS);
    let text = fs::read_to_string(&path).map_err(Error::read(&path))?;
    let mut listed = BTreeSet::new();
    for line in text.lines() {
        let Some((sum, name)) = line.split_once("  ") else {
            verdict.add(format!("{SUMS}: a line is not of the form of sha256sum: {line}"));
            continue;
        };
        news(name)?;
        verdict.files += 1;
        listed.insert(name.to_owned());
        match sha256_of_file(&folder.join(name)) {
            Ok(found) if found == sum => {}
            Ok(_) => verdict.add(format!("{name}: does not match its sum; it was changed or damaged")),
            Err(e) => verdict.add(format!("{name}: is in {SUMS}, and {e}")),
        }
    }
    for path in tars(folder)?.into_iter().chain(indices(folder)?) {
        let name = relative(folder, &path);
        if !listed.contains(&name) {
            verdict.add(format!("{name}: is not in {SUMS}"));
        }
    }
    Ok(())
}

fn read_index(
    path: &Path,
    listed: &mut HashMap<String, Listed>,
    splits: &mut BTreeMap<String, String>,
    verdict: &mut Verdict,
) -> Result<(), Error> {
    let damaged = |e: parquet::errors::ParquetError| Error::damaged(path, e.to_string());
    let reader = SerializedFileReader::new(File::open(path).map_err(Error::read(path))?).map_err(damaged)?;
    for record in reader.get_row_iter(None).map_err(damaged)? {
        let record = record.map_err(damaged)?;
        let text = |name: &str| text(&record, name);
        let (key, split, prompt) = (text("key"), text("split"), text("prompt"));
        let row = Listed {
            shard: text("shard"),
            content: text("content_sha256"),
            files: texts(&record, "files").into_iter().collect(),
            models: texts(&record, "models"),
        };
        if *splits.entry(prompt).or_insert_with(|| split.clone()) != split {
            verdict.add(format!("{key}: its prompt is in another split than {split} too"));
        }
        if listed.insert(key.clone(), row).is_some() {
            verdict.add(format!("{key}: has two rows"));
        }
    }
    Ok(())
}

fn field<'r>(record: &'r Record, name: &str) -> Option<&'r Field> {
    record.get_column_iter().find(|(column, _)| *column == name).map(|(_, field)| field)
}

fn text(record: &Record, name: &str) -> String {
    match field(record, name) {
        Some(Field::Str(text)) => text.clone(),
        _ => String::new(),
    }
}

fn texts(record: &Record, name: &str) -> Vec<String> {
    let text = |field: &Field| match field {
        Field::Str(text) => Some(text.clone()),
        _ => None,
    };
    match field(record, name) {
        Some(Field::ListInternal(list)) => list.elements().iter().filter_map(text).collect(),
        _ => Vec::new(),
    }
}

fn read_shard(
    folder: &Path,
    path: &Path,
    listed: &HashMap<String, Listed>,
    seen: &mut Seen,
    verdict: &mut Verdict,
) -> Result<(), Error> {
    let shard = relative(folder, path);
    let is_models = path.file_name().and_then(|n| n.to_str()).is_some_and(|n| n.starts_with(MODEL_SHARD));
    let mut world: (String, Vec<(String, String)>) = Default::default();
    scan(path, 0, &mut |member| {
        let bytes = member.read().map_err(Error::read(path))?;
        verdict.bytes += member.size;
        let Some((key, ext)) = member.key() else {
            verdict.add(format!("{shard}: `{}` has no extension", member.name));
            return Ok(true);
        };
        if is_models {
            if sha256(&bytes) != key {
                verdict.add(format!("{shard}: {} is not named by its SHA-256", member.name));
            }
            seen.models.insert(member.name.clone());
            return Ok(true);
        }
        if world.0 != key {
            judge(std::mem::take(&mut world), &shard, listed, seen, verdict);
            world.0 = key.to_owned();
        }
        world.1.push((ext.to_owned(), sha256(&bytes)));
        Ok(true)
    })?;
    judge(world, &shard, listed, seen, verdict);
    Ok(())
}

/// Compares a world of a shard with its row.
fn judge(
    (key, files): (String, Vec<(String, String)>),
    shard: &str,
    listed: &HashMap<String, Listed>,
    seen: &mut Seen,
    verdict: &mut Verdict,
) {
    if key.is_empty() {
        return;
    }
    if !seen.keys.insert(key.clone()) {
        verdict.add(format!("{key}: is twice, once in {shard}"));
    }
    let Some(row) = listed.get(&key) else {
        verdict.add(format!("{key}: is in {shard} and has no row"));
        return;
    };
    let content = of_members(files.iter().map(|(ext, sum)| (ext.as_str(), sum.as_str())));
    if row.shard != shard {
        verdict.add(format!("{key}: the index says {}, it is in {shard}", row.shard));
    }
    if row.content != content {
        verdict.add(format!("{key}: its files are not those of the index"));
    }
    if files.iter().map(|f| f.0.clone()).collect::<BTreeSet<_>>() != row.files {
        verdict.add(format!("{key}: has other files than the index lists"));
    }
    if let Some(other) = seen.contents.insert(content, key.clone()) {
        verdict.add(format!("{key}: is the same world as {other}"));
    }
}
