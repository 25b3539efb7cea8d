//! `revisit completions`: prints a shell completion script.

use clap::{Args, Command};
use clap_complete::Shell;

use super::failure::Failure;
use super::output::write_out;

/// Print a shell completion script.
///
/// For the current shell: `source <(revisit completions bash)`. To install it, write it to the shell's folder of
/// completions, such as ~/.local/share/bash-completion/completions/revisit.
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

/// Prints the completion script of this program.
pub fn run(args: &CompletionsArgs, mut program: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "revisit", &mut script);
    Ok(write_out(std::str::from_utf8(&script)?)?)
}
