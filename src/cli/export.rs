//! `revisit export`: a map as a recording.

use std::fs::Permissions;
use std::io::{self, Write};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use clap::Args;
use tempfile::NamedTempFile;

use super::compressed_file::{CompressedFile, ZSTD_LEVEL};
use super::failure::Failure;
use crate::api::recording::write_line;
use crate::client::{Client, ClientError};
use crate::domain::counted::counted;
use crate::domain::ids::MapId;
use crate::integrity::backup::{folder_of, regular_or_free};
use crate::store::Export;
use crate::store::files::paths::DatabaseFiles;

/// Approximate size of the pieces in which lines are written.
const PIECE_BYTES: usize = 64 << 10;

/// Export a map as a recording, even while a server is running.
///
/// One operation per line, in write order, each with its original body. `revisit replay FILE` rebuilds the same map on
/// any server, with the same verdicts. Deleted keyframes are omitted. A FILE that ends in `.zst` or `.gz` is
/// compressed. It appears only once it is complete.
#[derive(Args, Debug)]
pub struct ExportArgs {
    /// The map
    map: MapId,
    /// The file to write; `-` is standard output
    file: PathBuf,
    /// The database to read
    #[arg(long, env = "REVISIT_DATABASE", value_name = "URL", default_value = "sqlite://revisit.db")]
    database: String,
    /// Export from this server instead of a database
    #[arg(long, env = "REVISIT_SERVER", value_name = "URL")]
    server: Option<String>,
    /// API key for --server
    #[arg(long, env = "REVISIT_KEY", value_name = "SECRET", hide_env_values = true)]
    key: Option<String>,
    /// Replace an existing file
    #[arg(long, env = "REVISIT_FORCE")]
    force: bool,
}

/// Runs `export`.
pub async fn run(args: ExportArgs) -> Result<(), Failure> {
    if args.file == Path::new("-") {
        return match export(&args, &mut io::stdout().lock()).await {
            Err(failure) if is_closed_pipe(&failure) => Ok(()),
            exported => exported.map(drop),
        };
    }
    if args.file.exists() && !args.force {
        return Err(format!("{} exists; --force replaces it", args.file.display()).into());
    }
    regular_or_free(&args.file)?;
    let file = temporary(&args.file).map_err(|error| format!("{}: {error}", args.file.display()))?;
    let mut to = CompressedFile::new(file.reopen()?, &args.file, ZSTD_LEVEL)?;
    let lines = export(&args, &mut to).await?;
    to.finish()?.sync_all()?;
    let written = if args.force { file.persist(&args.file) } else { file.persist_noclobber(&args.file) };
    let bytes = written.map_err(|error| error.error)?.metadata()?.len();
    eprintln!("{}: {}, {bytes} bytes", args.file.display(), counted(lines, "operation"));
    Ok(())
}

/// Returns a file beside this one, with the mode that the user's umask gives new files.
fn temporary(beside: &Path) -> io::Result<NamedTempFile> {
    let mode = Permissions::from_mode(0o666);
    tempfile::Builder::new().permissions(mode).tempfile_in(folder_of(beside))
}

/// Whether standard output was closed, which is not an error.
fn is_closed_pipe(failure: &Failure) -> bool {
    let error = failure.downcast_ref::<ClientError>();
    matches!(error, Some(ClientError::Write(error)) if error.kind() == io::ErrorKind::BrokenPipe)
}

/// Writes the lines of a map, and returns their number.
async fn export(args: &ExportArgs, to: &mut impl Write) -> Result<usize, Failure> {
    match &args.server {
        Some(server) => of_server(args, server, to).await,
        None => of_database(args, to).await,
    }
}

async fn of_server(args: &ExportArgs, server: &str, to: &mut impl Write) -> Result<usize, Failure> {
    let client = Client::new(server)?.with_key(args.key.clone());
    let mut lines = 0;
    let take = |bytes: &[u8]| {
        lines += bytes.split(|byte| *byte == b'\n').count() - 1;
        to.write_all(bytes)
    };
    client.export(args.map.as_str(), take).await?;
    to.flush().map_err(ClientError::Write)?;
    Ok(lines)
}

async fn of_database(args: &ExportArgs, to: &mut impl Write) -> Result<usize, Failure> {
    let files = DatabaseFiles::of_url(&args.database)?;
    if !files.exist() {
        return Err(format!("there is no database {}", files.database().display()).into());
    }
    let Some(mut export) = Export::of_database(&files, &args.map).await? else {
        return Err(format!("there is no map {} in the database", args.map).into());
    };
    let (mut lines, mut piece) = (0, Vec::new());
    while let Some(recorded) = export.next().await? {
        write_line(&args.map, recorded, &mut piece).map_err(|error| ClientError::Write(error.into()))?;
        lines += 1;
        if piece.len() >= PIECE_BYTES {
            to.write_all(&piece).map_err(ClientError::Write)?;
            piece.clear();
        }
    }
    to.write_all(&piece).and_then(|()| to.flush()).map_err(ClientError::Write)?;
    Ok(lines)
}
