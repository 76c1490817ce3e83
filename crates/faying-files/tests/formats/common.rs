//! Modules that several test programs share.

#[path = "../../../../tests/common/peer.rs"]
pub mod peer;
