//! Tesseract: a local text reader (OCR), run by its command line, so that a plain machine can read door plates.

use std::io;
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use thiserror::Error;
use tokio::io::AsyncWriteExt as _;
use tokio::process::Command;

use super::imaging;
use super::picture::Picture;
use crate::semantics;

/// The source name of its readings.
pub const SOURCE: &str = "tesseract";

const PROGRAM: &str = "tesseract";

/// Timeout; one plate takes a few tenths of a second.
const TIME_MAX: Duration = Duration::from_secs(20);

/// A longer reading is noise.
const CHARS_MAX: usize = 500;

/// The reason why nothing was read.
#[derive(Debug, Error)]
pub enum ReaderError {
    /// The program is missing, or does not run.
    #[error("tesseract does not run: {0}")]
    Program(#[from] io::Error),
    /// It exited with an error.
    #[error("tesseract failed with {0}")]
    Failed(std::process::ExitStatus),
    /// It timed out.
    #[error("tesseract took longer than {} s", TIME_MAX.as_secs())]
    TimedOut,
    /// The image could not be prepared.
    #[error("the image could not be prepared")]
    Image,
}

/// The reader, if installed on this machine.
#[derive(Clone, Debug)]
pub struct Tesseract;

impl Tesseract {
    /// Looks for the program.
    pub async fn find() -> Result<Self, ReaderError> {
        let output = Command::new(PROGRAM).arg("--version").stdin(Stdio::null()).output().await?;
        if output.status.success() { Ok(Self) } else { Err(ReaderError::Failed(output.status)) }
    }

    /// Reads one line of text; empty if there is none.
    pub async fn read(&self, picture: Arc<Picture>) -> Result<String, ReaderError> {
        let prepared = tokio::task::spawn_blocking(move || imaging::page(&picture));
        let page = prepared.await.map_err(|_| ReaderError::Image)?.ok_or(ReaderError::Image)?;
        // One line, by the neural engine; image and text are piped, without files.
        let mut child = Command::new(PROGRAM)
            .args(["stdin", "stdout", "--psm", "7", "--oem", "1"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .kill_on_drop(true)
            .spawn()?;
        let mut stdin = child.stdin.take();
        let exchange = async {
            if let Some(stdin) = &mut stdin {
                // It may close its input early; its exit status decides.
                let _ = stdin.write_all(&page).await;
            }
            drop(stdin);
            child.wait_with_output().await
        };
        let output = tokio::time::timeout(TIME_MAX, exchange).await.map_err(|_| ReaderError::TimedOut)??;
        if !output.status.success() {
            return Err(ReaderError::Failed(output.status));
        }
        let text = semantics::clean(&String::from_utf8_lossy(&output.stdout));
        Ok(text.chars().take(CHARS_MAX).collect())
    }
}
