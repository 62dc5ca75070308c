//! Addresses: "221B Baker Street", "Hauptstraße 12", "12 rue de la Paix", "calle Mayor 5". Their words name no room and their
//! numbers count nothing.

use crate::tokens::text::{Kind, Span, Token};
use crate::tokens::words::{Spoken, Tag, tag_end};

/// Words of the name of a street, at most: "Martin Luther King".
const MOST_IN_NAME: usize = 3;
/// Little words between a word for a street and its name, at most: "rue de la".
const MOST_LITTLE: usize = 2;

/// Returns where addresses stand.
pub(crate) fn find(tokens: &[Token], spoken: &[&Spoken]) -> Vec<Span> {
    let reader = Reader { tokens, spoken };
    (0..tokens.len()).filter_map(|i| reader.behind_name(i).or_else(|| reader.before_name(i))).collect()
}

struct Reader<'a> {
    tokens: &'a [Token],
    spoken: &'a [&'a Spoken],
}

impl Reader<'_> {
    fn tagged(&self, i: usize, tag: Tag) -> Option<usize> {
        tag_end(self.spoken, self.tokens, i, tag)
    }

    /// Returns true for a word of a name: with a capital, and none that does anything else in a sentence.
    fn is_name(&self, i: usize) -> bool {
        let parts = [Tag::Stops, Tag::Starts, Tag::Joins, Tag::Near, Tag::Articles, Tag::Definite, Tag::PlaceBefore];
        let token = &self.tokens[i];
        token.kind == Kind::Word && token.capital && !parts.iter().any(|&t| self.tagged(i, t).is_some())
    }

    fn is_number(&self, i: usize) -> bool {
        self.tokens.get(i).is_some_and(|t| matches!(t.kind, Kind::Number(_)))
    }

    /// Returns the end of the number of a house behind its street: one that counts nothing that follows.
    fn house_behind(&self, end: usize) -> Option<usize> {
        let lettered =
            |i: usize| self.tokens.get(i).is_some_and(|t| t.kind == Kind::Word && !t.spaced && t.text.len() == 1);
        let number = Some(end).filter(|&i| self.is_number(i))?;
        let to = if lettered(number + 1) { number + 2 } else { number + 1 };
        let goes_on =
            |t: &Token| t.is_mark() || [Tag::Stops, Tag::Starts].iter().any(|&t| self.tagged(to, t).is_some());
        self.tokens.get(to).is_none_or(goes_on).then_some(to)
    }

    /// Returns where the number of a house before its street begins: "221", "221B".
    fn house_before(&self, start: usize) -> Option<usize> {
        let lettered = start.checked_sub(2).filter(|&k| self.is_number(k) && !self.tokens[k + 1].spaced);
        lettered.or_else(|| start.checked_sub(1).filter(|&k| self.is_number(k)))
    }

    /// "Baker Street", "Berliner Platz 3", "Hauptstraße 12"
    fn behind_name(&self, i: usize) -> Option<Span> {
        let german = self.spoken.iter().any(|s| s.language() == "de");
        let text = &self.tokens[i].text;
        let ends = self.spoken.iter().filter_map(|s| s.words.phrases.get(&Tag::StreetEnds)).flatten();
        let compound = ends.into_iter().any(|e| text.len() > e.len() + 2 && text.ends_with(e.as_str()));
        let street = self.tagged(i, Tag::Streets).filter(|_| self.tokens[i].capital);
        let end = street.or(Some(i + 1).filter(|_| compound && self.tokens[i].capital))?;
        let first = (i.saturating_sub(MOST_IN_NAME)..i).rev().take_while(|&k| self.is_name(k)).last();
        let start = if compound { i } else { first? };
        let behind = self.house_behind(end);
        // every noun of German has a capital
        if german && behind.is_none() {
            return None;
        }
        let before = self.house_before(start).filter(|_| !german);
        Some(Span { start: before.unwrap_or(start), end: behind.unwrap_or(end) })
    }

    /// "12 rue de la Paix", "calle Mayor 5"
    fn before_name(&self, i: usize) -> Option<Span> {
        let end = self.tagged(i, Tag::StreetsBefore)?;
        let little = |k: usize| [Tag::Stops, Tag::Definite].iter().any(|&t| self.tagged(k, t).is_some());
        let name = (end..(end + MOST_LITTLE + 1).min(self.tokens.len())).find(|&k| !little(k))?;
        let last = (name..(name + MOST_IN_NAME).min(self.tokens.len())).take_while(|&k| self.is_name(k)).last()?;
        let start = self.house_before(i).unwrap_or(i);
        Some(Span { start, end: self.house_behind(last + 1).unwrap_or(last + 1) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tokens::text::tokens;
    use crate::tokens::words::words;

    #[test]
    fn addresses_are_read_whole() {
        for (language, text, address) in [
            ("en", "office at 221B Baker Street London for 5 people", Some("221B Baker Street")),
            ("en", "flat in Market Street with 2 bedrooms", Some("Market Street")),
            ("en", "house with a street side and 3 bedrooms", None),
            ("de", "Büro in der Bankgasse 12 mit 3 Räumen", Some("Bankgasse 12")),
            ("de", "Büro am Berliner Platz 3, 4 Räume", Some("Berliner Platz 3")),
            ("de", "Haus mit Gasse und Platz", None),
            ("fr", "bureau au 12 rue de la Banque, 3 bureaux", Some("12 rue de la Banque")),
            ("es", "piso en la calle Mayor 5, 3 dormitorios", Some("calle Mayor 5")),
        ] {
            let (all, spoken) = (tokens(text), [&words().languages[language], &words().languages["en"]]);
            let found = find(&all, &spoken[..if language == "en" { 1 } else { 2 }]);
            let read = found.first().map(|s| &text[all[s.start].start..all[s.end - 1].end]);
            assert_eq!(read, address, "{text}");
        }
    }
}
