//! A store of objects: a folder, S3, or a bucket of NATS. Objects are written whole, and once.

use std::sync::Arc;

use async_nats::jetstream::{self, object_store::ObjectStore as NatsBucket};
use bytes::Bytes;
use futures_util::TryStreamExt;
use object_store::path::Path;
use object_store::{ObjectStore, ObjectStoreExt, PutMode, PutOptions};
use tokio::io::AsyncReadExt;
use url::Url;

use super::failed;
use crate::error::Error;

/// A store of objects.
#[derive(Clone)]
pub struct Objects(Kind);

#[derive(Clone)]
enum Kind {
    Plain { store: Arc<dyn ObjectStore>, prefix: Path },
    Nats(Box<NatsBucket>),
}

impl Objects {
    /// Opens a store: a folder, `s3://bucket/prefix`, or `nats://host:port/bucket`, which is made where it is not there.
    ///
    /// `options` are settings of S3 as `object_store` names them (`aws_access_key_id`, `aws_endpoint`, ...).
    ///
    /// # Errors
    /// `Input` for a URL that names no store; `Cluster` when it cannot be reached.
    pub async fn open(url: &str, options: &[(String, String)]) -> Result<Self, Error> {
        let refused = |why: String| {
            Error::Input(format!(
                "`{url}` is no store: {why}; write a folder, s3://bucket/prefix or nats://host:4222/bucket"
            ))
        };
        let parsed = if url.contains("://") {
            Url::parse(url).map_err(|e| refused(e.to_string()))?
        } else {
            let folder = std::path::absolute(url).map_err(|e| refused(e.to_string()))?;
            Url::from_directory_path(folder).map_err(|()| refused("it is no path".into()))?
        };
        if parsed.scheme() == "nats" || parsed.scheme() == "tls" {
            return Self::open_bucket(&parsed).await;
        }
        if let Some(folder) = (parsed.scheme() == "file").then(|| parsed.to_file_path().ok()).flatten() {
            std::fs::create_dir_all(&folder).map_err(Error::write(&folder))?;
        }
        let known = options.iter().map(|(key, value)| (key.as_str(), value.clone()));
        let (store, prefix) = object_store::parse_url_opts(&parsed, known).map_err(|e| refused(e.to_string()))?;
        Ok(Self(Kind::Plain { store: store.into(), prefix }))
    }

    async fn open_bucket(url: &Url) -> Result<Self, Error> {
        let refused = failed("the store");
        let bucket = url.path().trim_matches('/').to_owned();
        if bucket.is_empty() || bucket.contains('/') {
            return Err(Error::Input(format!("`{url}` names no bucket; write nats://host:4222/bucket")));
        }
        let client = async_nats::connect(url.as_str()).await.map_err(|e| refused(&e))?;
        let context = jetstream::new(client);
        let store = match context.get_object_store(&bucket).await {
            Ok(store) => store,
            Err(_) => {
                let config = jetstream::object_store::Config { bucket, ..Default::default() };
                context.create_object_store(config).await.map_err(|e| refused(&e))?
            }
        };
        Ok(Self(Kind::Nats(Box::new(store))))
    }

