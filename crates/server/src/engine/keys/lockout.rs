//! Lockout guard: over HTTP, no request leaves a server without a key that may administer.
//!
//! The first key closes a server to everybody without one. Were it a key that cannot make others, nothing over HTTP could
//! open the server again. `revisit keys` works on the database and is always a way back, so it is not guarded.

use crate::domain::key::{Action, Key, KeyProperties, KeySeq, MapPattern};
use crate::domain::keyframe::Stamp;
use crate::engine::{Result, ServiceError};

/// What an operator does when no key may administer.
pub const WAY_BACK: &str = "`revisit keys create --actions read,write,query,admin` makes one in the database";

/// Whether a request may leave the server without a key that may administer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lockout {
    /// It is refused. Requests over HTTP.
    Refused,
    /// It is meant. The command line, and requests that say so.
    Meant,
}

/// Whether a key is good and may administer.
pub(super) fn administers(key: &Key, now: Stamp) -> bool {
    key.is_good(now) && key.properties.actions.has(Action::Admin)
}

/// Rejects a first key that cannot administer every map for good.
pub(in crate::engine) fn check_first_key(properties: &KeyProperties) -> Result<()> {
    let every_map = properties.maps.contains(&MapPattern::every());
    let lacks = [
        (!properties.actions.has(Action::Admin), "the action `admin`"),
        (!every_map, "every map (leave `maps` out)"),
        (properties.expires.is_some(), "no expiry (leave `expires` out)"),
    ];
    let lacks: Vec<&str> = lacks.into_iter().filter(|(lacks, _)| *lacks).map(|(_, needs)| needs).collect();
    if lacks.is_empty() {
        return Ok(());
    }
    let detail = format!(
        "this server has no key yet, and from its first key on every request needs one. This key could not administer the \
         server, which would be locked. Make the administrator's key first: it needs {}. Or make any key with \
         `revisit keys create`",
        lacks.join(", and ")
    );
    Err(ServiceError::Conflict { code: "first_key_must_administer", detail })
}

/// Rejects revoking the last key that administers, or the last one that does so without an expiry.
pub(in crate::engine) fn check_revocation(keys: &[Key], revoked: KeySeq, now: Stamp) -> Result<()> {
    let administrators = || keys.iter().filter(|key| administers(key, now));
    let Some(key) = administrators().find(|key| key.seq == revoked) else { return Ok(()) };
    let mut others = administrators().filter(|other| other.seq != revoked);
    let lasts = |key: &Key| key.properties.expires.is_none();
    let (left, what) = if lasts(key) {
        (others.any(lasts), "the last key that may administer and does not expire")
    } else {
        (others.next().is_some(), "the last key that may administer")
    };
    if left {
        return Ok(());
    }
    let detail = format!(
        "{} is {what}. Make another one first, or say `?last_admin=true` if this is meant; after that, {WAY_BACK}",
        revoked.public()
    );
    Err(ServiceError::Conflict { code: "last_admin_key", detail })
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Stamp = Stamp { sec: 1_000, nanosec: 0 };

    fn key(number: i64, actions: &[Action], expires_sec: Option<i64>) -> Key {
        let properties = KeyProperties {
            name: String::new(),
            actions: actions.iter().copied().collect(),
            maps: vec![MapPattern::every()],
            expires: expires_sec.map(|sec| Stamp { sec, nanosec: 0 }),
            rate_per_s: None,
            max_maps: None,
            max_bytes: None,
            model_daily_calls: None,
            model_daily_microusd: None,
        };
        Key { seq: KeySeq(number), properties, created_sec: 0, revoked_sec: None }
    }

    #[test]
    fn the_last_key_that_administers_is_kept_and_no_other() {
        let robot = key(1, &[Action::Write], None);
        let admin = |number, expires| key(number, &[Action::Admin], expires);
        let revoked = |number| Key { revoked_sec: Some(1), ..admin(number, None) };
        for (keys, target, kept) in [
            (vec![robot.clone(), admin(2, None)], 2, true),
            (vec![robot.clone(), admin(2, None)], 1, false),
            (vec![admin(2, None), admin(3, None)], 2, false),
            (vec![admin(2, None), revoked(3)], 2, true),
            (vec![admin(2, None), revoked(3)], 3, false),
            // One that has expired, or will, does not stand in for one that lasts.
            (vec![admin(2, None), admin(3, Some(999))], 2, true),
            (vec![admin(2, None), admin(3, Some(2_000))], 2, true),
            (vec![admin(2, None), admin(3, Some(2_000))], 3, false),
            (vec![admin(2, Some(2_000)), admin(3, Some(3_000))], 3, false),
            (vec![admin(2, Some(2_000))], 2, true),
            (vec![admin(2, Some(999))], 2, false),
        ] {
            let refused = check_revocation(&keys, KeySeq(target), NOW).is_err();
            assert_eq!(refused, kept, "key {target} of {keys:#?}");
        }
    }
}
