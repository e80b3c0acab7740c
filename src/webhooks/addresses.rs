//! Where messages may go: hosts that the operator names, at public addresses, or at a private one where the operator names the host in full. A service that
//! sends requests where its clients say must not be sent to neighbors that its operator does not name.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};
use std::str::FromStr;
use std::sync::Arc;

use reqwest::Url;

/// Where messages may be sent.
#[derive(Clone)]
pub struct HookRules {
    /// The hosts; none: webhooks are off.
    pub allowed: Vec<HookTarget>,
    /// Check of whether a host may be connected to at an address, after its name was looked up. Only tests replace [`HookRules::to_named`].
    pub reachable: Reachable,
}

/// Check of whether a host, as a URL has it, may be connected to at an address.
pub(super) type Reachable = Arc<dyn Fn(&str, IpAddr) -> bool + Send + Sync>;

impl HookRules {
    /// Messages to these hosts: at public addresses, of a host that is named in full at private ones too, and at an address that is named as such also if it is
    /// one of this machine or of its link.
    pub fn to_named(allowed: Vec<HookTarget>) -> Self {
        let named = allowed.clone();
        let reachable = move |host: &str, address| {
            is_public(address) || named.iter().any(|target| target.names(host, address))
        };
        Self {
            allowed,
            reachable: Arc::new(reachable),
        }
    }

    /// Checks that messages may be sent to `url`.
    ///
    /// # Errors
    ///
    /// A sentence that says why not.
    pub(super) fn check(&self, url: &str) -> Result<(), String> {
        const LONGEST: usize = 2000;
        if self.allowed.is_empty() {
            return Err("Webhooks are off in this service.".to_owned());
        }
        // As the sender reads it, to whom 127.1, 0x7f000001 and 2130706433 are addresses, too. He passes over some controls, but not
        // everybody who keeps them does.
        let is_text = url.len() <= LONGEST && !url.contains(char::is_control);
        let parsed = Url::parse(url).ok().filter(|_| is_text);
        let target = parsed
            .as_ref()
            .and_then(|url| Some((url, url.host_str()?, url.port_or_known_default()?)));
        let Some((url, host, port)) = target else {
            return Err(format!("{url:?} is not an address that can be sent to."));
        };
        if !url.username().is_empty() || url.password().is_some() {
            return Err("The address of a webhook has no user or password in it.".to_owned());
        }
        let scheme = url.scheme();
        if !self
            .allowed
            .iter()
            .any(|target| target.takes(scheme, host, port))
        {
            return Err(format!(
                "This service does not send to {scheme}://{host}:{port}; ask its operator."
            ));
        }
        let literal = host.trim_start_matches('[').trim_end_matches(']');
        match literal.parse::<IpAddr>() {
            Ok(address) if !(self.reachable)(host, address) => {
                Err(format!("{address} is not a public address."))
            }
            _ => Ok(()),
        }
    }
}

/// A host that messages may be sent to: `hooks.example.com`, `*.example.com`, with a port if it is not 443, and with
/// `http://` before it if it has no encryption.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HookTarget {
    scheme: &'static str,
    host: String,
    any_below: bool,
    port: u16,
}

impl HookTarget {
    /// True if this names `host` at `address`, which is not public.
    fn names(&self, host: &str, address: IpAddr) -> bool {
        if self.any_below || self.host != host {
            return false;
        }
        let literal = self.host.trim_start_matches('[').trim_end_matches(']');
        let is_literal = literal.parse() == Ok(address);
        is_private(address) || is_literal && is_here(address)
    }

    fn takes(&self, scheme: &str, host: &str, port: u16) -> bool {
        let host_fits = if self.any_below {
            host.strip_suffix(&self.host)
                .is_some_and(|below| below.len() > 1 && below.ends_with('.'))
        } else {
            host == self.host
        };
        scheme == self.scheme && port == self.port && host_fits
    }
}

