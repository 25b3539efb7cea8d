//! Addresses of databases: files and servers.

/// Whether an address names a database of a server.
pub fn is_server_url(url: &str) -> bool {
    url.starts_with("postgres://") || url.starts_with("postgresql://")
}

/// Returns an address as it may be shown: without the password that a server is given.
pub fn without_password(url: &str) -> String {
    if !is_server_url(url) {
        return url.to_owned();
    }
    let (address, parameters) = url.split_once('?').map_or((url, None), |(of, rest)| (of, Some(rest)));
    let address = match (address.split_once("://"), address.rsplit_once('@')) {
        (Some((scheme, rest)), Some((_, host))) => {
            let user = rest.split([':', '@']).next().unwrap_or_default();
            format!("{scheme}://{user}@{host}")
        }
        _ => address.to_owned(),
    };
    let shown = |parameter: &&str| !parameter.starts_with("password=");
    let parameters: Vec<&str> = parameters.iter().flat_map(|of| of.split('&')).filter(shown).collect();
    if parameters.is_empty() { address } else { format!("{address}?{}", parameters.join("&")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_shown_without_its_password() {
        for (url, shown) in [
            (
                "postgres://me:se:cr@et@host:5432/base?sslmode=require",
                "postgres://me@host:5432/base?sslmode=require",
            ),
            ("postgres://me@host/base", "postgres://me@host/base"),
            ("postgresql://host/base?user=me&password=secret", "postgresql://host/base?user=me"),
            ("sqlite://a:b@c.db", "sqlite://a:b@c.db"),
        ] {
            assert_eq!(without_password(url), shown);
        }
    }
}
