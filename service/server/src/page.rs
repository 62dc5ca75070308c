//! The web page, which lies inside of the program: `web/dist`, at the same port as everything else.
//!
//! The page itself needs no token: it asks for one and calls as any client does. What it may load is told to the browser.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::LazyLock;

use axum::body::Body;
use axum::routing::get;
use flate2::Compression;
use flate2::write::GzEncoder;
use http::{HeaderMap, HeaderValue, Response, StatusCode, Uri, header};
use rust_embed::{Embed, EmbeddedFile};

/// The built page; `npm run build` in `web/` makes it.
#[derive(Embed)]
#[folder = "../../web/dist"]
struct Dist;

/// What the page may load: its own scripts, styles and calls, and pictures that it makes itself.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
                      connect-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Files whose names carry their hash never change.
const HASHED: &str = "/assets/";
/// The first file of all.
const INDEX: &str = "/index.html";
/// Types by the ending of a file.
const TYPES: [(&str, &str); 6] = [
    ("html", "text/html; charset=utf-8"),
    ("js", "text/javascript; charset=utf-8"),
    ("css", "text/css; charset=utf-8"),
    ("svg", "image/svg+xml"),
    ("json", "application/json"),
    ("png", "image/png"),
];

/// A file of the page.
struct PageFile {
    kind: &'static str,
    etag: String,
    plain: Vec<u8>,
    packed: Vec<u8>,
}

static FILES: LazyLock<BTreeMap<String, PageFile>> = LazyLock::new(|| {
    let read = |name: Cow<'static, str>| Some((format!("/{name}"), file(&name, Dist::get(&name)?)));
    Dist::iter().filter_map(read).collect()
});

fn file(name: &str, embedded: EmbeddedFile) -> PageFile {
    let ending = name.rsplit('.').next().unwrap_or_default();
    let kind = TYPES.iter().find(|(known, _)| *known == ending).map_or("application/octet-stream", |(_, kind)| kind);
    let etag = crate::access::hex(&embedded.metadata.sha256_hash()[..12]);
    let plain = embedded.data.into_owned();
    let mut packer = GzEncoder::new(Vec::new(), Compression::best());
    // writing to memory does not fail; a file that is not packed is sent as it is
    let packed = packer.write_all(&plain).and_then(|()| packer.finish()).unwrap_or_default();
    PageFile { kind, etag, plain, packed }
}

/// Returns the path of the file that a path asks for: the page itself for `/`.
fn asked(path: &str) -> &str {
    if path == "/" { INDEX } else { path }
}

/// Returns true for a path of the page.
pub fn has(path: &str) -> bool {
    FILES.contains_key(asked(path))
}

/// Returns what answers the page's paths.
pub fn router<S: Clone + Send + Sync + 'static>() -> axum::Router<S> {
    let paths = FILES.keys().map(String::as_str).chain(["/"]);
    paths.fold(axum::Router::new(), |router, path| router.route(path, get(answer)))
}

/// Returns a file of the page, packed for who takes it so, or only that it has not changed.
async fn answer(uri: Uri, headers: HeaderMap) -> Response<Body> {
    let path = asked(uri.path());
    let Some(file) = FILES.get(path) else { return status(StatusCode::NOT_FOUND) };
    let packs = !file.packed.is_empty() && lists(&headers, header::ACCEPT_ENCODING, "gzip");
    let etag = format!("\"{}{}\"", file.etag, if packs { "-gz" } else { "" });
    let same = lists(&headers, header::IF_NONE_MATCH, &etag);
    let mut response = if same {
        status(StatusCode::NOT_MODIFIED)
    } else {
        Response::new(Body::from(if packs { &file.packed[..] } else { &file.plain[..] }))
    };
    let cache = if path.starts_with(HASHED) { "public, max-age=31536000, immutable" } else { "no-cache" };
    let mut fixed = vec![
        (header::CONTENT_TYPE, file.kind),
        (header::CACHE_CONTROL, cache),
        (header::VARY, "accept-encoding"),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    if packs && !same {
        fixed.push((header::CONTENT_ENCODING, "gzip"));
    }
    let all = response.headers_mut();
    all.extend(fixed.into_iter().map(|(name, value)| (name, HeaderValue::from_static(value))));
    if let Ok(etag) = HeaderValue::from_str(&etag) {
        all.insert(header::ETAG, etag);
    }
    response
}

/// Returns true when a header lists a value, alone or with a weight or the mark of a weak etag.
pub(crate) fn lists(headers: &HeaderMap, name: header::HeaderName, wanted: &str) -> bool {
    let values = headers.get_all(name).into_iter().filter_map(|v| v.to_str().ok());
    let mut entries = values.flat_map(|v| v.split(',')).map(str::trim);
    entries.any(|entry| entry.split(';').next().unwrap_or_default().trim_start_matches("W/") == wanted)
}

fn status(code: StatusCode) -> Response<Body> {
    let mut response = Response::new(Body::empty());
    *response.status_mut() = code;
    response
}
