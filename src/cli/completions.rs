//! `revisit completions`: prints a script that completes the commands and flags of `revisit` in a shell.

use clap::{Args, Command};
use clap_complete::Shell;

use super::failure::Failure;
use super::output::write_out;

/// Print the script that completes commands and flags in a shell.
///
/// For the shell that is open now: `source <(revisit completions bash)`. To keep it, write it where the shell looks for
/// completions, say to ~/.local/share/bash-completion/completions/revisit.
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// The shell to write it for
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

/// Prints the script that completes this program.
pub fn run(args: &CompletionsArgs, mut program: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "revisit", &mut script);
    Ok(write_out(std::str::from_utf8(&script)?)?)
}
