//! Server: the real binary on a database that outlives it.

use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use reqwest::{Method, RequestBuilder};
use serde_json::Value;

/// How a server says where it is, on the first line of standard output.
const ANNOUNCEMENT: &str = "listening on ";

pub struct Server {
    child: Child,
    api: Api,
    /// Held open: a server whose standard output is closed is another test.
    _stdout: BufReader<ChildStdout>,
}

/// How to ask a server, alive or not.
#[derive(Clone)]
pub struct Api {
    url: String,
    http: reqwest::Client,
}

/// What a request was answered.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    /// The answer says that the same was written before.
    pub replayed: bool,
    pub body: Vec<u8>,
}

impl Server {
    /// Starts the server and waits until it says that it listens.
    pub fn start(database: &Path) -> Self {
        Self::start_with(database, &[])
    }

    /// The same with more flags.
    pub fn start_with(database: &Path, more: &[&str]) -> Self {
        Self::start_on_path(database, more, None)
    }

    /// The same, finding its programs here.
    pub fn start_on_path(database: &Path, more: &[&str], path: Option<&str>) -> Self {
        let log = log_beside(database);
        let mut command = Command::new(env!("CARGO_BIN_EXE_revisit"));
        for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("REVISIT_")) {
            command.env_remove(name);
        }
        if let Some(path) = path {
            command.env("PATH", path);
        }
        let mut child = command
            .args(["serve", "--database"])
            .arg(format!("sqlite://{}", database.display()))
            .args(if more.contains(&"--listen") { &[][..] } else { &["--listen", "127.0.0.1:0"] })
            .args(more)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(File::create(&log).expect("a log file"))
            .spawn()
            .expect("the binary runs");
        let mut stdout = BufReader::new(child.stdout.take().expect("piped above"));
        let mut line = String::new();
        stdout.read_line(&mut line).expect("standard output is text");
        let Some(url) = line.trim_end().strip_prefix(ANNOUNCEMENT) else {
            let _ = child.kill();
            let log = std::fs::read_to_string(&log).unwrap_or_default();
            panic!("the server said {line:?} instead of its address\n{log}");
        };
        revisit::config::tls::install();
        let http = reqwest::Client::builder().no_proxy().build();
        Self { api: Api { url: url.to_owned(), http: http.expect("a client") }, child, _stdout: stdout }
    }

    pub fn api(&self) -> &Api {
        &self.api
    }

    /// SIGTERM, and how it ended.
    pub fn terminate(&mut self) -> std::process::ExitStatus {
        let sent = Command::new("kill").args(["-TERM", &self.child.id().to_string()]).status();
        assert!(sent.expect("kill runs").success());
        self.child.wait().expect("a child of ours")
    }

    /// SIGKILL, and the corpse is collected; a server that is dead already died of itself.
    pub fn kill(&mut self) {
        let ended = self.child.try_wait().expect("a child of ours");
        assert!(ended.is_none(), "the server ended before it was killed: {ended:?}");
        self.child.kill().expect("a child of ours");
        self.child.wait().expect("a child of ours");
    }
}

impl Api {
    /// Where the server listens.
    pub fn addr(&self) -> std::net::SocketAddr {
        self.url.trim_start_matches("http://").parse().expect("an address")
    }

    pub fn request(&self, method: Method, path: &str) -> RequestBuilder {
        self.http.request(method, format!("{}{path}", self.url))
    }

    pub async fn get(&self, path: &str) -> Answer {
        Answer::to(self.request(Method::GET, path)).await
    }

    pub async fn put(&self, path: &str, body: &Value) -> Answer {
        Answer::to(self.request(Method::PUT, path).json(body)).await
    }

    pub async fn post(&self, path: &str, body: &Value) -> Answer {
        Answer::to(self.request(Method::POST, path).json(body)).await
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Fails if it is dead already, which is what is wanted.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Answer {
    /// The answer of a server that is expected to be alive.
    async fn to(request: RequestBuilder) -> Self {
        let answer = Self::unless_gone(request).await;
        answer.unwrap_or_else(|error| panic!("no answer: {error:?}"))
    }

    /// The answer, unless the server is gone.
    pub async fn unless_gone(request: RequestBuilder) -> Result<Self, reqwest::Error> {
        let response = request.send().await?;
        Ok(Self {
            status: response.status().as_u16(),
            replayed: response.headers().contains_key("idempotent-replayed"),
            body: response.bytes().await?.to_vec(),
        })
    }

    pub fn is_success(&self) -> bool {
        (200..300).contains(&self.status)
    }

    /// The server has no time now; nothing was written.
    pub fn is_busy(&self) -> bool {
        matches!(self.status, 429 | 503)
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error} in {}", self.text()))
    }
}

fn log_beside(database: &Path) -> PathBuf {
    database.with_extension("log")
}
