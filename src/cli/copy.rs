//! `revisit copy`: everything in a database goes into another one.

use clap::Args;

use super::failure::Failure;
use super::output::write_out;
use crate::domain::counted::counted;
use crate::integrity::transfer::{expect_not_served, transfer};
use crate::store::{Store, without_password};

/// Copy everything from one database into another, such as from SQLite into PostgreSQL, or back.
///
/// No server may have either of them open. Each map is verified when it is copied: all of its rows, and the index that is
/// built from them, are the same in both. If the command is broken off, run it again: maps that were copied are verified and not
/// copied again. The target may hold nothing else. The source stays as it is, but for its schema, which is brought to
/// this version's.
#[derive(Args, Debug)]
pub struct CopyArgs {
    /// The database to copy: sqlite://FILE or postgres://USER@HOST/NAME
    #[arg(long, value_name = "URL")]
    from: String,
    /// The database to copy into, which may be empty or not there (a file)
    #[arg(long, value_name = "URL")]
    to: String,
}

/// Runs `copy`.
pub async fn run(args: CopyArgs) -> Result<(), Failure> {
    if args.from == args.to {
        return Err("the two databases are the same".into());
    }
    if let Some(file) = args.from.strip_prefix("sqlite://")
        && !std::path::Path::new(file).exists()
    {
        return Err(format!("there is no database {file}").into());
    }
    let from = Store::open(&args.from).await?;
    // First, for a target that is opened is there from then on.
    if let Err(error) = expect_not_served(&from, "source").await {
        from.close().await;
        return Err(error.into());
    }
    let to = match Store::open(&args.to).await {
        Ok(to) => to,
        Err(error) => {
            from.close().await;
            return Err(error.into());
        }
    };
    let done = transfer(&from, &to, |map| {
        let how = if map.was_there { "was copied before" } else { "copied" };
        let line = format!(
            "{}: {how}, version {}, {}, {}, verified\n",
            map.id,
            map.version,
            counted(map.keyframes as usize, "keyframe"),
            counted(map.rows as usize, "row")
        );
        // Whoever does not listen any more wants the copy all the same.
        drop(write_out(&line));
    });
    let done = done.await;
    from.close().await;
    to.close().await;
    let transferred = done?;
    let rows: u64 = transferred.iter().map(|map| map.rows).sum();
    let releases = transferred.iter().filter(|map| map.id.parts().1.is_some()).count();
    let of_maps = if releases > 0 { format!(", {}", counted(releases, "release")) } else { String::new() };
    Ok(write_out(&format!(
        "{}: {}{of_maps} and the keys, {}; the same in {}\n",
        without_password(&args.to),
        counted(transferred.len() - releases, "map"),
        counted(rows as usize, "row"),
        without_password(&args.from)
    ))?)
}
