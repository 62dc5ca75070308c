//! The card of a data set: what it holds, how it was made, how to read it.

use std::fmt::Write;

use crate::assemble::Whole;
use crate::assemble::statistics::Statistics;

/// Returns README.md; `plots` are file name and title.
pub fn card(whole: &Whole<'_>, statistics: &Statistics, plots: &[(String, String)], has_models: bool) -> String {
    let spec = &whole.spec;
    let title = if spec.title.is_empty() { &spec.name } else { &spec.title };
    let mut text = header(whole, statistics, title);
    let _ = writeln!(text, "\n# {title}\n");
    if !spec.description.is_empty() {
        let _ = writeln!(text, "{}\n", spec.description.trim());
    }
    let worlds = statistics.worlds;
    let _ = writeln!(
        text,
        "{worlds} indoor worlds of {} prompts, {} kB each on average, every one checked against the hard rules of d3dgen. {} of {} tasks came to no world; `failures.jsonl` has each with its reason.\n",
        whole.tasks.prompts().len(),
        (statistics.bytes / worlds.max(1)).div_ceil(1000),
        statistics.missed(),
        whole.tasks.len(),
    );
    text += CONTENTS;
    if has_models {
        text += "| `shards/models-*.tar` | 3D models that worlds share, each once, named by its SHA-256; column `models` |\n";
    }
    let _ = writeln!(text, "\nSplits: {}.\n", splits(whole, statistics));
    text += READING;
    text += "\n## Statistics\n\n";
    text += &statistics.tables();
    text.push('\n');
    for (file, title) in plots {
        let _ = writeln!(text, "![{title}](plots/{file})");
    }
    let _ = writeln!(
        text,
        "\n## How it was made\n\n{} under snapshot `{}` (domains {}, their rules, the assets that stand for objects), with `spec.toml`. Every world is a function of its prompt, its seed and that snapshot: `d3dgen dataset make spec.toml --snapshot {} --out DIR` gives these files again, byte for byte.\n",
        whole.snapshot.program(),
        whole.snapshot.digest(),
        whole.snapshot.domain_ids().collect::<Vec<_>>().join(", "),
        whole.snapshot.file_name(),
    );
    let _ = writeln!(
        text,
        "## Licenses\n\nThe worlds: {}. The generator, d3dgen, and the models it makes: Apache-2.0. Models taken from an asset database keep the licenses stated there. Building rules are cited in each `report.json` with their source; the texts of the sources are not part of this data set.",
        spec.license
    );
    text
}

const CONTENTS: &str = "\
| file | what it is |
|---|---|
| `index/SPLIT.parquet` | one row a world: prompt, seed, kind, country, rooms, figures, rules, files with digests |
| `shards/SPLIT-000000.tar` | WebDataset shards; `KEY.json` is what is known of a world, `KEY.world.json.gz` and `KEY.report.json.gz` its documents |
| `load.py` | reads all of it with Python alone, with webdataset, or with datasets |
| `index.html` | a gallery to look at, with filters; opens without a server |
| `spec.toml`, `snapshot-*.json.gz` | what it was made of |
| `SHA256SUMS` | checksums of every file |
";

const READING: &str = "\
```python
import load                                     # the file beside this card
for world in load.worlds(\".\", split=\"train\"):   # Python alone
    print(world[\"key\"], world[\"json\"][\"prompt\"], len(world[\"world\"][\"floorplan\"][\"rooms\"]))
table = load.index(\".\", split=\"train\")           # pyarrow
batches = load.as_webdataset(\".\", split=\"train\") # webdataset
rows = load.as_datasets(\".\")                      # datasets
```
";

fn header(whole: &Whole<'_>, statistics: &Statistics, title: &str) -> String {
    let quoted = |text: &str| serde_json::to_string(text).expect("a text is a text"); // JSON is YAML
    let size = match statistics.worlds {
        0..1_000 => "n<1K",
        1_000..10_000 => "1K<n<10K",
        10_000..100_000 => "10K<n<100K",
        100_000..1_000_000 => "100K<n<1M",
        _ => "1M<n<10M",
    };
    let mut text = format!(
        "---\nlicense: {}\npretty_name: {}\ntask_categories:\n- robotics\ntags:\n- indoor\n- simulation\n- floor-plans\n- scene-generation\n- d3dgen\nsize_categories:\n- {size}\nconfigs:\n",
        quoted(&whole.spec.license),
        quoted(title)
    );
    for (config, default, path) in [("index", true, "index/{split}.parquet"), ("worlds", false, "shards/{split}-*.tar")]
    {
        let _ = writeln!(text, "- config_name: {config}");
        if default {
            text += "  default: true\n";
        }
        text += "  data_files:\n";
        for split in whole.splits() {
            let _ = writeln!(text, "  - split: {split}\n    path: {}", path.replace("{split}", &split));
        }
    }
    text + "---\n"
}

fn splits(whole: &Whole<'_>, statistics: &Statistics) -> String {
    let of = |split: String| format!("{split} {}", statistics.splits.get(&split).copied().unwrap_or(0));
    let counts: Vec<String> = whole.splits().into_iter().map(of).collect();
    let mut text = format!("{} worlds, by prompt: no sentence is in two splits", counts.join(", "));
    let splits = &whole.spec.splits;
    if splits.by_asset() {
        let share = 100.0 * splits.held_out_assets;
        let _ = write!(
            text,
            "; by asset: about {share:.0} % of the sizes that objects come in beside their usual one stand in no world outside `{}`",
            splits.held_out_for
        );
    }
    text
}
