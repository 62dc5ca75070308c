//! `d3dgen edit`: changes to a finished world, checked and repaired.

use std::path::{Path, PathBuf};

use d3dgen_model::Document;
use d3dgen_model::edits::{Edit, Edits};
use d3dgen_model::world::World;
use d3dgen_pipeline::Stop;
use d3dgen_pipeline::edit::{self, Edited};
use d3dgen_plugins::Plugin;
use serde_json::{Map, Value};

use super::formats::{self, Formats};
use crate::bundle;
use crate::error::Error;
use crate::input::document;
use crate::interrupt;
use crate::output::{Kept, Output};
use crate::registry::{RegistryArgs, domain};
use crate::summary;

/// What can be written after --do: the operation, and its fields in their order; fields in brackets may be left out,
/// fields that end in dots take all that follows.
const FORMS: &[(&str, &[&str])] = &[
    ("move_wall", &["wall_id", "by_m"]),
    ("move_opening", &["opening_id", "by_m"]),
    ("add_room", &["room_type", "[area_m2]", "[entered_from]"]),
    ("remove_room", &["room_id"]),
    ("swap_object", &["placement_id", "[object]", "[asset]"]),
    ("move_object", &["placement_id", "x", "y", "[yaw_rad]"]),
    ("add_object", &["room_id", "object"]),
    ("remove_object", &["placement_id"]),
    ("refurnish", &["room_id"]),
    ("change_job", &["robot_id", "job_id", "to..."]),
    ("change_steps", &["agent_id", "steps..."]),
    ("lock", &["ids..."]),
    ("unlock", &["ids..."]),
];
/// Ends a field that takes all words that follow.
const MORE: &str = "...";

/// Arguments.
#[derive(clap::Args)]
#[command(after_help = "Changes for --do, in words:
  move_wall WALL BY_M                     east or north; negative: west or south
  move_opening DOOR_OR_WINDOW BY_M        along its wall, east or north; negative: west or south
  add_room TYPE [AREA_M2 [ENTERED_FROM]]
  remove_room ROOM
  swap_object OBJECT_ID [TYPE [MODEL]]    another model of the same when no type is given
  move_object OBJECT_ID X Y [YAW_RAD]
  add_object ROOM TYPE
  remove_object OBJECT_ID
  refurnish ROOM
  change_job ROBOT JOB POINT...           the points it goes to, in turn
  change_steps PERSON NUMBER...           the steps that stay, in their new turn
  lock ID... | unlock ID...               rooms, walls, doors, windows, objects; robots and people keep what they do

Example:
  d3dgen edit flat --do 'move_wall wall_7 0.4' --do 'add_room storage 4' --out flat_2")]
pub struct Args {
    /// world.json, or a world's folder
    #[arg(value_name = "WORLD")]
    world: PathBuf,
    /// A document with changes (schemas/edits.schema.json); they come before those of --do
    #[arg(long, value_name = "FILE")]
    edits: Option<PathBuf>,
    /// A change, in words; may be given more than once
    #[arg(long = "do", value_name = "CHANGE", allow_hyphen_values = true)]
    changes: Vec<String>,
    /// Folder to write: new, empty, or an earlier output, which is replaced
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    formats: formats::FormatArgs,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let formats = self.formats.chosen(&self.registry.store)?;
        let mut edits: Vec<Edit> = match &self.edits {
            Some(path) => document::<Edits>(path)?.edits,
            None => Vec::new(),
        };
        for (i, words) in self.changes.iter().enumerate() {
            let at = |reason: String| Error::Input(format!("--do number {} (`{words}`): {reason}", i + 1));
            edits.push(change(words).map_err(at)?);
        }
        let edits = checked(edits)?;
        let world: World = document(&self.world)?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &world.scene_graph.domain)?;
        let (edited, kept) = write(&world, &edits, plugin, &formats, &self.out, Stop::from(interrupt::flag()))?;
        summary::print_broken(&edited.report);
        let changed =
            if edited.changed_room_ids.is_empty() { "no room".into() } else { edited.changed_room_ids.join(", ") };
        match kept {
            Some(kept) => eprintln!("{kept}"),
            None => eprintln!("wrote {} with {} changes; changed: {changed}", self.out.display(), edits.edits.len()),
        }
        summary::judged(&edited.report)
    }
}

/// Returns changes as a document that was looked at like one of a file.
///
/// # Errors
/// `Document` with every problem.
pub fn checked(edits: Vec<Edit>) -> Result<Edits, Error> {
    let value = serde_json::to_value(Edits { version: 1, edits }).map_err(|e| Error::Input(e.to_string()))?;
    Edits::from_value(value).map_err(|source| Error::Document { path: "the changes".into(), source })
}

