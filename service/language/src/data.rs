//! What `data/` holds, checked when it is read.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::fold::fold;

/// Files of `data/`: their path in it, and their text.
const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/files.rs"));

/// Why data of languages cannot be read; each message names the file and the place in it.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum Error {
    /// A file is not TOML of the form that it should have.
    #[error("{file}: {reason}")]
    Form {
        /// Path in `data/`.
        file: String,
        /// What the reader of TOML says.
        reason: String,
    },
    /// A file names a class that `classes.toml` does not know.
    #[error("{file}: `{class}` is no class of words; classes.toml lists those there are")]
    Class {
        /// Path in `data/`.
        file: String,
        /// The class.
        class: String,
    },
    /// A phrase is empty, or stands twice in one list.
    #[error("{file}: `{phrase}` in {class}.{value} {reason}")]
    Phrase {
        /// Path in `data/`.
        file: String,
        /// Class of the list.
        class: String,
        /// Value of the list.
        value: String,
        /// The phrase.
        phrase: String,
        /// What is wrong.
        reason: &'static str,
    },
    /// A folder has no `language.toml`.
    #[error("{0}: a folder of a language needs a language.toml")]
    NoLanguage(String),
}

/// One phrase, and what it stands for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Words {
    /// For instance `room`, `particle`, `number`.
    pub class: String,
    /// For instance `kitchen`, `no`, `12`.
    pub value: String,
    /// One word or more, as people write it.
    pub phrase: String,
}

/// How words of a language are built, and its lexicon.
#[derive(Debug, Clone, PartialEq)]
pub struct LanguageData {
    /// Name of its folder: an ISO 639-1 code, or `any` for what is the same in all languages.
    pub code: String,
    /// Name of the language in English.
    pub name: String,
    /// Mark before the decimals of a number.
    pub decimal: char,
    /// True where the noun of a name of several words stands last ("music room"), false where it stands first ("salle de musique").
    pub head_last: bool,
    /// True where an owner stands before what it owns ("病院の食堂"), false where it stands behind ("the canteen of a hospital").
    pub owner_first: bool,
    /// True where words for how things lie stand behind what they refer to ("資料室の隣に").
    pub postpositions: bool,
    /// Endings that do not count, longest first.
    pub(crate) endings: Vec<Ending>,
    /// Endings of more than one, and what one ends in instead.
    pub(crate) plural: Vec<Ending>,
    /// Spellings inside of words that do not count: from, to; folded.
    pub(crate) same: Vec<(String, String)>,
    /// Letters between the parts of compounds; empty where words are not compounded.
    pub(crate) joints: Vec<String>,
    /// How letters are typed without their marks: from, to.
    pub(crate) transcriptions: Vec<(String, String)>,
    /// Words that look like misspellings and are none; folded.
    pub(crate) lookalikes: Vec<String>,
    /// Letters that tell the language from others: first and last of each run.
    pub(crate) letters: Vec<(char, char)>,
    /// True where names of places are inflected as other words are.
    pub names_decline: bool,
    /// The lexicon.
    pub words: Vec<Words>,
}

/// An ending that does not count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Ending {
    /// What is taken away.
    pub strip: String,
    /// What is put in its place.
    pub put: String,
    /// How many letters at least must be left.
    pub keep: usize,
}

/// What is known of languages nobody wrote a folder for: enough to name them.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Unread {
    /// Frequent words by name of the language.
    pub words: BTreeMap<String, Vec<String>>,
    /// First and last letter of scripts, by name of the language that is meant.
    pub scripts: BTreeMap<String, (char, char)>,
}

/// What a class of words is.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Class {
    /// What its values are, for people.
    #[allow(dead_code, reason = "for those who read the file")]
    about: String,
    /// True when its words count only as they are written, not inflected.
    #[serde(default)]
    pub exact: bool,
    /// True when its words are also understood amid another language.
    #[serde(default)]
    pub travels: bool,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LanguageFile {
    name: String,
    #[serde(default = "dot")]
    decimal: char,
    #[serde(default)]
    head: Head,
    #[serde(default)]
    owner_first: bool,
    #[serde(default)]
    postpositions: bool,
    #[serde(default)]
    endings: Vec<String>,
    #[serde(default)]
    plural: Vec<String>,
    #[serde(default)]
    same: BTreeMap<String, String>,
    #[serde(default)]
    joints: Vec<String>,
    #[serde(default)]
    transcriptions: BTreeMap<String, String>,
    #[serde(default)]
    lookalikes: String,
    #[serde(default)]
    letters: Vec<String>,
    #[serde(default)]
    names_decline: bool,
}

#[derive(Debug, Default, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Head {
    First,
    #[default]
    Last,
}

fn dot() -> char {
    '.'
}

/// All that `data/` holds.
#[derive(Debug)]
pub(crate) struct Shipped {
    pub languages: Vec<LanguageData>,
    pub classes: BTreeMap<String, Class>,
    pub unread: Unread,
}

/// Reads the files of the crate.
///
/// # Errors
/// The first file that is not as it should be.
pub(crate) fn shipped() -> Result<Shipped, Error> {
    read(FILES)
}

