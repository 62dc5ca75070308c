//! One form for all addresses of the same page.

use std::sync::OnceLock;

use serde::Deserialize;
use url::Url;

#[derive(Deserialize)]
struct Tracking {
    tracking_prefixes: Vec<String>,
    tracking: Vec<String>,
}

fn tracking() -> &'static Tracking {
    static SHARED: OnceLock<Tracking> = OnceLock::new();
    SHARED.get_or_init(|| toml::from_str(include_str!("../../data/urls.toml")).expect("shipped data is tested"))
}

/// Returns an address with `https`, without fragment, tracking parameters and last slash; `None` for what is no web
/// address, and for addresses with a user name or password, which must not be written anywhere.
pub fn canonical_url(text: &str) -> Option<String> {
    let mut url = Url::parse(text.trim()).ok().filter(|u| matches!(u.scheme(), "http" | "https"))?;
    if !url.username().is_empty() || url.password().is_some() || url.host_str().is_none_or(str::is_empty) {
        return None;
    }
    url.set_fragment(None);
    let known = tracking();
    let kept: Vec<String> = url
        .query()
        .unwrap_or_default()
        .split('&')
        .filter(|pair| {
            let name = pair.split('=').next().unwrap_or_default().to_ascii_lowercase();
            !name.is_empty()
                && !known.tracking.contains(&name)
                && !known.tracking_prefixes.iter().any(|p| name.starts_with(p.as_str()))
        })
        .map(str::to_owned)
        .collect();
    url.set_query(Some(kept.join("&").as_str()).filter(|q| !q.is_empty()));
    if url.scheme() == "http" && url.set_scheme("https").is_err() {
        return None;
    }
    let path = url.path().trim_end_matches('/').to_owned();
    url.set_path(&path);
    let text = url.to_string();
    // `url` keeps the slash of an empty path.
    Some(if url.query().is_none() { text.trim_end_matches('/').to_owned() } else { text })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_of_one_page_become_one() {
        for (text, expected) in [
            ("http://Example.org/Rules/", Some("https://example.org/Rules")),
            ("https://example.org/rules?utm_source=openai&b=2&UTM_medium=x#s4", Some("https://example.org/rules?b=2")),
            ("https://example.org:443/rules?fbclid=1", Some("https://example.org/rules")),
            ("https://example.org/", Some("https://example.org")),
            ("https://example.org", Some("https://example.org")),
            ("https://example.org/a?id=3", Some("https://example.org/a?id=3")),
            ("https://user:pw@example.org/a", None),
            ("ftp://example.org/a", None),
            ("rules.html", None),
        ] {
            assert_eq!(canonical_url(text).as_deref(), expected, "{text}");
        }
    }
}
