//! Takes a body apart into JSON documents: one, a list, server-sent events or a line each. What they mean is up to the
//! provider.

use serde_json::Value;

use crate::error::Error;
use crate::transport::Response;

/// The JSON documents of a body.
#[derive(Debug)]
pub(crate) struct Documents {
    /// In order; at least one.
    pub items: Vec<Value>,
    /// Whether they came as a stream, whose end has to be marked by its last document.
    pub streamed: bool,
}

/// # Errors
/// [`Error::BadResponse`] for anything that is not JSON in one of the forms.
pub(crate) fn documents(response: &Response) -> Result<Documents, Error> {
    let text = response.text();
    let text = text.trim_start_matches('\u{feff}').trim();
    let kind = response.header("content-type").unwrap_or_default();
    if kind.contains("event-stream") || ["data:", "event:"].iter().any(|p| text.starts_with(p)) {
        return Ok(Documents { items: events(text)?, streamed: true });
    }
    match serde_json::from_str(text) {
        Ok(Value::Array(items)) if !items.is_empty() => return Ok(Documents { items, streamed: true }),
        Ok(value @ Value::Object(_)) if !kind.contains("ndjson") => {
            return Ok(Documents { items: vec![value], streamed: false });
        }
        Ok(Value::Object(_)) | Err(_) if text.starts_with('{') => {}
        _ if text.starts_with('<') => return Err(Error::bad_response("a page instead of JSON")),
        _ if text.is_empty() => return Err(Error::bad_response("an empty body instead of JSON")),
        _ => return Err(Error::bad_response("not a JSON object")),
    }
    let lines = text.lines().map(str::trim).filter(|l| !l.is_empty());
    let items: Result<Vec<Value>, _> = lines.map(serde_json::from_str).collect();
    match items {
        Ok(items) if items.len() > 1 || kind.contains("ndjson") => Ok(Documents { items, streamed: true }),
        _ => Err(Error::bad_response("broken JSON")),
    }
}

/// Reads server-sent events: `data` lines up to a blank line are one document.
fn events(text: &str) -> Result<Vec<Value>, Error> {
    let mut items = Vec::new();
    let mut data = String::new();
    for line in text.lines().chain([""]) {
        if let Some(piece) = line.strip_prefix("data:") {
            if !data.is_empty() {
                data.push('\n');
            }
            data.push_str(piece.strip_prefix(' ').unwrap_or(piece));
        } else if line.trim().is_empty() && !data.is_empty() {
            let event = std::mem::take(&mut data);
            if event.trim() != "[DONE]" {
                let broken = |_| Error::bad_response("an event of the stream is broken JSON");
                items.push(serde_json::from_str(&event).map_err(broken)?);
            }
        }
    }
    if items.is_empty() { Err(Error::bad_response("a stream without events")) } else { Ok(items) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(kind: &str, body: &str, expected: Option<(usize, bool)>) {
        let headers = [("content-type".to_owned(), kind.to_owned())].into();
        let response = Response { status: 200, headers, body: body.as_bytes().to_vec() };
        let found = documents(&response).ok().map(|d| (d.items.len(), d.streamed));
        assert_eq!(found, expected, "{body}");
    }

    #[test]
    fn bodies_are_taken_apart() {
        check("application/json", "{\"a\":1}", Some((1, false)));
        check("application/json", "\u{feff}\n{\"a\":\n1}", Some((1, false)));
        check("application/json", "[{\"a\":1},{\"a\":2}]", Some((2, true)));
        check("application/x-ndjson", "{\"a\":1}\n\n{\"a\":2}\n", Some((2, true)));
        check("application/x-ndjson", "{\"a\":1}", Some((1, true)));
        check("text/plain", "{\"a\":1}\n{\"a\":2}", Some((2, true)));
        check(
            "text/event-stream",
            ": hi\r\nevent: x\r\ndata: {\"a\":\r\ndata: 1}\r\n\r\ndata: [DONE]",
            Some((1, true)),
        );
        check("text/event-stream", "data:{\"a\":1}\n\ndata:{\"a\":2}", Some((2, true)));
        for broken in ["", "[]", "3", "<html></html>", "{\"a\":", "{\"a\":1}\n{\"a\":", "data: {\"a\":", "data: [DONE]"]
        {
            check("application/json", broken, None);
        }
    }
}
