//! Modules that several test programs share.

#[path = "../common/blocks.rs"]
pub mod blocks;
#[path = "../common/cells.rs"]
pub mod cells;
#[path = "../common/coupled.rs"]
pub mod coupled;
