//! Floor 12: names become boxes, cases become models, models become results.

pub mod build;
mod commands;
pub mod convert;
pub mod infsup;
pub mod inspect;
mod json;
mod named;
pub mod output;
pub mod quantities;
pub mod registry;
pub mod result;
mod result_schema;
pub mod run;
pub mod studies;
mod unsolved;
pub mod watch;

pub use commands::main;
pub use named::Named;
pub use output::{Finished, Output, Parts, Picture, RunOptions, SideOutput, StepOutput};
pub use registry::{Family, Fault, MakeSolver, Names, Registry, SolverOptions, UnknownName};
pub use result::{RunResult, Status};
pub use result_schema::result_schema;
pub use watch::{Progress, Stop, Watch};
