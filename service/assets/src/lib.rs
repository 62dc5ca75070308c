//! The asset database: reads 3D models from the files of other programs, annotates them, keeps them, and finds them by
//! what they are for.
//!
//! | module | what |
//! |---|---|
//! | [`annotation`] | what is known of an asset, and how; ASA files |
//! | [`catalog`] | what a thing can be: the objects of all domains under all their names |
//! | [`annotate`] | what a model is, by rules |
//! | [`library`] | the assets that are shipped and made when needed |
//! | [`readers`] | the files of other programs |
//! | [`inspect`] | one line about a file |
//! | [`search`] | finding assets by what they are for |
//! | [`measure`] | what can be measured on its geometry |
//! | [`plausibility`] | repair of lying units and axes |

pub mod annotate;
pub mod annotation;
pub mod catalog;
pub mod error;
pub mod inspect;
pub mod library;
pub mod measure;
pub mod plausibility;
pub mod readers;
#[cfg(test)]
mod sample;
pub mod search;
pub mod words;

pub use error::Error;
