//! Wire: one connection that says HTTP/1.1 with as little work as possible; server and generator share the cores.

use std::io::{self, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};

/// Answers are read in pieces of this size.
const PIECE_BYTES: usize = 16 << 10;

/// A connection; it is opened anew when the server has closed it.
pub struct Connection {
    addr: SocketAddr,
    stream: Option<TcpStream>,
    buffer: Vec<u8>,
}

impl Connection {
    pub fn to(addr: SocketAddr) -> Self {
        Self { addr, stream: None, buffer: vec![0; PIECE_BYTES] }
    }

    /// Sends a request as it is, and tells its answer's status.
    pub fn ask(&mut self, request: &[u8]) -> io::Result<u16> {
        let mut stream = if let Some(stream) = self.stream.take() {
            stream
        } else {
            let stream = TcpStream::connect(self.addr)?;
            stream.set_nodelay(true)?;
            stream
        };
        stream.write_all(request)?;
        let (mut got, mut head) = (0, None);
        while head.is_none() {
            got += more(&mut stream, &mut self.buffer[got..])?;
            head = self.buffer[..got].windows(4).position(|four| four == b"\r\n\r\n").map(|end| end + 4);
        }
        let head = head.unwrap_or(got);
        let text = std::str::from_utf8(&self.buffer[..head]).map_err(io::Error::other)?;
        let status =
            text.get(9..12).and_then(|digits| digits.parse().ok()).ok_or(io::ErrorKind::InvalidData)?;
        let length =
            text.split_once("content-length: ").and_then(|(_, rest)| rest.split("\r\n").next()?.parse().ok());
        let closes = text.contains("connection: close");
        let mut left = length.unwrap_or(0_usize).saturating_sub(got - head);
        while left > 0 {
            left = left.saturating_sub(more(&mut stream, &mut self.buffer)?);
        }
        self.stream = (!closes).then_some(stream);
        Ok(status)
    }
}

fn more(stream: &mut TcpStream, buffer: &mut [u8]) -> io::Result<usize> {
    match stream.read(buffer)? {
        0 => Err(io::ErrorKind::UnexpectedEof.into()),
        more => Ok(more),
    }
}
