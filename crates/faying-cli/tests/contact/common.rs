//! Modules that several test programs share.

#[path = "../../../../tests/common/coupled.rs"]
pub mod coupled;
#[path = "../common/pressed.rs"]
pub mod pressed;
