//! The program itself: commands, files, exits, streams.
#![allow(clippy::unwrap_used)]

mod abaqus;
mod brivadis;
mod common;
mod compare;
mod dry_and_watch;
mod engineer;
mod files_cases;
mod files_solid;
mod foreign;
mod grammar;
mod hostile;
mod infsup_command;
mod inspect_convert;
mod messages;
mod one_row;
mod pictures;
mod program;
mod report;
mod schema;
mod spellings;
mod stored_reference;
mod studies;
mod study_rules;
mod vtk;
mod vtu_shared;
