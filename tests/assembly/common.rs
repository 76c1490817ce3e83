//! Modules that several test programs share.

#[path = "../common/bulk.rs"]
pub mod bulk;
#[path = "../common/cells.rs"]
pub mod cells;
#[path = "../common/graphs.rs"]
pub mod graphs;
#[path = "../common/plain.rs"]
pub mod plain;
#[path = "../common/products.rs"]
pub mod products;
#[path = "../common/states.rs"]
pub mod states;
