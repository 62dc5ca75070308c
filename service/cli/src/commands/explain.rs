//! `d3dgen explain`: what the code of an error means, as `docs/errors.md` has it.

use crate::error::Error;
use crate::input::write_text;

const PAGE: &str = include_str!("../../../../docs/errors.md");
/// What begins the explanation of a code, before its name in ticks.
const HEADING: &str = "\n## `";

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Code that an error ended with; without one, all are listed
    code: Option<String>,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let all = explanations();
        let Some(code) = self.code else {
            let line =
                |(code, text): &(&str, &str)| format!("{code:<20} {}\n", text.lines().next().unwrap_or_default());
            return write_text(None, &all.iter().map(line).collect::<String>());
        };
        let found = all.iter().find(|(known, _)| *known == code);
        let (_, text) = found
            .ok_or_else(|| Error::Input(format!("`{code}` is no code of an error; `d3dgen explain` lists them")))?;
        write_text(None, &format!("{code}\n\n{text}\n"))
    }
}

/// Returns each code of the page with what is said about it, in the order of the page.
pub fn explanations() -> Vec<(&'static str, &'static str)> {
    let sections = PAGE.split(HEADING).skip(1);
    sections.filter_map(|s| s.split_once('`')).map(|(code, text)| (code, text.trim())).collect()
}
