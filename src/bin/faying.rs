//! The command line of faying; all logic is in the library.

fn main() -> std::process::ExitCode {
    faying::app::main(faying::app::Registry::default())
}
