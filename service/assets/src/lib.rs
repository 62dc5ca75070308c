//! The asset database: reads 3D models from the files of other programs, annotates them, keeps them, and finds them by
//! what they are for.
//!
//! | module | what |
//! |---|---|
//! | [`readers`], [`inspect`] | the files of other programs, and one line about each |
//! | [`annotation`] | what is known of an asset, and how; ASA files |
//! | [`catalog`] | what a thing can be: the objects of all domains under all their names |
//! | [`plausibility`] | repair of lying units and axes |
//! | [`measure`], [`annotate`] | what a model is, by its geometry, its names and rules |
//! | [`library`] | the assets that are shipped and made when needed |
//! | [`database`], [`ingest`] | assets that are kept, and how folders of models become such |
//! | [`search`] | finding assets by what they are for |
//! | [`stock`] | which assets stand for the objects of a domain in worlds |
//! | [`placed`] | their models as worlds place them |

pub mod annotate;
pub mod annotation;
pub mod catalog;
pub mod database;
pub mod error;
pub mod ingest;
pub mod inspect;
pub mod library;
pub mod measure;
mod moved;
pub mod placed;
pub mod plausibility;
pub mod readers;
#[cfg(test)]
mod sample;
pub mod search;
pub mod stock;
pub mod words;

pub use error::Error;
