//! Modules that several test programs share.

#[path = "../../../../tests/common/cells.rs"]
pub mod cells;
#[path = "../common/json_schema.rs"]
pub mod json_schema;
#[path = "../../../../tests/common/peer.rs"]
pub mod peer;
