//! `revisit keys`: creates, lists and revokes API keys in a database, with or without a running server.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use clap::{Args, Subcommand};

use super::failure::Failure;
use super::output::write_out;
use crate::domain::counted::counted;
use crate::domain::key::{Action, Key, KeyProperties, MapPattern};
use crate::domain::keyframe::Stamp;
use crate::engine::ServiceError;
use crate::engine::keys::keyring::Keyring;
use crate::engine::keys::lockout::{Lockout, WAY_BACK};
use crate::store::files::paths::DatabaseFiles;
use crate::store::{Store, is_server_url};

/// Create, list and revoke API keys.
///
/// Keys are stored in the database; a running server applies changes within a second. Once a database has had a key,
/// every API request needs one. This command creates and revokes any key. Over HTTP, the first key must be an
/// administrator's, and the last such key is kept.
#[derive(Args, Debug)]
pub struct KeysArgs {
    #[command(subcommand)]
    command: Command,
    /// The database; `create` creates it if it does not exist
    #[arg(
        long,
        env = "REVISIT_DATABASE",
        value_name = "URL",
        default_value = "sqlite://revisit.db",
        global = true
    )]
    database: String,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Create a key and print its secret, once, as the only line on standard output
    Create(CreateArgs),
    /// List the keys, including revoked ones
    List,
    /// Revoke a key
    Revoke {
        /// The key's id, such as key-7
        id: String,
    },
}

#[derive(Args, Debug)]
struct CreateArgs {
    /// The key's owner, for people
    #[arg(long, default_value = "")]
    name: String,
    /// Its actions: read, write, query (loop queries, similarity of texts), admin (keys, backups); comma-separated
    #[arg(long, value_delimiter = ',', default_value = "read,write,query", value_parser = action)]
    actions: Vec<Action>,
    /// The maps that it covers, comma-separated; * matches any characters
    #[arg(long, value_delimiter = ',', default_value = "*")]
    maps: Vec<MapPattern>,
    /// Days until it expires
    #[arg(long, value_name = "DAYS", value_parser = clap::value_parser!(u32).range(1..=36_500))]
    expires_in_days: Option<u32>,
    /// Maximum requests per second
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    rate_per_s: Option<u32>,
    /// Maximum maps that it made and that exist
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    max_maps: Option<u32>,
    /// Maximum bytes of these maps with their releases
    #[arg(long, value_name = "BYTES", value_parser = clap::value_parser!(u64).range(0..=1 << 53))]
    max_bytes: Option<u64>,
    /// Maximum model calls per day
    #[arg(long, value_name = "N")]
    model_daily_calls: Option<u32>,
    /// Maximum cost of model calls per day, in US dollars
    #[arg(long, value_name = "USD", value_parser = dollars)]
    model_daily_usd: Option<f64>,
}

fn action(name: &str) -> Result<Action, String> {
    Action::from_name(name).ok_or_else(|| format!("expected one of {}", Action::NAMES.join(", ")))
}

fn dollars(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(usd) if (0.0..=1e6).contains(&usd) => Ok(usd),
        _ => Err("expected a number from 0 to 1000000".to_owned()),
    }
}

/// Runs `keys`.
pub async fn run(args: KeysArgs) -> Result<(), Failure> {
    let creates = matches!(args.command, Command::Create(_));
    if !is_server_url(&args.database) {
        let files = DatabaseFiles::of_url(&args.database)?;
        if !creates && !files.exist() {
            return Err(format!("there is no database {}", files.database().display()).into());
        }
    }
    let store = Store::open_beside(&args.database).await?;
    let keys = Keyring::open(store.clone(), false).await?;
    let done = perform(args.command, &keys).await;
    store.close().await;
    done
}

