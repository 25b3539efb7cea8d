//! Health: asks `/healthz` all the while, as a supervisor would, from a thread of its own.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often.
const EVERY: Duration = Duration::from_millis(25);

/// A supervisor, until it is asked what it saw.
pub struct Health {
    stop: Arc<AtomicBool>,
    asks: JoinHandle<Vec<f64>>,
}

impl Health {
    pub fn watch(addr: SocketAddr) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let told = stop.clone();
        let asks = std::thread::spawn(move || {
            let mut stream = connect(addr);
            let mut took_ms = Vec::new();
            while !told.load(Ordering::Relaxed) {
                let started = Instant::now();
                if ask(&mut stream).is_none() {
                    // An evicted connection is opened again, and that counts, too.
                    stream = connect(addr);
                    ask(&mut stream).expect("/healthz answers 200 under any load");
                }
                took_ms.push(started.elapsed().as_secs_f64() * 1e3);
                std::thread::sleep(EVERY);
            }
            took_ms
        });
        Self { stop, asks }
    }

    /// What each question took, in milliseconds.
    pub fn took_ms(self) -> Vec<f64> {
        self.stop.store(true, Ordering::Relaxed);
        self.asks.join().expect("the supervisor's thread")
    }
}

fn connect(addr: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(addr).expect("a connection for /healthz");
    stream.set_nodelay(true).expect("a socket");
    stream
}

fn ask(stream: &mut TcpStream) -> Option<()> {
    stream.write_all(b"GET /healthz HTTP/1.1\r\nhost: x\r\n\r\n").ok()?;
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
