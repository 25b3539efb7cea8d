//! Judges the windows of a file, and prints those that are not linearizable.

use std::process::ExitCode;

use revisit_lease_model::history::read;

fn main() -> ExitCode {
    let [path] = &std::env::args().skip(1).collect::<Vec<_>>()[..] else {
        eprintln!("usage: histories FILE");
        return ExitCode::from(2);
    };
    let windows =
        match std::fs::read_to_string(path).map_err(|error| error.to_string()).and_then(|lines| read(&lines))
        {
            Ok(windows) => windows,
            Err(error) => {
                eprintln!("{path}: {error}");
                return ExitCode::from(2);
            }
        };
    let wrong: Vec<_> = windows.iter().filter(|window| !window.is_linearizable()).collect();
    for window in &wrong {
        println!("not linearizable: {window:?}");
    }
    let operations: usize = windows.iter().map(|window| window.operations.len()).sum();
    println!("{operations} operations in {} windows, {} not linearizable", windows.len(), wrong.len());
    ExitCode::from(u8::from(!wrong.is_empty()))
}