async fn perform(command: Command, keys: &Keyring) -> Result<(), Failure> {
    match command {
        Command::Create(args) => {
            let made = keys.create(args.properties()?, Lockout::Meant).await.map_err(in_words)?;
            eprintln!("{}", line(&made.key));
            if made.is_first {
                eprintln!("This is the database's first key: from now on every request needs a key.");
            }
            note_missing_administrator(keys);
            eprintln!(
                "Its secret follows and is shown only once; send it as `authorization: Bearer SECRET`."
            );
            write_out(&format!("{}\n", made.secret))?;
        }
        Command::List => {
            let keys = keys.list();
            if keys.is_empty() {
                eprintln!("no keys");
            }
            for key in &keys {
                write_out(&format!("{}\n", line(key)))?;
            }
        }
        Command::Revoke { id } => {
            eprintln!("{}", line(&keys.revoke(&id, Lockout::Meant).await?));
            note_missing_administrator(keys);
        }
    }
    Ok(())
}

/// Notes that keys and backups cannot be managed over HTTP. This may be intended.
fn note_missing_administrator(keys: &Keyring) {
    if !keys.has_administrator() {
        eprintln!("No administrator key (to create keys and backups over HTTP): {WAY_BACK}.");
    }
}

impl CreateArgs {
    fn properties(self) -> Result<KeyProperties, Failure> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH)?;
        let after = |days: u32| (now + Duration::from_hours(24) * days).as_secs() as i64;
        let expires = self.expires_in_days.map(|days| Stamp { sec: after(days), nanosec: 0 });
        if self.name.chars().count() > 128 || self.name.chars().any(char::is_control) {
            return Err("--name: at most 128 printable characters".into());
        }
        Ok(KeyProperties {
            name: self.name,
            actions: self.actions.into_iter().collect(),
            maps: self.maps,
            expires,
            rate_per_s: self.rate_per_s,
            max_maps: self.max_maps,
            max_bytes: self.max_bytes,
            model_daily_calls: self.model_daily_calls,
            model_daily_microusd: self.model_daily_usd.map(|usd| (usd * 1e6).round() as u64),
        })
    }
}

/// Formats a key on one line.
fn line(key: &Key) -> String {
    let KeyProperties {
        name,
        actions,
        maps,
        expires,
        rate_per_s,
        max_maps,
        max_bytes,
        model_daily_calls,
        model_daily_microusd,
    } = &key.properties;
    let maps: Vec<String> = maps.iter().map(ToString::to_string).collect();
    let mut line = format!("{}  {name:?}  may {actions}  maps {}", key.seq.public(), maps.join(" "));
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs() as i64;
    let mut say = |text: String| line.extend(["  ", &text]);
    match (key.revoked_sec, expires) {
        (Some(_), _) => say("REVOKED".to_owned()),
        (None, Some(expires)) if expires.sec <= now => say("EXPIRED".to_owned()),
        (None, Some(expires)) => say(format!("good for {}", days(expires.sec - now))),
        (None, None) => {}
    }
    let limits = [
        rate_per_s.map(|rate| format!("{} a second", counted(rate, "request"))),
        max_maps.map(|most| format!("at most {}", counted(most, "map"))),
        max_bytes.map(|most| format!("at most {}", counted(most, "byte"))),
        model_daily_calls.map(|calls| format!("{} a day", counted(calls, "model call"))),
        model_daily_microusd.map(|microusd| format!("{} USD for models per day", microusd as f64 / 1e6)),
    ];
    limits.into_iter().flatten().for_each(say);
    line
}

fn days(seconds: i64) -> String {
    format!("{} and {}", counted(seconds / 86_400, "day"), counted(seconds % 86_400 / 3_600, "hour"))
}

/// Returns the error as text, which a client of the API would read from the fields of the problem.
fn in_words(error: ServiceError) -> Failure {
    match error {
        ServiceError::Invalid(errors) => {
            let told: Vec<String> = errors.into_iter().map(|error| error.detail).collect();
            told.join("; ").into()
        }
        other => other.into(),
    }
}
