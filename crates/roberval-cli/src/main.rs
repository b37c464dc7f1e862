//! The roberval command.
fn main() {}
