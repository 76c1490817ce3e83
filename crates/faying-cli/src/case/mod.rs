//! Case files: TOML with places into a typed [`Case`], with every default filled in and every error listed.
//!
//! Stages of reading: parse (E005), apply `--set`, type every block, compare the blocks with each other, reject features
//! that are not implemented (E019). After an error of any stage reading continues if possible, so that several errors are
//! reported together.

mod axes;
mod boundary;
mod document;
mod expanded;
mod family;
mod files;
mod from_file;
mod given;
mod joints;
mod key;
mod mesh_part;
mod model;
mod names;
mod nurbs;
mod obstacle;
mod opened;
mod part;
mod patch;
mod queries;
mod read;
mod reader;
pub mod reference;
mod relations;
mod reports;
mod rows;
mod schema;
mod set;
mod shown_fields;
mod sides;
mod tie;
mod tree;
mod types;

pub use axes::Changes;
pub use files::FileRead;
pub use given::Given;
pub use key::{Absent, Axis, Key, KeyKind, Language};
pub use names::{EntryKeys, MethodEntry, Names};
pub(crate) use names::{built_in_couplings, built_in_methods};
pub use opened::sha256;
pub use part::{FilePart, MeshPart};
pub use read::{ReadOptions, not_found};
pub use schema::schema;
pub(crate) use sides::{alias, canonical, quoted};
pub use types::*;

/// The schema that this version writes and reads.
pub const SCHEMA: usize = 1;
