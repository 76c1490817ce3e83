//! Case files.
#![cfg(feature = "cli")]
use faying::io::case::{Case, ReadOptions};
#[test]
fn probe() {
    for n in ["contact-patch", "poisson-arc", "hertz", "iga-fe-arc"] {
        match Case::read(format!("examples/cases/{n}.toml")) {
            Ok(c) => {
                println!("{}", c.effective_toml());
                let again = Case::parse("e", c.effective_toml(), &ReadOptions::default());
                match again { Ok(d) => println!("same {}", c == d), Err(e) => println!("{e}") }
            }
            Err(e) => println!("{e}"),
        }
    }
}