    /// Writes an object, whole or not at all, unless it is there; returns whether it was written.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn put_new(&self, name: &str, bytes: Vec<u8>) -> Result<bool, Error> {
        let refused = failed(&format!("the store does not take {name}"));
        match &self.0 {
            Kind::Plain { store, prefix } => {
                let options = PutOptions { mode: PutMode::Create, ..PutOptions::default() };
                match store.put_opts(&place(prefix, name), bytes.into(), options).await {
                    Ok(_) => Ok(true),
                    Err(object_store::Error::AlreadyExists { .. }) => Ok(false),
                    Err(error) => Err(refused(&error)),
                }
            }
            // what is there has the same bytes: objects are named by their digest, or say what follows from it
            Kind::Nats(bucket) => {
                if bucket.info(name).await.is_ok() {
                    return Ok(false);
                }
                bucket.put(name, &mut bytes.as_slice()).await.map(|_| true).map_err(|e| refused(&e))
            }
        }
    }

    /// Returns an object; none when it is not there.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn get(&self, name: &str) -> Result<Option<Bytes>, Error> {
        let refused = failed(&format!("the store does not give {name}"));
        match &self.0 {
            Kind::Plain { store, prefix } => match store.get(&place(prefix, name)).await {
                Ok(found) => found.bytes().await.map(Some).map_err(|e| refused(&e)),
                Err(object_store::Error::NotFound { .. }) => Ok(None),
                Err(error) => Err(refused(&error)),
            },
            Kind::Nats(bucket) => {
                if bucket.info(name).await.is_err() {
                    return Ok(None);
                }
                let mut object = bucket.get(name).await.map_err(|e| refused(&e))?;
                let mut bytes = Vec::new();
                object.read_to_end(&mut bytes).await.map_err(|e| refused(&e))?;
                Ok(Some(bytes.into()))
            }
        }
    }

    /// Returns the names of all objects below a place, sorted.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn list(&self, below: &str) -> Result<Vec<String>, Error> {
        let refused = failed(&format!("the store does not list {below}"));
        let mut names: Vec<String> = match &self.0 {
            Kind::Plain { store, prefix } => {
                let whole = place(prefix, below);
                let found: Vec<_> = store.list(Some(&whole)).try_collect().await.map_err(|e| refused(&e))?;
                let head = if prefix.as_ref().is_empty() { 0 } else { prefix.as_ref().len() + 1 };
                found.into_iter().filter_map(|o| o.location.as_ref().get(head..).map(str::to_owned)).collect()
            }
            Kind::Nats(bucket) => {
                let all: Vec<_> =
                    bucket.list().await.map_err(|e| refused(&e))?.try_collect().await.map_err(|e| refused(&e))?;
                let head = format!("{below}/");
                all.into_iter().map(|o| o.name).filter(|name| name.starts_with(&head)).collect()
            }
        };
        names.sort();
        Ok(names)
    }

    /// Removes an object that is there.
    ///
    /// # Errors
    /// `Cluster`.
    pub async fn remove(&self, name: &str) -> Result<(), Error> {
        let refused = failed(&format!("the store does not remove {name}"));
        match &self.0 {
            Kind::Plain { store, prefix } => store.delete(&place(prefix, name)).await.map_err(|e| refused(&e)),
            Kind::Nats(bucket) => bucket.delete(name).await.map_err(|e| refused(&e)),
        }
    }
}

fn place(prefix: &Path, name: &str) -> Path {
    Path::from_iter(prefix.parts().map(|p| p.as_ref().to_owned()).chain(name.split('/').map(str::to_owned)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn objects_are_written_once_and_listed_by_place() {
        let folder = tempfile::tempdir().unwrap();
        let store = Objects::open(folder.path().join("a b").to_str().unwrap(), &[]).await.unwrap();
        assert!(store.put_new("runs/x/ledger/1.json", b"one".to_vec()).await.unwrap());
        assert!(!store.put_new("runs/x/ledger/1.json", b"two".to_vec()).await.unwrap());
        assert_eq!(store.get("runs/x/ledger/1.json").await.unwrap().unwrap().as_ref(), b"one");
        assert_eq!(store.get("runs/x/ledger/2.json").await.unwrap(), None);
        assert_eq!(store.list("runs/x/ledger").await.unwrap(), ["runs/x/ledger/1.json"]);
        assert_eq!(store.list("runs/y").await.unwrap(), Vec::<String>::new());
        store.remove("runs/x/ledger/1.json").await.unwrap();
        assert_eq!(store.get("runs/x/ledger/1.json").await.unwrap(), None);
        assert!(Objects::open("ftp://host/folder", &[]).await.is_err());
        assert!(Objects::open("nats://127.0.0.1:1/", &[]).await.is_err());
    }
}
