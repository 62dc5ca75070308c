//! Every byte of a few worlds, one of each shipped domain and two of several storeys: `golden/<case>.sha256` lists the files `generate` writes with
//! their checksums. The documents are named by stage, so the first line that differs says where a change begins.

use std::fmt::Write;

use d3dgen_tests::{digest, files, golden, run_well, workspace};

/// Name, seed, prompt.
const CASES: &[(&str, &str, &str)] = &[
    ("flat_de", "1", "two-bedroom flat in Germany, for a cleaning robot"),
    ("office_us", "2", "office for 12 people in New York with two meeting rooms"),
    ("ward_de", "3", "hospital ward with 8 rooms in Germany, for a delivery robot"),
    ("school", "4", "primary school with four classrooms and a cleaning robot"),
    ("warehouse", "5", "warehouse with a loading dock, an office and charging for two robots"),
    ("hotel_fr", "6", "hôtel de 9 pièces à Lyon"),
    ("house_two_storeys", "7", "two-storey house in Germany with 4 bedrooms upstairs, for a cleaning robot"),
    ("office_three_storeys", "8", "three floor office building in London with 6 offices and 2 meeting rooms"),
];

#[test]
fn worlds_are_what_they_were_byte_for_byte() {
    let home = tempfile::tempdir().unwrap();
    for (case, seed, prompt) in CASES {
        run_well(home.path(), &["generate", prompt, "--seed", seed, "--name", case, "--out", case]);
        let mut list = String::new();
        for (name, bytes) in files(&home.path().join(case)) {
            let sum = digest(&bytes);
            writeln!(list, "{sum}  {name}").unwrap();
        }
        golden(&workspace().join(format!("tests/golden/{case}.sha256")), &list);
    }
}
