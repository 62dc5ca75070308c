//! Text as outlines of an embedded font.
