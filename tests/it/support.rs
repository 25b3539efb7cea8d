//! A real server in this process, on a database of its own, and the few words needed to speak to it.

use std::hash::{Hash as _, Hasher as _};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use reqwest::header::{CONTENT_TYPE, HeaderMap};
use reqwest::{Method, RequestBuilder, StatusCode};
use revisit::api::verdict::LoopAnswer;
use revisit::config::limits::LimitArgs;
use revisit::config::quotas::Quotas;
#[cfg(feature = "llm")]
use revisit::engine::ModelChoice;
use revisit::engine::{Service, ServiceOptions};
use revisit::http::RunningServer;
use serde_json::{Value, json};
use sqlx::{Connection as _, PgConnection};

/// A server; it stops, and its database goes, when this value goes.
pub struct Server {
    http: reqwest::Client,
    running: RunningServer,
    _directory: Option<tempfile::TempDir>,
}

/// What a request was answered.
#[derive(Debug)]
pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub bytes: bytes::Bytes,
    /// Null where the answer is empty or no JSON.
    pub body: Value,
}

/// Returns the address of the database that belongs to a directory: a file in it or, where `REVISIT_TEST_ENGINE` is `postgres`, a
/// database of a server.
pub async fn database_in(directory: &Path) -> String {
    match std::env::var("REVISIT_TEST_ENGINE").as_deref() {
        Ok("postgres") => postgres_of(directory).await,
        _ => format!("sqlite://{}", directory.join("test.db").display()),
    }
}

/// Returns the address of a directory's database at the PostgreSQL server that `REVISIT_TEST_POSTGRES` names, such as
/// `postgres://postgres@127.0.0.1:5432`; it is made if it is not there.
pub async fn postgres_of(directory: &Path) -> String {
    let server = std::env::var("REVISIT_TEST_POSTGRES").expect("REVISIT_TEST_POSTGRES names a server");
    let mut hasher = std::hash::DefaultHasher::new();
    directory.hash(&mut hasher);
    let name = format!("test_{}_{:x}", std::process::id(), hasher.finish());
    let mut db = PgConnection::connect(&format!("{server}/postgres")).await.expect("a PostgreSQL server");
    let select = "select count(*) from pg_database where datname = $1";
    let found: i64 = sqlx::query_scalar(select).bind(&name).fetch_one(&mut db).await.expect("its databases");
    if found == 0 {
        let create = sqlx::AssertSqlSafe(format!("create database {name}"));
        sqlx::query(create).execute(&mut db).await.expect("a database");
    }
    format!("{server}/{name}")
}

/// Longer than servers that share a database take to know of each other.
const JOINED: Duration = Duration::from_secs(40);

impl Server {
    /// Starts a server on an empty database.
    pub async fn start() -> Self {
        Self::with(|_| {}).await
    }

    /// Starts a server with an empty map.
    pub async fn with_map(map: &str) -> Self {
        let server = Self::start().await;
        server.put(&format!("/v1/maps/{map}"), &json!({})).await.expect(201);
        server
    }

    /// Starts a server with a vocabulary.
    pub async fn with_vocabulary(file: PathBuf) -> Self {
        Self::with(|options| options.vocabulary = Some(file)).await
    }

    /// Starts a server that asks these models.
    #[cfg(feature = "llm")]
    pub async fn with_models(models: ModelChoice) -> Self {
        Self::with(|options| options.models = models).await
    }

    /// Starts a server whose maps may hold so much.
    pub async fn with_quotas(quotas: Quotas) -> Self {
        Self::with(|options| options.quotas = quotas).await
    }

    /// Starts a server on a directory that outlives it, whose maps in memory may take so many bytes together.
    pub async fn with_map_memory(directory: &Path, bytes: u64) -> Self {
        Self::on_with(directory, |options| options.map_memory = bytes).await
    }

    /// The same, with models.
    #[cfg(feature = "llm")]
    pub async fn with_models_and_map_memory(directory: &Path, models: ModelChoice, bytes: u64) -> Self {
        Self::on_with(directory, |options| (options.models, options.map_memory) = (models, bytes)).await
    }

    /// Starts a server on a directory that outlives it, which looks for what settings let go of as often as this.
    pub async fn with_retention_every(directory: &Path, every: Duration) -> Self {
        Self::on_with(directory, |options| options.retention_every = every).await
    }

