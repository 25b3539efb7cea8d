//! Keys that are made, and revoked.

use base64::Engine as _;
use base64::prelude::BASE64_URL_SAFE_NO_PAD;
use rand::TryRng as _;
use rand::rngs::SysRng;

use super::keyring::{Keyring, now};
use super::lockout::{Lockout, WAY_BACK, check_first_key, check_revocation};
use crate::domain::invalid::FieldError;
use crate::domain::key::{Action, Key, KeyProperties, KeySeq, MadeKey, MapPattern, secret_hash};
use crate::engine::error::refuse;
use crate::engine::{Result, ServiceError};
use crate::store::{Job, NewKeyRow};

/// The most keys of one database, revoked ones among them.
const KEYS_MAX: usize = 10_000;

/// Maximum tries to make a key whose number another server took.
const CREATED_AGAIN_MAX: u32 = 8;

/// Prefix of secrets, by which scanners for leaked secrets can tell them.
const SECRET_PREFIX: &str = "revisit_";

impl Keyring {
    /// Makes a key.
    pub async fn create(&self, properties: KeyProperties, lockout: Lockout) -> Result<MadeKey> {
        check(&properties)?;
        let _changing = self.changing.lock().await;
        let mut tries = 0;
        loop {
            tries += 1;
            self.reload().await?;
            let keys = self.list();
            let is_first = keys.is_empty();
            if is_first && lockout == Lockout::Refused {
                check_first_key(&properties)?;
            }
            check_reach(&properties)?;
            if keys.len() >= KEYS_MAX {
                let detail = format!("a database has at most {KEYS_MAX} keys, revoked ones among them");
                return Err(ServiceError::Conflict { code: "too_many_keys", detail });
            }
            let seq = KeySeq(keys.last().map_or(0, |last| last.seq.0) + 1);
            let secret = new_secret()?;
            let properties = properties.clone();
            let key = Key { seq, properties, created_sec: now().sec, revoked_sec: None };
            let row = NewKeyRow { key: key.clone(), hash: secret_hash(&secret) };
            let created = self.store.committer().commit(Job::CreateKey(Box::new(row))).await;
            if let Err(error) = created {
                // Another server may have made one of this number meanwhile.
                if tries < CREATED_AGAIN_MAX {
                    self.reload().await?;
                    if self.held(seq).is_some() {
                        continue;
                    }
                }
                return Err(error.into());
            }
            self.reload().await?;
            tracing::info!(key = %seq.public(), name = ?key.properties.name, may = %key.properties.actions, "a key was made");
            return Ok(MadeKey { key, secret, is_first });
        }
    }

    /// Revokes a key; revoking it again changes nothing.
    pub async fn revoke(&self, id: &str, lockout: Lockout) -> Result<Key> {
        let none = || ServiceError::NotFound(format!("there is no key {id}"));
        let seq = KeySeq::from_public(id).ok_or_else(none)?;
        let find = || self.list().into_iter().find(|key| key.seq == seq);
        // Two requests that each revoke one of the last two keys must not both see the other.
        let _changing = self.changing.lock().await;
        self.reload().await?;
        let found = find().ok_or_else(none)?;
        if found.revoked_sec.is_some() {
            return Ok(found);
        }
        if lockout == Lockout::Refused {
            check_revocation(&self.list(), seq, now())?;
        }
        self.store.committer().commit(Job::RevokeKey(seq, now().sec)).await?;
        self.reload().await?;
        tracing::info!(key = %seq.public(), "a key was revoked");
        if found.properties.actions.has(Action::Admin) && !self.has_administrator() {
            tracing::warn!("no key may administer any more: {WAY_BACK}");
        }
        find().ok_or_else(none)
    }
}

/// Rejects properties that no key can have.
fn check(properties: &KeyProperties) -> Result<()> {
    let mut errors = Vec::new();
    if properties.actions.iter().next().is_none() {
        errors.push(FieldError::new("/actions", "a key must be good for something"));
    }
    if properties.maps.is_empty() {
        errors.push(FieldError::new("/maps", "no map would exist for this key; leave it out for every map"));
    }
    if properties.expires.is_some_and(|expires| expires <= now()) {
        errors.push(FieldError::new("/expires", "the key would have expired already"));
    }
    refuse(errors)
}

/// Rejects an administrator's key that does not reach every map: it could make itself one that does.
fn check_reach(properties: &KeyProperties) -> Result<()> {
    if properties.maps.contains(&MapPattern::every()) || !properties.actions.has(Action::Admin) {
        return Ok(());
    }
    let detail = "an admin key makes keys for any map, so it cannot be kept from some";
    Err(FieldError::new("/maps", detail).limit("[\"*\"]").into())
}

fn new_secret() -> Result<String> {
    let mut bytes = [0; 32];
    let drawn = SysRng.try_fill_bytes(&mut bytes);
    drawn.map_err(|error| ServiceError::Internal(format!("no random numbers: {error}")))?;
    Ok(format!("{SECRET_PREFIX}{}", BASE64_URL_SAFE_NO_PAD.encode(bytes)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::Ordering;

    use super::*;
    use crate::domain::key::Actions;
    use crate::engine::keys::access::HeldKey;
    use crate::store::Store;
    use crate::test_database::postgres_in;

    #[tokio::test(flavor = "multi_thread")]
    #[ignore = "needs REVISIT_TEST_POSTGRES"]
    async fn servers_that_share_a_database_number_keys_once_and_share_their_rates() {
        let folder = tempfile::tempdir().unwrap();
        let database = postgres_in(folder.path()).await;
        let mut keyrings = Vec::new();
        for _ in 0..2 {
            let store = Store::open(&database).await.unwrap();
            keyrings.push(Keyring::open(store, true).await.unwrap());
        }
        let properties = KeyProperties {
            name: "robots".to_owned(),
            actions: Actions::from_iter([Action::Read]),
            maps: vec!["*".parse().unwrap()],
            expires: None,
            rate_per_s: Some(20),
            max_maps: None,
            max_bytes: None,
            model_daily_calls: None,
            model_daily_microusd: None,
        };
        let making = (0..12).map(|number| {
            let (keyring, properties) = (keyrings[number % 2].clone(), properties.clone());
            tokio::spawn(async move { keyring.create(properties, Lockout::Meant).await })
        });
        let mut made = Vec::new();
        for made_by in making.collect::<Vec<_>>() {
            made.push(made_by.await.unwrap().unwrap());
        }
        let mut numbers: Vec<KeySeq> = made.iter().map(|made| made.key.seq).collect();
        numbers.sort();
        assert_eq!(numbers, (1..=12).map(KeySeq).collect::<Vec<_>>());

        let held: Vec<Arc<HeldKey>> =
            keyrings.iter().map(|keyring| keyring.table().by_seq[&KeySeq(1)].clone()).collect();
        for of_server in &held {
            let admitted = (0..30).filter(|_| of_server.count(0).is_ok()).count();
            assert!(admitted >= 20, "alone, each admits the rate, not {admitted}");
        }
        for keyring in [&keyrings[0], &keyrings[1], &keyrings[0]] {
            keyring.share_rates().await;
        }
        // The second one knows of the first one's 20, and the first one of the second's.
        let counts_for = |of_server: &Arc<HeldKey>| of_server.counts_for.load(Ordering::Relaxed);
        assert_eq!(held.iter().map(counts_for).collect::<Vec<_>>(), [32, 32]);
        for keyring in keyrings {
            keyring.store.close().await;
        }
    }
}
