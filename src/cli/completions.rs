//! `revisit completions`: prints a script that completes the commands and flags of `revisit` in a shell.

use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

use super::{Cli, Failure, write_out};

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

/// Runs it.
pub fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "revisit", &mut script);
    Ok(write_out(std::str::from_utf8(&script)?)?)
}