    /// One figure of the metrics page.
    pub async fn figure(&self, name: &str) -> u64 {
        let page = Answer::text(self.request(Method::GET, "/metrics")).await;
        let row = page.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')).expect(name);
        row.parse().expect("a number")
    }

    /// Starts a server within limits, and gives its service, too.
    pub async fn within(limits: &[&str]) -> (Self, Service) {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let database = database_in(directory.path()).await;
        let service =
            Service::open(ServiceOptions::on(database, LoopAnswer::bytes)).await.expect("a service");
        let limits = LimitArgs::of(limits).expect("limits");
        let running = RunningServer::start_within(service.clone(), limits).await.expect("a free port");
        (Self { http: client(), running, _directory: Some(directory) }, service)
    }

    /// Where it listens.
    pub fn addr(&self) -> SocketAddr {
        self.running.addr()
    }

    async fn with(choose: impl FnOnce(&mut ServiceOptions)) -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let server = Self::on_with(directory.path(), choose).await;
        Self { _directory: Some(directory), ..server }
    }

    /// Starts a server on a directory that outlives it.
    pub async fn on(directory: &Path) -> Self {
        Self::on_with(directory, |_| {}).await
    }

    /// The same, with models.
    #[cfg(feature = "llm")]
    pub async fn with_models_on(directory: &Path, models: ModelChoice) -> Self {
        Self::on_with(directory, |options| options.models = models).await
    }

    /// Starts a server on a directory's database at a PostgreSQL server, which others may share.
    pub async fn among_others(directory: &Path) -> Self {
        let options = ServiceOptions::on(postgres_of(directory).await, LoopAnswer::bytes);
        Self::of(options).await
    }

    /// Starts two servers that share a database and know of each other, as they do after a renewal.
    pub async fn two(directory: &Path) -> (Self, Self) {
        let (one, two) = (Self::among_others(directory).await, Self::among_others(directory).await);
        let begun = Instant::now();
        while one.figure("revisit_nodes").await < 2 || two.figure("revisit_nodes").await < 2 {
            assert!(begun.elapsed() < JOINED, "the two servers do not know of each other");
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        (one, two)
    }

    async fn on_with(directory: &Path, choose: impl FnOnce(&mut ServiceOptions)) -> Self {
        let database = database_in(directory).await;
        let mut options = ServiceOptions::on(database, LoopAnswer::bytes);
        choose(&mut options);
        Self::of(options).await
    }

    async fn of(options: ServiceOptions) -> Self {
        let service = Service::open(options).await.expect("a service");
        let running = RunningServer::start(service).await.expect("a free port");
        Self { http: client(), running, _directory: None }
    }

    /// What SIGTERM does, without waiting for what follows.
    pub fn tell_to_stop(&self) {
        self.running.tell_to_stop();
    }

    /// Stops it, and waits until everything is on disk.
    pub async fn stop(self) {
        self.running.stop().await.expect("it stops");
    }

    /// A request to be completed by hand.
    pub fn request(&self, method: Method, path: &str) -> RequestBuilder {
        self.http.request(method, self.url(path))
    }

    /// The address of a path, for clients of another kind.
    pub fn url(&self, path: &str) -> String {
        format!("{}{path}", self.running.url())
    }

    pub async fn get(&self, path: &str) -> Answer {
        Answer::of(self.request(Method::GET, path)).await
    }

    pub async fn put(&self, path: &str, body: &Value) -> Answer {
        Answer::of(self.request(Method::PUT, path).json(body)).await
    }

    /// Stores the smallest keyframe.
    pub async fn put_keyframe(&self, path: &str) -> Answer {
        self.put(path, &keyframe()).await
    }

    pub async fn post(&self, path: &str, body: &Value) -> Answer {
        Answer::of(self.request(Method::POST, path).json(body)).await
    }

    pub async fn patch(&self, path: &str, body: &Value) -> Answer {
        Answer::of(self.request(Method::PATCH, path).json(body)).await
    }

    pub async fn delete(&self, path: &str) -> Answer {
        Answer::of(self.request(Method::DELETE, path)).await
    }

    /// The first event of a stream that is meant; waits for it.
    pub async fn event(&self, path: &str, is_meant: impl Fn(&Value) -> bool) -> Value {
        let mut stream = self.request(Method::GET, path).send().await.expect("an answer");
        let mut text = String::new();
        loop {
            let whole = text.rsplit_once("\n\n").map_or("", |(whole, _)| whole);
            let data = whole.lines().filter_map(|line| line.strip_prefix("data: "));
            let mut events = data.map(|data| serde_json::from_str::<Value>(data).expect("JSON"));
            if let Some(event) = events.find(|event| is_meant(event)) {
                return event;
            }
            text += &String::from_utf8_lossy(&stream.chunk().await.expect("a stream").expect("more events"));
        }
    }

    /// A body sent byte by byte as it is.
    pub async fn send(
        &self,
        method: Method,
        path: &str,
        media_type: &str,
        body: impl Into<reqwest::Body>,
    ) -> Answer {
        Answer::of(self.request(method, path).header(CONTENT_TYPE, media_type).body(body)).await
    }
}

