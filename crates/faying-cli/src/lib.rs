//! The program `faying` as a library: case files, the registry of names, runs, studies, reports.
//!
//! | module | content |
//! | --- | --- |
//! | [`case`] | case files: grammar, reading, changes |
//! | [`formula`] | formulas of x, y, z and t |
//! | [`errors`], [`codes`], [`place`] | diagnostics with code, place and help |
//! | [`registry`] | names of backends, multipliers, integrations, couplings, methods, solvers, materials, obstacles |
//! | [`lower`] | models built from cases |
//! | [`run`], [`studies`], [`infsup`] | solution of models, studies, inf-sup tests |
//! | [`quantities`] | quantities of probes and checks |
//! | [`mod@reference`] | stored runs, against which others are compared |
//! | [`plot`], [`table`], [`output`], [`result`] | pictures, tables and `result.json` |
//! | [`convert`], [`inspect`] | geometry and mesh files |
//!
//! To add names of your own, put them into a [`Registry`] and pass it to [`main`].

mod builtin;
pub mod case;
pub mod codes;
mod commands;
pub mod convert;
pub mod errors;
pub mod formula;
pub mod infsup;
pub mod inspect;
mod json;
mod lines;
pub mod lower;
pub mod marks;
mod null_out;
pub mod output;
mod page;
pub mod place;
pub mod plot;
pub mod quantities;
pub mod reference;
pub mod registry;
pub mod result;
mod result_schema;
pub mod run;
pub mod run_control;
pub mod shapes;
pub mod studies;
pub mod table;
mod text_format;

pub use case::Case;
pub use commands::main;
pub use errors::{Diagnostic, Diagnostics, Severity};
pub use formula::Formula;
pub use indexmap::IndexMap;
pub use marks::{ClosestInPlane, Mark, MarkKind, RigidFace, RigidPicture, RigidShape};
pub use output::{
    DisplacementFactor, ExactAlong, FieldRange, Finished, Output, Panel, Parts, Picture, RunOptions, SideOutput, SidePart, StepOutput,
};
pub use place::{Located, SourceSpan};
pub use registry::{Family, Fault, MakeSolver, Names, Registry, SolverOptions, UnknownName};
pub use result::{RunResult, Status};
pub use result_schema::result_schema;
pub use run_control::{Progress, RunControl, Stop};
