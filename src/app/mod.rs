//! Floor 12: names become boxes, cases become models, models become results.

pub mod output;
pub mod watch;

pub use output::{Output, Picture, SideOutput};
pub use watch::{Progress, Stop, Watch};