impl Answer {
    /// Sends a request and reads its answer.
    pub async fn of(request: RequestBuilder) -> Self {
        let response = request.send().await.expect("an answer");
        let (status, headers) = (response.status(), response.headers().clone());
        let bytes = response.bytes().await.expect("a whole answer");
        Self { status, headers, body: serde_json::from_slice(&bytes).unwrap_or_default(), bytes }
    }

    /// The answer's body as text, whatever the status.
    pub async fn text(request: RequestBuilder) -> String {
        request.send().await.expect("an answer").text().await.expect("a whole answer")
    }

    /// The answer's body, if the status is the expected one.
    #[track_caller]
    pub fn expect(self, status: u16) -> Value {
        assert_eq!(self.status.as_u16(), status, "{self:#?}");
        self.body
    }

    /// A header as text; empty where there is none.
    pub fn header(&self, name: &str) -> &str {
        self.headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
    }

    /// The pointers of a problem's faults.
    pub fn pointers(&self) -> Vec<&str> {
        let errors = self.body["errors"].as_array().map(Vec::as_slice).unwrap_or_default();
        errors.iter().filter_map(|error| error["pointer"].as_str()).collect()
    }
}

/// Asserts that what is told is a part of the answer, which may have further members; `fits` compares the lengths of
/// lists.
pub fn assert_part_of(part: &Value, answer: &Value, fits: fn(&usize, &usize) -> bool, at: &str) {
    match (part, answer) {
        (Value::Object(part), Value::Object(answer)) => {
            for (name, value) in part {
                let same = answer.get(name).unwrap_or(&Value::Null);
                assert_part_of(value, same, fits, &format!("{at}/{name}"));
            }
        }
        (Value::Array(part), Value::Array(answer)) => {
            assert!(fits(&part.len(), &answer.len()), "{at}: {} of {}", part.len(), answer.len());
            for (number, (part, answer)) in part.iter().zip(answer).enumerate() {
                assert_part_of(part, answer, fits, &format!("{at}/{number}"));
            }
        }
        _ => assert_eq!(part, answer, "{at}"),
    }
}

fn client() -> reqwest::Client {
    revisit::config::tls::install();
    reqwest::Client::builder().no_proxy().build().expect("a client")
}

/// Runs a shell's curl against the server in place of the address that is shown.
pub async fn curl(server: &Server, text: &str) -> Value {
    let command = text.replace("http://127.0.0.1:7878", &server.url("")).replace("curl ", "curl -s ");
    let run = move || std::process::Command::new("sh").arg("-c").arg(command).output();
    let output = tokio::task::spawn_blocking(run).await.unwrap().unwrap();
    let answer = serde_json::from_slice(&output.stdout);
    answer.unwrap_or_else(|_| panic!("{text}\n{}", String::from_utf8_lossy(&output.stdout)))
}

/// The smallest keyframe: at the origin, looking along z.
pub fn keyframe() -> Value {
    json!({"stamp": {"sec": 1, "nanosec": 0}, "pose": pose([0.0, 0.0, 0.0]), "covisible": []})
}

/// A pose at a place, without rotation.
pub fn pose([x, y, z]: [f64; 3]) -> Value {
    json!({"translation": {"x": x, "y": y, "z": z}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}})
}
