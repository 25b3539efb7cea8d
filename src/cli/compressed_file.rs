//! Output file, compressed according to its name.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

/// Compression level of recordings that end in `.zst`, the default of zstd.
pub(in crate::cli) const ZSTD_LEVEL: i32 = 3;

/// An output file, compressed according to its name.
pub(in crate::cli) enum CompressedFile {
    Plain(BufWriter<File>),
    Gzip(Box<GzEncoder<File>>),
    Zstd(Box<zstd::Encoder<'static, File>>),
}

impl CompressedFile {
    /// Returns an output into a file, for the ending of this name.
    pub fn new(file: File, name: &Path, zstd_level: i32) -> io::Result<Self> {
        Ok(match name.extension().and_then(|ending| ending.to_str()) {
            Some("gz") => Self::Gzip(Box::new(GzEncoder::new(file, Compression::default()))),
            Some("zst") => Self::Zstd(Box::new(zstd::Encoder::new(file, zstd_level)?)),
            _ => Self::Plain(BufWriter::new(file)),
        })
    }

    /// Ends the compressed stream, and returns the file.
    pub fn finish(self) -> io::Result<File> {
        match self {
            Self::Plain(file) => file.into_inner().map_err(io::IntoInnerError::into_error),
            Self::Gzip(file) => file.finish(),
            Self::Zstd(file) => file.finish(),
        }
    }
}

impl Write for CompressedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Plain(file) => file.write(bytes),
            Self::Gzip(file) => file.write(bytes),
            Self::Zstd(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(file) => file.flush(),
            Self::Gzip(file) => file.flush(),
            Self::Zstd(file) => file.flush(),
        }
    }
}
