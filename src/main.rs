//! Parses the command line, runs one command, prints the error chain.

use std::process::ExitCode;

use clap::Parser as _;
use nephoscope::cli;

fn main() -> ExitCode {
    match cli::run(cli::Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            cli::print_error(&error);
            cli::exit_code(&error)
        }
    }
}
