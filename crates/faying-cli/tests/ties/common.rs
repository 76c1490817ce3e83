//! Modules that several test programs share.

#[path = "../../../../tests/common/blocks.rs"]
pub mod blocks;
#[path = "../../../../tests/common/coupled.rs"]
pub mod coupled;
#[path = "../../../../tests/common/peer.rs"]
pub mod peer;
#[path = "../common/squares.rs"]
pub mod squares;
