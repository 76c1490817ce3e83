//! The command line of faying; all logic is in the library.
fn main() {}
