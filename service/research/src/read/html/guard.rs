//! Parses HTML with a limit on what the parser can be made to do: nesting, and elements that it opens again and again.
//!
//! What it is not for: reading the tree. A page over the limits is read as far as they allow, with a warning.

use std::cell::RefCell;
use std::collections::BTreeMap;

use html5ever::LocalName;
use html5ever::interface::TreeSink;
use html5ever::tendril::StrTendril;
use html5ever::tokenizer::{
    BufferQueue, Doctype, Tag, TagKind, Token, TokenSink, TokenSinkResult, Tokenizer, TokenizerOpts,
};
use html5ever::tree_builder::{TreeBuilder, TreeBuilderOpts};
use scraper::{Html, HtmlTreeSink};

/// How deep elements may be nested. Browsers stop at 512.
const MAX_DEPTH: usize = 400;
/// How many tags are read.
const MAX_TAGS: usize = 1_500_000;
/// An unclosed `<b>` is opened again in every later paragraph: this is how many times in all.
const MAX_REOPENED: usize = 1_000_000;

/// Elements whose end tag may be left out, so that counting them says nothing about nesting.
const ENDLESS: &[&str] = &[
    "p", "li", "td", "th", "tr", "dt", "dd", "option", "optgroup", "thead", "tbody", "tfoot", "colgroup", "html",
    "head", "body", "rp", "rt", "caption",
];
/// Elements without content.
const VOID: &[&str] =
    &["area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "param", "source", "track", "wbr"];
/// Elements that the parser opens again after it had to close them.
const FORMATTING: &[&str] =
    &["a", "b", "big", "code", "em", "font", "i", "nobr", "s", "small", "strike", "strong", "tt", "u"];
/// Elements that an end tag outside of this list cannot close from within.
const BLOCKS: &[&str] = &[
    "address",
    "applet",
    "article",
    "aside",
    "blockquote",
    "button",
    "center",
    "details",
    "dir",
    "div",
    "dl",
    "fieldset",
    "figcaption",
    "figure",
    "footer",
    "form",
    "frameset",
    "h1",
    "h2",
    "h3",
    "h4",
    "h5",
    "h6",
    "header",
    "hgroup",
    "iframe",
    "listing",
    "main",
    "marquee",
    "menu",
    "nav",
    "object",
    "ol",
    "pre",
    "section",
    "select",
    "summary",
    "table",
    "template",
    "ul",
    "xmp",
];
/// Elements that no end tag inside can close anything beyond.
const SCOPES: &[&str] = &["applet", "marquee", "object", "table", "template", "svg", "math"];

/// Returns the tree of a page, and whether its end was left out.
pub fn parse(text: &str) -> (Html, bool) {
    let builder = TreeBuilder::new(HtmlTreeSink::new(Html::new_document()), TreeBuilderOpts::default());
    let guard = Guard { inner: builder, state: RefCell::default() };
    let tokenizer = Tokenizer::new(guard, TokenizerOpts::default());
    let input = BufferQueue::default();
    input.push_back(StrTendril::from(text));
    // The only other result asks to run a script; there is nothing to run.
    while !matches!(tokenizer.feed(&input), html5ever::interface::TokenizerResult::Done) {}
    tokenizer.end();
    let Guard { inner, state } = tokenizer.sink;
    (inner.sink.finish(), state.into_inner().over)
}

type Builder = TreeBuilder<<HtmlTreeSink as TreeSink>::Handle, HtmlTreeSink>;

struct Guard {
    inner: Builder,
    state: RefCell<State>,
}

/// What the parser must have open, told from the tags alone by the rules it follows. Each rule that would let a page open
/// more than is counted here is the parser's: an end tag that it passes over must not lower the count.
#[derive(Default)]
struct State {
    open: Vec<LocalName>,
    formatting: BTreeMap<LocalName, usize>,
    tags: usize,
    reopened: usize,
    over: bool,
}

impl State {
    /// Counts a tag, and tells whether it still may be read. `foreign` says that it stands in a drawing or formula, where
    /// an element may close itself.
    fn count(&mut self, tag: &Tag, foreign: bool) -> bool {
        if self.over {
            return false;
        }
        self.tags += 1;
        let name: &str = &tag.name;
        let formatting = FORMATTING.contains(&name);
        match tag.kind {
            TagKind::StartTag if formatting => *self.formatting.entry(tag.name.clone()).or_default() += 1,
            TagKind::EndTag if formatting => {
                self.formatting.entry(tag.name.clone()).and_modify(|n| *n = n.saturating_sub(1));
            }
            TagKind::StartTag => {
                self.reopened += self.formatting.values().sum::<usize>();
                let closed = tag.self_closing && foreign;
                if !closed && !VOID.contains(&name) && !ENDLESS.contains(&name) {
                    self.open.push(tag.name.clone());
                }
            }
            TagKind::EndTag => self.close(&tag.name),
        }
        let depth = self.open.len() + self.formatting.values().sum::<usize>();
        self.over |= depth > MAX_DEPTH || self.tags > MAX_TAGS || self.reopened > MAX_REOPENED;
        !self.over
    }

    /// Closes the innermost element of a name with all inside it, unless something stands between that keeps it open.
    fn close(&mut self, name: &LocalName) {
        let block = BLOCKS.contains(&&**name);
        for (i, open) in self.open.iter().enumerate().rev() {
            if open == name {
                self.open.truncate(i);
                return;
            }
            if SCOPES.contains(&&**open) || (!block && BLOCKS.contains(&&**open)) {
                return;
            }
        }
    }
}

impl TokenSink for Guard {
    type Handle = <Builder as TokenSink>::Handle;

    fn process_token(&self, token: Token, line: u64) -> TokenSinkResult<Self::Handle> {
        let reads = match &token {
            Token::TagToken(tag) => {
                let foreign = self.inner.adjusted_current_node_present_but_not_in_html_namespace();
                self.state.borrow_mut().count(tag, foreign)
            }
            Token::EOFToken => true,
            // Comments are never read; their text must not sit in the tree either.
            Token::CommentToken(_) | Token::ParseError(_) => false,
            Token::DoctypeToken(Doctype { .. }) => !self.state.borrow().over,
            Token::CharacterTokens(_) | Token::NullCharacterToken => !self.state.borrow().over,
        };
        if !reads {
            return TokenSinkResult::Continue;
        }
        match self.inner.process_token(token, line) {
            TokenSinkResult::Script(_) => TokenSinkResult::Continue,
            other => other,
        }
    }

    fn end(&self) {
        self.inner.end();
    }

    fn adjusted_current_node_present_but_not_in_html_namespace(&self) -> bool {
        self.inner.adjusted_current_node_present_but_not_in_html_namespace()
    }
}