fn read(files: &[(&str, &str)]) -> Result<Shipped, Error> {
    let mut classes = BTreeMap::new();
    let mut unread = Unread::default();
    let mut languages: BTreeMap<&str, (Option<LanguageData>, Vec<Words>)> = BTreeMap::new();
    for (file, text) in files {
        match file.split_once('/') {
            None if *file == "classes.toml" => classes = form(file, text)?,
            None => unread = form(file, text)?,
            Some((code, "language.toml")) => languages.entry(code).or_default().0 = Some(language(file, code, text)?),
            Some((code, _)) => languages.entry(code).or_default().1.extend(words(file, text)?),
        }
    }
    let mut found = Vec::new();
    for (code, (language, words)) in languages {
        let Some(mut language) = language else { return Err(Error::NoLanguage(code.to_owned())) };
        if let Some(word) = words.iter().find(|w| !classes.contains_key(&w.class)) {
            return Err(Error::Class { file: code.to_owned(), class: word.class.clone() });
        }
        language.words = words;
        found.push(language);
    }
    Ok(Shipped { languages: found, classes, unread })
}

fn form<T: serde::de::DeserializeOwned>(file: &str, text: &str) -> Result<T, Error> {
    toml::from_str(text).map_err(|e| Error::Form { file: file.to_owned(), reason: e.to_string() })
}

fn language(file: &str, code: &str, text: &str) -> Result<LanguageData, Error> {
    let read: LanguageFile = form(file, text)?;
    let mut endings: Vec<Ending> = read.endings.iter().map(|e| ending(e)).collect();
    endings.sort_by_key(|e| std::cmp::Reverse(e.strip.chars().count()));
    let mut joints = read.joints;
    joints.sort_by_key(|j| std::cmp::Reverse(j.len()));
    Ok(LanguageData {
        code: code.to_owned(),
        name: read.name,
        decimal: read.decimal,
        head_last: read.head == Head::Last,
        owner_first: read.owner_first,
        postpositions: read.postpositions,
        endings,
        plural: read.plural.iter().map(|e| ending(e)).collect(),
        same: read.same.into_iter().map(|(from, to)| (fold(&from), fold(&to))).collect(),
        joints,
        transcriptions: read.transcriptions.into_iter().collect(),
        lookalikes: read.lookalikes.split_whitespace().map(fold).collect(),
        letters: read.letters.iter().filter_map(|r| Some((r.chars().next()?, r.chars().next_back()?))).collect(),
        names_decline: read.names_decline,
        words: Vec::new(),
    })
}

/// Reads an ending: `es` is taken away, `ies>y` becomes `y`, `e/4` leaves four letters at least (else three).
fn ending(text: &str) -> Ending {
    let (text, keep) = text.split_once('/').map_or((text, 3), |(e, k)| (e, k.parse().unwrap_or(3)));
    let (strip, put) = text.split_once('>').unwrap_or((text, ""));
    Ending { strip: fold(strip), put: fold(put), keep }
}

fn words(file: &str, text: &str) -> Result<Vec<Words>, Error> {
    let tables: BTreeMap<String, BTreeMap<String, Vec<String>>> = form(file, text)?;
    let mut found = Vec::new();
    for (class, values) in tables {
        for (value, phrases) in values {
            for (i, phrase) in phrases.iter().enumerate() {
                let reason = match () {
                    () if phrase.trim().is_empty() => "is empty",
                    () if phrases[..i].contains(phrase) => "stands twice in one list",
                    () => {
                        found.push(Words { class: class.clone(), value: value.clone(), phrase: phrase.clone() });
                        continue;
                    }
                };
                let (file, phrase) = (file.to_owned(), phrase.clone());
                return Err(Error::Phrase { file, class, value, phrase, reason });
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_of_the_crate_are_as_they_should_be() {
        let shipped = shipped().unwrap_or_else(|e| panic!("{e}"));
        for language in &shipped.languages {
            if language.code == "any" {
                continue;
            }
            // what every language must say for a prompt to be read in it
            for class in
                ["particle", "number", "room_word", "storey", "relation", "attribute", "robot", "person", "capacity"]
            {
                assert!(language.words.iter().any(|w| w.class == class), "{}: no {class}", language.code);
            }
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_file() {
        let classes = ("classes.toml", "room = { about = \"rooms\" }");
        let check = |file: (&'static str, &'static str), part: &str| {
            let error =
                read(&[classes, file, ("xx/language.toml", "name = \"X\"")]).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        };
        check(("xx/words.toml", "[rom]\nkitchen = [\"k\"]"), "`rom` is no class of words");
        check(("xx/words.toml", "[room]\nkitchen = [\"k\", \"k\"]"), "xx/words.toml: `k` in room.kitchen stands twice");
        check(("xx/words.toml", "[room]\nkitchen = [\"\"]"), "is empty");
        check(("xx/words.toml", "[room]\nkitchen = 3"), "xx/words.toml");
        check(("yy/words.toml", "[room]\nkitchen = [\"k\"]"), "yy: a folder of a language needs a language.toml");
    }
}
