//! A file as it comes: plain, gzip or zstd, told by its first bytes whatever its name.

use std::io::{self, BufRead, BufReader, Cursor, Read};

const GZIP_MAGIC: &[u8] = &[0x1f, 0x8b];
const ZSTD_MAGIC: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];

/// Large enough that a read costs nothing beside what is done with it, and smaller than the pieces in which the binary form is
/// read: those go past the buffer.
const BUFFER_BYTES: usize = 64 * 1024;

/// Returns the bytes of a file, decompressed.
pub fn decompressed(bytes: impl Read + Send + 'static) -> io::Result<Box<dyn BufRead + Send>> {
    let (head, bytes) = peek(bytes, ZSTD_MAGIC.len())?;
    let bytes = BufReader::with_capacity(BUFFER_BYTES, bytes);
    if head.starts_with(GZIP_MAGIC) || head.starts_with(ZSTD_MAGIC) {
        inflated(bytes, head.starts_with(GZIP_MAGIC))
    } else {
        Ok(Box::new(bytes))
    }
}

#[cfg(feature = "compressed")]
fn inflated(bytes: impl BufRead + Send + 'static, is_gzip: bool) -> io::Result<Box<dyn BufRead + Send>> {
    Ok(if is_gzip {
        let bytes = flate2::bufread::MultiGzDecoder::new(bytes);
        Box::new(BufReader::with_capacity(BUFFER_BYTES, bytes))
    } else {
        Box::new(BufReader::with_capacity(BUFFER_BYTES, zstd::Decoder::with_buffer(bytes)?))
    })
}

#[cfg(not(feature = "compressed"))]
fn inflated(_: impl BufRead + Send + 'static, _: bool) -> io::Result<Box<dyn BufRead + Send>> {
    Err(io::Error::new(
        io::ErrorKind::Unsupported,
        "compressed; decompress it, or build with the feature `compressed`",
    ))
}

/// Returns the bytes of a vocabulary, decompressed, and whether they begin with `magic`.
pub(super) fn open(bytes: impl Read + Send + 'static, magic: &[u8]) -> io::Result<(impl BufRead, bool)> {
    let (head, bytes) = peek(decompressed(bytes)?, magic.len())?;
    Ok((bytes, head == magic))
}

/// What has been read of a reader, and the reader.
type Whole<R> = io::Chain<Cursor<Vec<u8>>, R>;

/// Returns the first `count` bytes, or as many as there are, and a reader that still has them before it.
fn peek<R: Read>(mut bytes: R, count: usize) -> io::Result<(Vec<u8>, Whole<R>)> {
    let mut head = Vec::new();
    bytes.by_ref().take(count as u64).read_to_end(&mut head)?;
    Ok((head.clone(), Cursor::new(head).chain(bytes)))
}
