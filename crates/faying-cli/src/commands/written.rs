//! `faying completions SHELL` and `faying man`: what the command line says about itself.

use super::arguments::{Arguments, CompletionsArguments};
use super::ended::Exit;
use clap::CommandFactory;
use serde_json::json;

/// Prints the completions of a shell.
pub fn completions(arguments: &CompletionsArguments) -> Exit {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "faying", &mut text);
    told("completions", &text)
}

/// Prints the manual: a page of the program and one of every command, in roff.
pub fn man() -> Exit {
    let mut text = Vec::new();
    let mut program = Arguments::command();
    program.build();
    // writing to a vector cannot fail
    let _ = clap_mangen::Man::new(program.clone()).render(&mut text);
    for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
        let _ = clap_mangen::Man::new(command.clone()).render(&mut text);
    }
    told("man", &text)
}

fn told(command: &str, text: &[u8]) -> Exit {
    let text = String::from_utf8_lossy(text).into_owned();
    Exit::done(command, text.clone(), json!({ "text": text }))
}
