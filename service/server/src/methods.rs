//! What each RPC needs, from `data/methods.toml`: scope and kind of call.

use std::collections::BTreeMap;
use std::time::Duration;

use serde::Deserialize;

use crate::access::Scope;
use crate::config::Limits;
use crate::{page, pictures};

const METHODS: &str = include_str!("../data/methods.toml");

/// What bounds the time of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Looks something up.
    Lookup,
    /// Makes or checks something.
    Work,
    /// Goes on for long.
    Stream,
}

/// What a call needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Need {
    /// Least scope; none for everybody.
    #[serde(default)]
    pub scope: Option<Scope>,
    /// What bounds its time.
    pub kind: Kind,
}

/// The needs of all methods, by path: `/d3dgen.v1.DomainService/ListDomains`.
#[derive(Debug)]
pub struct Methods(BTreeMap<String, Need>);

/// What the page needs: it asks for the token itself.
const PAGE: Need = Need { scope: None, kind: Kind::Lookup };

/// Protocols beside the contract, which libraries serve.
const OTHERS: &[(&str, Need)] = &[
    ("/grpc.health.v1.Health/Check", Need { scope: None, kind: Kind::Lookup }),
    ("/grpc.health.v1.Health/Watch", Need { scope: None, kind: Kind::Stream }),
    ("/grpc.health.v1.Health/List", Need { scope: None, kind: Kind::Lookup }),
    (
        "/grpc.reflection.v1.ServerReflection/ServerReflectionInfo",
        Need { scope: Some(Scope::Read), kind: Kind::Stream },
    ),
    (
        "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo",
        Need { scope: Some(Scope::Read), kind: Kind::Stream },
    ),
    ("/healthz", Need { scope: None, kind: Kind::Lookup }),
    ("/livez", Need { scope: None, kind: Kind::Lookup }),
    ("/readyz", Need { scope: None, kind: Kind::Lookup }),
    ("/metrics", Need { scope: Some(Scope::Read), kind: Kind::Lookup }),
];

impl Methods {
    /// Returns the list of this release.
    pub fn shipped() -> Self {
        let services: BTreeMap<String, BTreeMap<String, Need>> =
            toml::from_str(METHODS).expect("a test reads the list of methods");
        let own = services.into_iter().flat_map(|(service, methods)| {
            methods.into_iter().map(move |(method, need)| (format!("/d3dgen.v1.{service}/{method}"), need))
        });
        Self(own.chain(OTHERS.iter().map(|(path, need)| ((*path).to_owned(), *need))).collect())
    }

    /// Returns what a call needs; one that nobody listed needs the most.
    pub fn need(&self, path: &str) -> Need {
        let plain = || page::has(path).then_some(PAGE).or_else(|| pictures::need(path));
        self.0.get(path).copied().or_else(plain).unwrap_or(Need { scope: Some(Scope::Admin), kind: Kind::Work })
    }

    /// Returns the path as it was listed, for counters; calls of anything else are counted as one.
    pub fn label(&self, path: &str) -> &str {
        let plain = if page::has(path) { "page" } else { "other" };
        self.0.get_key_value(path).map_or(plain, |(known, _)| known.as_str())
    }

    /// Returns all paths of the contract.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }
}

impl Kind {
    /// Returns the longest time of such a call.
    pub fn limit(self, limits: &Limits) -> Duration {
        match self {
            Self::Lookup => limits.lookup,
            Self::Work => limits.work,
            Self::Stream => limits.stream,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use prost::Message;
    use prost_types::FileDescriptorSet;

    use super::*;

    #[test]
    fn the_list_is_that_of_the_contract() {
        let contract = FileDescriptorSet::decode(d3dgen_proto::FILE_DESCRIPTOR_SET).unwrap();
        let mut wanted = BTreeSet::new();
        for file in contract.file {
            for service in &file.service {
                let method = |m: &prost_types::MethodDescriptorProto| {
                    format!("/{}.{}/{}", file.package(), service.name(), m.name())
                };
                wanted.extend(service.method.iter().map(method));
            }
        }
        let methods = Methods::shipped();
        let listed: BTreeSet<String> =
            methods.paths().filter(|p| p.starts_with("/d3dgen.v1.")).map(str::to_owned).collect();
        assert_eq!(listed, wanted);
        assert!(wanted.iter().all(|path| methods.need(path).scope.is_some()), "every call needs a token");
    }
}
