//! Decompression: inflates a compressed body, and rejects a decompression bomb before it takes memory.
//!
//! A whole body is inflated twice: first to measure it without storing it, then to decode it. A stream of lines is
//! inflated incrementally. The expansion is limited ([`crate::http::guards::body_memory::becomes_at_most`]). So is the
//! window of a zstd frame, which the sender chooses and the reader must hold.

use std::io::{self, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use async_compression::tokio::bufread::{GzipDecoder, ZstdDecoder};
use async_compression::zstd::DParameter;
use axum::body::Body;
use axum::http::HeaderMap;
use axum::http::header::CONTENT_ENCODING;
use flate2::bufread::MultiGzDecoder;
use futures_util::TryStreamExt as _;
use tokio::io::AsyncRead;
use tokio_util::io::{ReaderStream, StreamReader};

use crate::http::problem::{Kind, Problem};

/// Maximum zstd window, 8 MiB: the size that RFC 8878 recommends readers to support, and that `zstd -19` uses.
const ZSTD_WINDOW_LOG_MAX: u32 = 23;
/// Memory of a zstd stream while it is read.
const ZSTD_STREAM_BYTES: usize = (1 << ZSTD_WINDOW_LOG_MAX) + (512 << 10);
/// Size of the pieces in which a body is measured, in bytes.
const PIECE_BYTES: usize = 32 << 10;

/// The compression of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// None.
    Identity,
    /// RFC 1952; one or more members.
    Gzip,
    /// RFC 8878; one or more frames.
    Zstd,
}

impl Encoding {
    /// Reads the headers. Nested encodings are rejected: only decompression bombs need them.
    pub fn of(headers: &HeaderMap) -> Result<Self, Problem> {
        let mut given = headers.get_all(CONTENT_ENCODING).iter();
        let Some(first) = given.next() else { return Ok(Self::Identity) };
        let name = first.to_str().unwrap_or_default().trim().to_ascii_lowercase();
        match name.as_str() {
            _ if given.next().is_some() => {}
            "identity" => return Ok(Self::Identity),
            "gzip" | "x-gzip" => return Ok(Self::Gzip),
            "zstd" => return Ok(Self::Zstd),
            _ => {}
        }
        let detail = "the content-encoding is not one of gzip, zstd and identity";
        Err(Problem::new(Kind::UNSUPPORTED_MEDIA_TYPE, detail))
    }

    /// Returns the memory for reading a stream of it.
    pub fn stream_bytes(self) -> usize {
        match self {
            Self::Identity => 0,
            Self::Gzip => 2 * PIECE_BYTES,
            Self::Zstd => ZSTD_STREAM_BYTES,
        }
    }

    /// Returns the length of the text without storing it; `None` if longer than `most`.
    pub fn length(self, bytes: &[u8], most: usize) -> io::Result<Option<usize>> {
        let (mut reader, mut piece, mut length) = (self.reader(bytes)?, vec![0; PIECE_BYTES], 0);
        loop {
            match reader.read(&mut piece)? {
                0 => return Ok(Some(length)),
                more => length += more,
            }
            if length > most {
                return Ok(None);
            }
        }
    }

    /// Returns the text, given its length.
    pub fn text(self, bytes: &[u8], length: usize) -> io::Result<Vec<u8>> {
        let mut text = Vec::with_capacity(length);
        self.reader(bytes)?.take(length as u64).read_to_end(&mut text)?;
        Ok(text)
    }

    fn reader<'b>(self, bytes: &'b [u8]) -> io::Result<Box<dyn Read + 'b>> {
        Ok(match self {
            Self::Identity => Box::new(bytes),
            Self::Gzip => Box::new(MultiGzDecoder::new(bytes)),
            Self::Zstd => {
                let mut decoder = zstd::stream::read::Decoder::with_buffer(bytes)?;
                decoder.window_log_max(ZSTD_WINDOW_LOG_MAX)?;
                Box::new(decoder)
            }
        })
    }

    /// Returns a body inflated as it arrives, and the number of compressed bytes received.
    pub fn stream(self, body: Body) -> (Body, Arc<AtomicUsize>) {
        let arrived = Arc::new(AtomicUsize::new(0));
        let count = arrived.clone();
        let pieces = body.into_data_stream().map_err(io::Error::other).inspect_ok(move |piece| {
            count.fetch_add(piece.len(), Ordering::Relaxed);
        });
        let reader = StreamReader::new(pieces);
        let body = match self {
            Self::Identity => Body::from_stream(reader.into_inner()),
            Self::Gzip => {
                let mut decoder = GzipDecoder::new(reader);
                decoder.multiple_members(true);
                streamed(decoder)
            }
            Self::Zstd => {
                let window = DParameter::window_log_max(ZSTD_WINDOW_LOG_MAX);
                let mut decoder = ZstdDecoder::with_params(reader, &[window]);
                decoder.multiple_members(true);
                streamed(decoder)
            }
        };
        (body, arrived)
    }
}

fn streamed(reader: impl AsyncRead + Send + 'static) -> Body {
    Body::from_stream(ReaderStream::with_capacity(reader, PIECE_BYTES))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gzip(text: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::read::GzEncoder::new(text, flate2::Compression::best());
        let mut compressed = Vec::new();
        encoder.read_to_end(&mut compressed).unwrap();
        compressed
    }

    #[test]
    fn a_text_comes_back_whole_member_after_member() {
        let two = [gzip(b"one "), gzip(b"two")].concat();
        let zstd_two =
            [zstd::encode_all(&b"one "[..], 3).unwrap(), zstd::encode_all(&b"two"[..], 3).unwrap()];
        for (encoding, bytes) in [(Encoding::Gzip, two), (Encoding::Zstd, zstd_two.concat())] {
            assert_eq!(encoding.length(&bytes, 7).unwrap(), Some(7), "{encoding:?}");
            assert_eq!(encoding.length(&bytes, 6).unwrap(), None, "{encoding:?}");
            assert_eq!(encoding.text(&bytes, 7).unwrap(), b"one two", "{encoding:?}");
        }
    }

    #[test]
    fn a_frame_that_looks_back_too_far_is_refused() {
        for (log, taken) in [(23, true), (24, false), (27, false)] {
            let mut encoder = zstd::stream::write::Encoder::new(Vec::new(), 1).unwrap();
            encoder.window_log(log).unwrap();
            std::io::Write::write_all(&mut encoder, &[0; 4096]).unwrap();
            let bytes = encoder.finish().unwrap();
            assert_eq!(Encoding::Zstd.length(&bytes, 1 << 20).is_ok(), taken, "2^{log}");
        }
    }
}
