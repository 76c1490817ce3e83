//! The program `faying`; all logic is in the library.

fn main() -> std::process::ExitCode {
    faying_cli::main(faying_cli::Registry::default())
}
