//! Health: asks `/healthz` all the while, as a supervisor would, from a thread of its own.
//!
//! A busy machine lets everybody wait. So the same thread also asks an echo, which does nothing but answer: what that
//! takes is the machine's doing, not the server's.

use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often.
const EVERY: Duration = Duration::from_millis(10);

/// A supervisor, until it is asked what it saw.
pub struct Health {
    stop: Arc<AtomicBool>,
    asks: JoinHandle<Took>,
}

/// What each question took, in milliseconds.
#[derive(Default)]
pub struct Took {
    pub health_ms: Vec<f64>,
    pub echo_ms: Vec<f64>,
}

impl Health {
    pub fn watch(addr: SocketAddr) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let told = stop.clone();
        let asks = std::thread::spawn(move || {
            let (mut stream, mut echo) = (connect(addr), connect(echo()));
            let mut took = Took::default();
            while !told.load(Ordering::Relaxed) {
                let started = Instant::now();
                if ask(&mut stream).is_none() {
                    // An evicted connection is opened again, and that counts, too.
                    stream = connect(addr);
                    ask(&mut stream).expect("/healthz answers 200 under any load");
                }
                took.health_ms.push(started.elapsed().as_secs_f64() * 1e3);
                std::thread::sleep(EVERY);
                let started = Instant::now();
                let mut byte = [0];
                echo.write_all(&byte).and_then(|()| echo.read_exact(&mut byte)).expect("an echo");
                took.echo_ms.push(started.elapsed().as_secs_f64() * 1e3);
                std::thread::sleep(EVERY);
            }
            took
        });
        Self { stop, asks }
    }

    /// What it saw.
    pub fn took(self) -> Took {
        self.stop.store(true, Ordering::Relaxed);
        self.asks.join().expect("the supervisor's thread")
    }
}

/// A thread that sends back each byte, until its one connection closes.
fn echo() -> SocketAddr {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let addr = listener.local_addr().expect("an address");
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        let mut byte = [0];
        while stream.read_exact(&mut byte).and_then(|()| stream.write_all(&byte)).is_ok() {}
    });
    addr
}

fn connect(addr: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(addr).expect("a connection for /healthz");
    stream.set_nodelay(true).expect("a socket");
    stream
}

fn ask(stream: &mut TcpStream) -> Option<()> {
    stream.write_all(b"GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n").ok()?;
    let (mut buffer, mut got) = ([0; 4096], 0);
    loop {
        match stream.read(&mut buffer[got..]).ok()? {
            0 => return None,
            more => got += more,
        }
        let text = std::str::from_utf8(&buffer[..got]).ok()?;
        if let Some((head, body)) = text.split_once("\r\n\r\n")
            && body.ends_with('}')
        {
            return head.starts_with("HTTP/1.1 200").then_some(());
        }
    }
}
