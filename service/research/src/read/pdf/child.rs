//! The process that reads one PDF file: it limits itself, reads the file from its input, and prints what the file says.
//!
//! What it is not for: being called in the process of the program: it takes away memory and files from whoever calls it.

use std::io::{Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use pdf_extract::{Dictionary, Document, Object, OutputError, output_doc_page};

use super::glyphs::Collector;
use super::wire::{Answer, File, MARK};

/// No file is read beyond so many pages.
const MAX_PAGES: usize = 3_000;
/// The stack for files whose objects are nested deep.
const STACK_BYTES: usize = 64 << 20;

/// Reads a PDF file from `input` and writes what it says to `output`, in the form that `pdf::read` expects. This is all
/// that the process started by a `Program` has to do; it ends after it. `memory_bytes` and `seconds` bound the whole
/// process from here on; 0 sets no bound.
///
/// # Errors
///
/// When the input cannot be read or the output not be written; a file that cannot be read is no error but an answer.
pub fn run(mut input: impl Read, mut output: impl Write, memory_bytes: u64, seconds: u64) -> std::io::Result<()> {
    limit(memory_bytes, seconds);
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    // The message of a panic goes into the answer.
    std::panic::set_hook(Box::new(|_| {}));
    let reader = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(move || read(&bytes))?;
    let answer = reader.join().unwrap_or_else(|panic| Answer::Failed(broken(panic.as_ref())));
    let text = serde_json::to_string(&answer)?;
    write!(output, "\n{MARK}{}\n{text}\n", text.len())?;
    output.flush()
}

/// Bounds this process: memory, time, and no file may be written.
#[cfg(unix)]
fn limit(memory_bytes: u64, seconds: u64) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let set = |resource, most: u64| {
        let limit = Rlimit { current: Some(most), maximum: Some(most) };
        // A stricter limit may be in force already, which is as good.
        let _ = setrlimit(resource, limit);
    };
    set(Resource::Core, 0);
    set(Resource::Fsize, 0);
    if memory_bytes > 0 {
        set(Resource::Data, memory_bytes);
        // Address space is also taken by what is only reserved, such as stacks.
        set(Resource::As, memory_bytes.saturating_mul(4));
    }
    if seconds > 0 {
        set(Resource::Cpu, seconds);
    }
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
}

#[cfg(not(unix))]
fn limit(_: u64, _: u64) {}

fn read(bytes: &[u8]) -> Answer {
    let loaded = catch_unwind(|| {
        let mut document = Document::load_mem(bytes).map_err(|e| format!("cannot be opened: {e}"))?;
        if document.is_encrypted() {
            document.decrypt("").map_err(|_| "is protected by a password; save it without".to_owned())?;
        }
        Ok::<_, String>(document)
    });
    let document = match loaded {
        Ok(Ok(document)) => document,
        Ok(Err(reason)) => return Answer::Failed(reason),
        Err(panic) => return Answer::Failed(broken(panic.as_ref())),
    };
    let mut file = File::default();
    information(&document, &mut file);
    let mut collector = Collector::default();
    let numbers: Vec<u32> = document.get_pages().into_keys().collect();
    if numbers.is_empty() {
        return Answer::Failed("has no pages, or their list is damaged".into());
    }
    if numbers.len() > MAX_PAGES {
        file.warnings.push(format!("{} pages beyond {MAX_PAGES} left out", numbers.len() - MAX_PAGES));
    }
    let mut failed = Vec::new();
    for number in numbers.into_iter().take(MAX_PAGES) {
        let result = catch_unwind(AssertUnwindSafe(|| output_doc_page(&document, &mut collector, number)));
        collector.finish();
        match result {
            Ok(Ok(())) => {}
            Ok(Err(error)) => failed.push(format!("page {number} is read in part: {}", reason(&error))),
            Err(panic) => failed.push(format!("page {number} is read in part: {}", broken(panic.as_ref()))),
        }
    }
    if collector.pages.iter().all(|p| p.lines.is_empty()) && !failed.is_empty() {
        return Answer::Failed(failed.swap_remove(0));
    }
    file.warnings.append(&mut failed);
    if collector.hidden > 0 {
        file.warnings.push(format!("{} letters outside of the page or too small to read left out", collector.hidden));
    }
    if collector.turned > 0 {
        file.warnings.push(format!("{} letters that run up or down the page left out", collector.turned));
    }
    file.pages = collector.pages;
    Answer::File(file)
}

/// Reads what the file says about itself.
fn information(document: &Document, file: &mut File) {
    let entry = document.trailer.get(b"Info").ok();
    let resolved = entry.and_then(|o| match o {
        Object::Reference(id) => document.get_object(*id).ok(),
        other => Some(other),
    });
    let Some(info) = resolved.and_then(|o| o.as_dict().ok()) else { return };
    let text = |info: &Dictionary, key: &[u8]| {
        let text = info.get(key).ok().and_then(|o| o.as_str().ok()).map(decoded)?;
        // Some writers put "(unspecified)" where they know nothing.
        Some(text.trim().to_owned()).filter(|t| !t.is_empty() && t.len() < 500 && !t.starts_with('('))
    };
    // "untitled" and file names of word processors are no titles.
    let named = |t: &String| {
        let lower = t.to_lowercase();
        lower != "untitled"
            && !lower.starts_with("microsoft word")
            && ![".doc", ".docx", ".indd"].iter().any(|e| lower.ends_with(e))
    };
    file.title = text(info, b"Title").filter(named);
    for (key, name) in [(b"Author".as_slice(), "author"), (b"Subject", "description"), (b"CreationDate", "date")] {
        if let Some(value) = text(info, key) {
            let value = if name == "date" { date(&value) } else { Some(value) };
            value.into_iter().for_each(|v| drop(file.meta.insert(name.to_owned(), v)));
        }
    }
}

/// Returns `D:20240131...` as `2024-01-31`.
fn date(text: &str) -> Option<String> {
    let digits = text.trim_start_matches("D:").get(..8).filter(|d| d.bytes().all(|b| b.is_ascii_digit()))?;
    Some(format!("{}-{}-{}", digits.get(..4)?, digits.get(4..6)?, digits.get(6..8)?))
}

/// Returns the text of a PDF string: UTF-16 with its mark, else one byte a letter.
fn decoded(bytes: &[u8]) -> String {
    match bytes {
        [0xfe, 0xff, ..] => encoding_rs::UTF_16BE.decode(bytes).0.into_owned(),
        [0xef, 0xbb, 0xbf, ..] => encoding_rs::UTF_8.decode(bytes).0.into_owned(),
        _ => encoding_rs::WINDOWS_1252.decode(bytes).0.into_owned(),
    }
}

fn reason(error: &OutputError) -> String {
    match error {
        OutputError::PdfError(error) => error.to_string(),
        OutputError::IoError(error) => error.to_string(),
        OutputError::FormatError(error) => error.to_string(),
    }
}

fn broken(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    let text = text.unwrap_or("without a message").lines().next().unwrap_or_default();
    let text = text.get(..text.floor_char_boundary(200)).unwrap_or_default();
    format!("is damaged or made in a way that is not understood ({text})")
}
