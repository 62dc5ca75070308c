//! A prompt as it is heard: its words and numbers in the language it is in. Every step of the reading takes it.

use d3dgen_model::brief::Brief;
use d3dgen_model::scene_graph::Note;
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;

use super::subject::building;
use super::tokens::numbers::{self, Number};
use super::tokens::text::{Kind, Token, tokens};
use super::tokens::typos::{self, Typo};
use super::tokens::words::{Spoken, Tag, is_tagged, words};
use super::tokens::{language, umlauts};
use crate::request::refused;

/// The words of a prompt.
pub(crate) struct Heard<'p> {
    pub prompt: &'p str,
    pub tokens: Vec<Token>,
    pub numbers: Vec<Number>,
    pub language: &'static str,
    /// The language it is in, and English.
    pub languages: Vec<&'static str>,
    /// How these are spoken.
    pub spoken: Vec<&'static Spoken>,
    /// The language it seems to be in, where that is none that is read.
    pub strange: Option<&'static str>,
    /// Words that were read as others.
    typos: Vec<Typo>,
}

impl<'p> Heard<'p> {
    /// Takes a prompt apart.
    ///
    /// # Errors
    /// `Refused` for prompts without words.
    pub(crate) fn of(prompt: &'p str, registry: &Registry) -> Result<Self, Error> {
        let mut tokens = tokens(prompt);
        umlauts::restore(&mut tokens, registry);
        if tokens.iter().all(Token::is_mark) {
            let message = "the prompt has no words; describe a building, for instance `two-bedroom flat in Germany`";
            return Err(refused(message.into()));
        }
        let language = language::detect(&tokens, |code| building::words_known(&tokens, registry, code));
        let languages = if language == "en" { vec!["en"] } else { vec![language, "en"] };
        let spoken: Vec<&Spoken> = languages.iter().filter_map(|l| words().languages.get(*l)).collect();
        let known = building::words_known(&tokens, registry, language);
        let strange = language::unread(prompt, &tokens, language, known);
        let typos = match strange {
            Some(_) => Vec::new(),
            None => typos::mend(&mut tokens, &languages, &spoken, registry),
        };
        let numbers = numbers::numbers(&tokens, language, &spoken);
        Ok(Self { prompt, tokens, numbers, language, languages, spoken, strange, typos })
    }

    /// Returns what is heard of a brief, which has no words but a silent one for each of its `mentions`, at
    /// [`Heard::place_of`] it; marks stand between, so that none belongs to the next.
    pub(crate) fn of_facts(brief: &Brief, mentions: usize) -> Self {
        let silent = |kind| Token { text: String::new(), kind, start: 0, end: 0, spaced: true, capital: false };
        let tokens = (0..mentions).flat_map(|_| [silent(Kind::Word), silent(Kind::Mark(';'))]).collect();
        let first = brief.languages.first().map_or("en", String::as_str);
        let language = words().languages.keys().find(|l| *l == first).map_or("en", String::as_str);
        let spoken = words().languages.get("en").into_iter().collect();
        Self {
            prompt: "",
            tokens,
            numbers: Vec::new(),
            language,
            languages: vec!["en"],
            spoken,
            strange: None,
            typos: Vec::new(),
        }
    }

    /// Returns the place of the word of a mention of a brief.
    pub(crate) fn place_of(mention: usize) -> usize {
        2 * mention
    }

    /// Returns what is told about misspelled words.
    pub(crate) fn spelling(&self) -> Option<Note> {
        let mut read: Vec<String> = Vec::new();
        for typo in &self.typos {
            let token = &self.tokens[typo.at];
            let told = format!("`{}` as {}", &self.prompt[token.start..token.end], typo.read);
            if !read.contains(&told) {
                read.push(told);
            }
        }
        (!read.is_empty()).then(|| Note::new("spelling", format!("read {}", read.join(", "))))
    }

    /// Returns true where a phrase with a tag begins at a token.
    pub(crate) fn is_tagged(&self, i: usize, tag: Tag) -> bool {
        is_tagged(&self.spoken, &self.tokens, i, tag)
    }

    /// Returns true where the prompt has a phrase with a tag.
    pub(crate) fn says(&self, tag: Tag) -> bool {
        (0..self.tokens.len()).any(|i| self.is_tagged(i, tag))
    }
}

/// What the reader tells about its reading.
#[derive(Default)]
pub(crate) struct Notes {
    pub assumptions: Vec<Note>,
    pub conflicts: Vec<Note>,
}