impl FromStr for HookTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (scheme, rest) = match text.split_once("://") {
            Some(("http", rest)) => ("http", rest),
            Some(("https", rest)) => ("https", rest),
            Some((other, _)) => return Err(format!("{other} is neither http nor https")),
            None => ("https", text),
        };
        let (any_below, rest) = match rest.strip_prefix("*.") {
            Some(rest) => (true, rest),
            None => (false, rest),
        };
        let authority: hyper::http::uri::Authority = rest
            .parse()
            .map_err(|_| format!("{rest:?} is no host, or host and port"))?;
        if authority.as_str().contains(['@', '*']) || authority.host().is_empty() {
            return Err(format!("{rest:?} is no host, or host and port"));
        }
        let usual = if scheme == "http" { 80 } else { 443 };
        Ok(Self {
            scheme,
            host: authority.host().to_ascii_lowercase(),
            any_below,
            port: authority.port_u16().unwrap_or(usual),
        })
    }
}

/// True for an address of a private network.
fn is_private(address: IpAddr) -> bool {
    match address {
        IpAddr::V4(address) => address.is_private(),
        IpAddr::V6(address) => address.is_unique_local(),
    }
}

/// True for an address of this machine or of its link.
fn is_here(address: IpAddr) -> bool {
    match address {
        IpAddr::V4(address) => address.is_loopback() || address.is_link_local(),
        IpAddr::V6(address) => address.is_loopback() || address.is_unicast_link_local(),
    }
}

/// True for an address of the public internet: not this host, not its network, not one of IANA's registries of special-purpose addresses.
fn is_public(address: IpAddr) -> bool {
    match address {
        IpAddr::V4(address) => is_public_v4(address),
        IpAddr::V6(address) => is_public_v6(address),
    }
}

fn is_public_v4(address: Ipv4Addr) -> bool {
    let [a, b, c, _] = address.octets();
    let set_aside = address.is_private()
        || address.is_loopback()
        || address.is_link_local()
        || address.is_documentation()
        || address.is_multicast()
        || a == 0
        || (a == 100 && (64..128).contains(&b)) // shared by carriers
        || (a == 192 && b == 0 && c == 0) // protocol assignments
        || (a == 192 && b == 88 && c == 99) // relays of 6to4, no longer in use
        || (a == 198 && (18..20).contains(&b)) // benchmarks
        || a >= 240; // reserved, and broadcast
    !set_aside
}

