//! Sockets: options of connections, and closing a listener without resets.

use std::io;
use std::time::Duration;

use socket2::SockRef;
use tokio::net::{TcpListener, TcpStream};

/// Sets the options of an accepted connection.
pub fn prepare(stream: &TcpStream, vanished_after: Duration) -> io::Result<()> {
    // Responses are small and awaited, so Nagle's algorithm would only delay them.
    stream.set_nodelay(true)?;
    // Without it, the kernel retransmits to a vanished client for about 15 minutes.
    #[cfg(target_os = "linux")]
    SockRef::from(stream).set_tcp_user_timeout(Some(vanished_after))?;
    Ok(())
}

/// Ignores new connections where the kernel can (Linux). Their clients retry after a second, and are refused once the
/// listener is closed.
///
/// Connections being opened are still completed: their clients may consider them open and have sent a request.
pub fn open_no_more(listener: &TcpListener) {
    if let Err(error) = drop_opening_packets(SockRef::from(listener)) {
        tracing::debug!(%error, "new connections are still opened");
    }
}

/// Closes a listener and returns the connections that clients had already opened, because closing would reset them.
pub fn close(listener: TcpListener) -> io::Result<Vec<TcpStream>> {
    let listener = listener.into_std()?;
    let mut opened = Vec::new();
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(true)?;
                opened.push(TcpStream::from_std(stream)?);
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(opened),
            Err(error) if is_the_clients(&error) || error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => {
                tracing::warn!(%error, "opened connections are not served");
                return Ok(opened);
            }
        }
    }
}

/// Makes a listening socket drop packets with SYN and without ACK, the first of a connection.
///
/// Socket filters are classic BPF programs. A packet begins with the TCP header here, whose byte 13 has the flags (RFC
/// 9293, section 3.1).
#[cfg(target_os = "linux")]
fn drop_opening_packets(listener: SockRef<'_>) -> io::Result<()> {
    use socket2::SockFilter;
    /// `BPF_LD | BPF_B | BPF_ABS`: loads the byte at k.
    const LOAD: u16 = 0x30;
    /// `BPF_ALU | BPF_AND | BPF_K`: keeps the bits of k.
    const AND: u16 = 0x54;
    /// `BPF_JMP | BPF_JEQ | BPF_K`: skips the first count of instructions if equal to k, else the second.
    const JUMP_IF_EQUAL: u16 = 0x15;
    /// `BPF_RET | BPF_K`: returns k, the number of bytes of the packet to pass.
    const RETURN: u16 = 0x06;
    const FLAGS: u32 = 13;
    const SYN: u32 = 0x02;
    const ACK: u32 = 0x10;
    listener.attach_filter(&[
        SockFilter::new(LOAD, 0, 0, FLAGS),
        SockFilter::new(AND, 0, 0, SYN | ACK),
        SockFilter::new(JUMP_IF_EQUAL, 0, 1, SYN),
        SockFilter::new(RETURN, 0, 0, 0),
        SockFilter::new(RETURN, 0, 0, u32::MAX),
    ])
}

#[cfg(not(target_os = "linux"))]
fn drop_opening_packets(_: SockRef<'_>) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Whether an accept failed because its client had closed.
pub fn is_the_clients(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
    matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_connection_is_given_up_when_its_client_has_vanished() {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let _client = TcpStream::connect(listener.local_addr().unwrap()).await.unwrap();
        let (stream, _) = listener.accept().await.unwrap();
        prepare(&stream, Duration::from_secs(30)).unwrap();
        assert_eq!(SockRef::from(&stream).tcp_user_timeout().unwrap(), Some(Duration::from_secs(30)));
        assert!(stream.nodelay().unwrap());
    }

    #[tokio::test]
    async fn closing_a_listener_hands_over_every_connection_that_was_open() {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let addr = listener.local_addr().unwrap();
        let mut clients = Vec::new();
        for _ in 0..5 {
            clients.push(TcpStream::connect(addr).await.unwrap());
        }
        assert_eq!(close(listener).unwrap().len(), 5);
        assert_eq!(TcpStream::connect(addr).await.unwrap_err().kind(), io::ErrorKind::ConnectionRefused);
    }

    #[tokio::test]
    async fn a_listener_that_opens_no_more_serves_those_that_are_open_and_refuses_the_rest_when_it_closes() {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let addr = listener.local_addr().unwrap();
        let open = TcpStream::connect(addr).await.unwrap();
        open_no_more(&listener);
        let later = tokio::time::timeout(Duration::from_millis(50), TcpStream::connect(addr)).await;
        assert!(later.is_err(), "its first packet is dropped");
        let (taken, _) = listener.accept().await.unwrap();
        open.try_write(b"a request").unwrap();
        taken.readable().await.unwrap();
        assert_eq!(taken.try_read(&mut [0; 16]).unwrap(), 9);
        assert!(close(listener).unwrap().is_empty());
        assert_eq!(TcpStream::connect(addr).await.unwrap_err().kind(), io::ErrorKind::ConnectionRefused);
    }
}