/// Changes a world and writes what comes of it into a folder; an earlier world stays there when it is unsound.
///
/// # Errors
/// `Stage` for a change that cannot be made, and as [`bundle::write`].
pub fn write(
    world: &World,
    edits: &Edits,
    plugin: &dyn Plugin,
    formats: &Formats,
    out: &Path,
    stop: Stop<'_>,
) -> Result<(Edited, Option<Kept>), Error> {
    let output = Output::new(out)?;
    let edited = edit::apply(world, &edits.edits, plugin, stop)?;
    bundle::write(&edited.world, &edited.report, plugin.domain(), formats, &output)?;
    let kept = output.commit()?;
    Ok((edited, kept))
}

/// Reads a change in words.
fn change(words: &str) -> Result<Edit, String> {
    let mut given = words.split_whitespace();
    let op = given.next().unwrap_or_default();
    let given: Vec<&str> = given.collect();
    let known = || FORMS.iter().map(|f| f.0).collect::<Vec<_>>().join(", ");
    let (_, fields) = FORMS.iter().find(|f| f.0 == op).ok_or_else(|| format!("`{op}` is none of {}", known()))?;
    let needed = fields.iter().filter(|f| !f.starts_with('[')).count();
    let takes_all = fields.last().is_some_and(|f| f.ends_with(MORE));
    if given.len() < needed || (given.len() > fields.len() && !takes_all) {
        return Err(format!("needs {}", fields.join(" ").to_uppercase()));
    }
    let mut object = Map::from_iter([("op".to_owned(), Value::from(op.trim_start_matches("un")))]);
    if op.ends_with("lock") {
        object.insert("locked".to_owned(), Value::from(op == "lock"));
    }
    for (i, (field, word)) in fields.iter().zip(&given).enumerate() {
        if let Some(field) = field.strip_suffix(MORE) {
            object.insert(field.to_owned(), list(field, &given[i..])?);
            continue;
        }
        let field = field.trim_matches(['[', ']']);
        let value = match field {
            "by_m" | "area_m2" | "x" | "y" | "yaw_rad" => {
                let number: f64 = word.parse().map_err(|_| format!("`{word}` is no number"))?;
                Value::from(number)
            }
            _ => Value::from(*word),
        };
        object.insert(field.to_owned(), value);
    }
    serde_json::from_value(Value::Object(object)).map_err(|e| e.to_string())
}

/// Returns the words at the end of a change as a list: ids, or numbers of steps.
fn list(field: &str, words: &[&str]) -> Result<Value, String> {
    if field != "steps" {
        return Ok(Value::from(words.to_vec()));
    }
    let number = |word: &&str| word.parse::<u32>().map_err(|_| format!("`{word}` is no number of a step"));
    let numbers: Vec<u32> = words.iter().map(number).collect::<Result<_, _>>()?;
    Ok(numbers.into_iter().map(|number| serde_json::json!({ "number": number })).collect())
}

#[cfg(test)]
mod tests {
    use d3dgen_model::edits::StepKept;

    use super::*;

    #[test]
    fn changes_in_words_name_as_much_as_they_like_at_the_end() {
        let lock = |words: &str| match change(words).expect(words) {
            Edit::Lock { ids, locked, .. } => (ids, locked),
            other => panic!("{other:?}"),
        };
        assert_eq!(lock("lock a_1 b_2"), (vec!["a_1".to_owned(), "b_2".to_owned()], true));
        assert_eq!(lock("unlock a_1"), (vec!["a_1".to_owned()], false));
        let job = change("change_job delivery_robot_1 deliver_1 point_b point_a").expect("a job");
        assert!(matches!(&job, Edit::ChangeJob { to, load_kg: None, .. } if to == &["point_b", "point_a"]), "{job:?}");
        let turn = change("change_steps nurse_1 3 1").expect("a turn");
        let numbers = |steps: &[StepKept]| steps.iter().map(|s| s.number).collect::<Vec<_>>();
        assert!(matches!(&turn, Edit::ChangeSteps { steps, .. } if numbers(steps) == [3, 1]), "{turn:?}");
        for (words, said) in [
            ("lock", "needs IDS..."),
            ("change_steps nurse_1", "needs AGENT_ID STEPS..."),
            ("change_steps nurse_1 x", "`x` is no number of a step"),
            ("refurnish a b", "needs ROOM_ID"),
            ("blow_up a", "`blow_up` is none of"),
        ] {
            assert!(change(words).expect_err(words).contains(said), "{words}");
        }
    }
}
