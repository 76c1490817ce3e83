//! The examples run: each is a program, and here a test.

#[path = "../../examples/02_own_multiplier.rs"]
mod own_multiplier;

#[path = "../../examples/03_own_contact.rs"]
mod own_contact;

#[test]
fn a_multiplier_from_outside_is_tied_by_its_name() {
    own_multiplier::main().unwrap();
}

#[test]
fn a_contact_algorithm_from_outside_agrees_with_the_active_set() {
    own_contact::main().unwrap();
}
