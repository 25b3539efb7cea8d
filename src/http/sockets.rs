//! Sockets: the options of connections, and how a listening socket is closed without a reset.

use std::io;
use std::time::Duration;

use socket2::SockRef;
use tokio::net::{TcpListener, TcpStream};

/// Sets the options of a connection that was accepted.
pub fn prepare(stream: &TcpStream, vanished_after: Duration) -> io::Result<()> {
    // Answers are small and waited for: none is held back to be sent with the next.
    stream.set_nodelay(true)?;
    // Without it the kernel sends to a client that has vanished for a quarter of an hour.
    #[cfg(target_os = "linux")]
    SockRef::from(stream).set_tcp_user_timeout(Some(vanished_after))?;
    Ok(())
}

/// Closes a listener, and returns the connections that clients had opened already: closing resets what it holds.
pub fn close(listener: TcpListener) -> io::Result<Vec<TcpStream>> {
    let listener = listener.into_std()?;
    // A connection that opens between the last accept and the close would be reset. So the kernel drops the packets that
    // open one: their sender tries again after a second, and is refused.
    if let Err(error) = drop_packets(SockRef::from(&listener)) {
        tracing::debug!(%error, "new connections are not held back");
    }
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
                tracing::warn!(%error, "connections that were opened are not served");
                return Ok(opened);
            }
        }
    }
}

/// Has a listening socket receive nothing any more.
#[cfg(target_os = "linux")]
fn drop_packets(listener: SockRef<'_>) -> io::Result<()> {
    /// `BPF_RET | BPF_K`: returns a constant, which is how many bytes of a packet are let through.
    const RETURN: u16 = 0x06;
    listener.attach_filter(&[socket2::SockFilter::new(RETURN, 0, 0, 0)])
}

#[cfg(not(target_os = "linux"))]
fn drop_packets(_: SockRef<'_>) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Whether an accept failed because its client had gone.
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
}