fn is_public_v6(address: Ipv6Addr) -> bool {
    let parts = address.segments();
    // Addresses that carry one of version 4 lead there. Of those only the translation that is public may be used.
    if parts[..6] == [0x64, 0xff9b, 0, 0, 0, 0] {
        let [.., a, b] = parts;
        return is_public_v4(Ipv4Addr::from((u32::from(a) << 16) | u32::from(b)));
    }
    let is_unicast = parts[0] & 0xe000 == 0x2000;
    let set_aside = match (parts[0], parts[1]) {
        // Protocol assignments, Teredo among them; documentation.
        (0x2001, second) => second < 0x200 || second == 0xdb8,
        // 6to4, which carries version 4.
        (0x2002, _) => true,
        // Documentation.
        (0x3fff, second) => second < 0x1000,
        _ => false,
    };
    is_unicast && !set_aside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_but_the_public_internet_is_public() {
        for address in [
            "1.1.1.1",
            "8.8.8.8",
            "203.0.114.1",
            "100.128.0.1",
            "2606:4700::1",
            "64:ff9b::8.8.8.8",
        ] {
            assert!(is_public(address.parse().unwrap()), "{address}");
        }
        for address in [
            "0.0.0.0",
            "0.1.2.3",
            "10.0.0.1",
            "100.64.0.1",
            "127.0.0.1",
            "127.255.0.1",
            "169.254.169.254",
            "172.16.0.1",
            "172.31.255.255",
            "192.0.0.1",
            "192.0.2.1",
            "192.88.99.1",
            "192.168.1.1",
            "198.18.0.1",
            "198.51.100.1",
            "203.0.113.1",
            "224.0.0.1",
            "240.0.0.1",
            "255.255.255.255",
            "::",
            "::1",
            "::ffff:127.0.0.1",
            "::ffff:8.8.8.8",
            "::127.0.0.1",
            "64:ff9b::10.0.0.1",
            "64:ff9b:1::1",
            "100::1",
            "2001::1",
            "2001:db8::1",
            "2002:7f00:1::",
            "3fff::1",
            "5f00::1",
            "fc00::1",
            "fd12::1",
            "fe80::1",
            "fec0::1",
            "ff02::1",
        ] {
            assert!(!is_public(address.parse().unwrap()), "{address}");
        }
    }

    #[test]
    fn a_host_that_is_named_in_full_may_have_a_private_address_and_this_machine_only_as_an_address()
    {
        let targets = [
            "hooks.example.com",
            "*.portal.example",
            "127.0.0.1",
            "[fe80::1]",
            "10.0.0.7",
        ];
        let rules = HookRules::to_named(targets.map(|target| target.parse().unwrap()).to_vec());
        let reaches = |host: &str, address: &str| (rules.reachable)(host, address.parse().unwrap());
        for (host, address) in [
            ("hooks.example.com", "8.8.8.8"),
            ("hooks.example.com", "10.0.0.1"),
            ("hooks.example.com", "192.168.1.1"),
            ("hooks.example.com", "172.31.255.255"),
            ("hooks.example.com", "fd12::1"),
            ("a.portal.example", "8.8.8.8"),
            ("127.0.0.1", "127.0.0.1"),
            ("[fe80::1]", "fe80::1"),
            ("10.0.0.7", "10.0.0.7"),
        ] {
            assert!(reaches(host, address), "{host} at {address}");
        }
        for (host, address) in [
            ("hooks.example.com", "127.0.0.1"),
            ("hooks.example.com", "169.254.169.254"),
            ("hooks.example.com", "::1"),
            ("hooks.example.com", "fe80::1"),
            ("hooks.example.com", "::ffff:10.0.0.1"),
            ("hooks.example.com", "0.0.0.0"),
            ("hooks.example.com", "100.64.0.1"),
            ("hooks.example.com", "224.0.0.1"),
            ("a.portal.example", "10.0.0.1"),
            ("portal.example", "10.0.0.1"),
            ("a.portal.example", "fd12::1"),
            ("other.example", "10.0.0.1"),
            ("127.0.0.2", "127.0.0.2"),
        ] {
            assert!(!reaches(host, address), "{host} at {address}");
        }
    }

    #[test]
    fn messages_go_to_allowed_hosts_only() {
        let targets = [
            "hooks.example.com",
            "*.portal.example:8443",
            "http://plain.example",
            "10.0.0.1",
        ];
        let rules = HookRules::to_named(targets.map(|target| target.parse().unwrap()).to_vec());
        for url in [
            "https://hooks.example.com/a?b",
            "https://HOOKS.example.com:443/",
            "https://a.portal.example:8443/",
            "https://a.b.portal.example:8443/",
            "http://plain.example/",
            "https://10.0.0.1/",
            "https://0xa000001/",
        ] {
            assert_eq!(rules.check(url), Ok(()), "{url}");
        }
        for url in [
            "http://hooks.example.com/",
            "https://hooks.example.com:444/",
            "https://evil.example/",
            "https://hooks.example.com.evil.example/",
            "https://hooks.example.com@evil.example/",
            "https://user@hooks.example.com/",
            "https://portal.example:8443/",
            "https://evilportal.example:8443/",
            "https://plain.example/",
            "https://10.0.0.2/",
            "https://10.2/",
            "https://0xa000002/",
            "https://167772162/",
            "https://[::1]/",
            "https://127.1/",
            "https://0x7f000001/",
            "https://2130706433/",
            "https://017700000001/",
            "https://0x7f.1/",
            "https://127.0.0.1./",
            "https://\u{ff11}27.0.0.1/",
            "https://hooks.example.com/a\0b",
            "https://hooks.example.com/?\0",
            "https://hooks.example.com/#\0",
            "\0https://hooks.example.com/",
            "https://hooks.example.com/\n",
            "ftp://hooks.example.com/",
            "hooks.example.com",
            "/path",
            "",
        ] {
            assert!(rules.check(url).is_err(), "{url}");
        }
        let off = HookRules::to_named(Vec::new());
        assert!(
            off.check("https://hooks.example.com/")
                .unwrap_err()
                .contains("off")
        );
        for target in ["", "ftp://x", "a b", "*", "user@host"] {
            assert!(target.parse::<HookTarget>().is_err(), "{target}");
        }
    }
}
