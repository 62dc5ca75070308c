//! Thin clients of language-model providers.
