//! Reading documents: our own ones passage by passage, hostile ones within bounds, PDF files in a process of their own.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use d3dgen_research::Error;
use d3dgen_research::extract::Extractor;
use d3dgen_research::read::pdf::{Limits, Program, run_child};
use d3dgen_research::read::{Document, Kind, Options, PassageKind, read};

fn documents() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/documents")
}

/// This very test binary, asked to run `the_child_side`.
fn program(limits: Limits) -> Program {
    let arguments = ["--exact", "the_child_side", "--ignored", "--nocapture"].map(str::to_owned);
    Program { path: std::env::current_exe().expect("a test runs from a file"), arguments: arguments.into(), limits }
}

#[test]
#[ignore = "runs in the process that the other tests start"]
fn the_child_side() {
    // The limits are the last two arguments; to the test harness they are names of tests that do not exist.
    let arguments: Vec<u64> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let [memory, seconds] = arguments[..] else { return };
    run_child(std::io::stdin(), std::io::stdout(), memory, seconds).unwrap();
}

fn options() -> Options {
    Options { pdf: Some(program(Limits::default())), ..Options::default() }
}

fn html(text: &str) -> Document {
    read(text.as_bytes(), Some("text/html; charset=utf-8"), "page", &options()).unwrap()
}

fn texts(document: &Document) -> Vec<&str> {
    document.passages.iter().map(|p| p.text.as_str()).collect()
}

fn shown(document: &Document) -> String {
    let mut out =
        format!("title: {:?}\nlanguage: {:?}\nkind: {:?}\n", document.title, document.language, document.kind);
    document.meta.iter().for_each(|(k, v)| out += &format!("meta {k}: {v}\n"));
    document.warnings.iter().for_each(|w| out += &format!("warning: {w}\n"));
    for p in &document.passages {
        let page = p.page.map(|n| format!(", page {n}")).unwrap_or_default();
        out += &format!("\n[{:?}{page}] {}\n{}\n", p.kind, p.heading.join(" > "), p.text);
    }
    out
}

#[test]
fn our_documents_read_as_expected() {
    let mut wrong = Vec::new();
    for name in ["ward.html", "office.md", "wohnung.txt", "hallen.pdf"] {
        let document = read(&std::fs::read(documents().join(name)).unwrap(), None, name, &options()).unwrap();
        let text = shown(&document);
        let path = documents().join(format!("{name}.expected"));
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        if std::fs::read_to_string(&path).unwrap_or_default() != text {
            wrong.push(format!("{name} reads as\n{text}"));
        }
        let whole = document.text();
        for p in &document.passages {
            assert_eq!(&whole[p.offset..p.offset + p.text.len()], p.text, "{name}: {}", p.id);
        }
        let ids: std::collections::BTreeSet<_> = document.passages.iter().map(|p| &p.id).collect();
        assert_eq!(ids.len(), document.passages.len(), "{name}: ids are unique");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Returns the figures with their units that are found in a document, each passage read under its nearest heading.
fn figures(document: &Document) -> Vec<String> {
    let language = document.language.as_deref().unwrap_or_default();
    let texts = document.passages.iter().map(|p| format!("{}\n\n{}", p.heading.last().map_or("", |h| h), p.text));
    let found = texts.flat_map(|text| Extractor::shared().extract(&text, language));
    found.map(|f| format!("{} {}", serde_json::to_value(&f.constraint.value).unwrap(), f.constraint.unit)).collect()
}

#[test]
fn figures_come_through() {
    let cases: [(&str, &[&str]); 4] = [
        (
            "ward.html",
            &["2.35 m", "2.6 m", "16.0 m^2", "24.0 m^2", "28.0 m^2", "12.5 m^2", "2.4 m", "1.2 m", "300.0 lx"],
        ),
        ("office.md", &["8.0 m^2", "1.4 m", "0.8 m", "1.1 m", "2.0 m^2/person"]),
        ("wohnung.txt", &["1.2 m", "0.8 m", "9.5 m^2", "7.5 m^2", "4.2 m^2", "1.8 m"]),
        ("hallen.pdf", &["3.5 m", "0.75 m", "35.0 m", "2.4 m", "4.0 m", "1.8 m", "2.9 m"]),
    ];
    for (name, expected) in cases {
        let document = read(&std::fs::read(documents().join(name)).unwrap(), None, name, &options()).unwrap();
        let found = figures(&document);
        let missing: Vec<_> = expected.iter().filter(|e| !found.iter().any(|f| f == *e)).collect();
        assert!(missing.is_empty(), "{name}: no {missing:?} in {found:?}");
    }
}

#[test]
fn parts_of_pages_and_texts_become_passages_that_stand_alone() {
    let pages = [
        ("<p>Widths:<br>- doors 0.9 m<br>- halls 1.5 m</p>", "Widths:\n- doors 0.9 m\n- halls 1.5 m"),
        ("<p>The doors of<br>the ward are wide.</p>", "The doors of the ward are wide."),
        (
            "<table><tr><td>Room</td><td>Area (m²)</td><td>Use</td></tr><tr><td>Office</td><td>9</td><td>-</td></tr></table>",
            "Room | Area (m²) | Use\nOffice | 9 | -",
        ),
        (
            "<table><tr><th colspan=2>Staff</th></tr><tr><td>Office</td><td>9 m²</td></tr></table>",
            "Staff:\n- Office: 9 m²",
        ),
        ("<pre>Door      0.9 m\nHall      1.5 m</pre>", "- Door: 0.9 m\n- Hall: 1.5 m"),
    ];
    for (page, expected) in pages {
        assert_eq!(texts(&html(page)), [expected], "{page}");
    }
    let titled = "<table><tr><th colspan=2>Widths in mm</th></tr><tr><th>Door</th><th>Width</th></tr>\
                  <tr><td>Bath</td><td>900</td></tr></table>";
    let document = html(titled);
    assert_eq!(
        (texts(&document), &document.passages[0].heading[..]),
        (vec!["Door | Width\nBath | 900"], &["Widths in mm".to_owned()][..])
    );

    let text = "1. Scope\n\nMade up.\n\n2. Doors\n\nDoors are at least\n0.9 m wide.\n\n   a) ward doors: 1.2 m\n   b) bath doors: 0.95 m\n      where turned\n\n\
                Room\tArea\nOffice\t9 m2\nStore\t4 m2\n\nEnd.";
    let document = read(text.as_bytes(), Some("text/plain"), "x", &options()).unwrap();
    let expected = [
        "Made up.",
        "Doors are at least 0.9 m wide.",
        "- ward doors: 1.2 m\n- bath doors: 0.95 m where turned",
        "Room | Area\nOffice | 9 m2\nStore | 4 m2",
        "End.",
    ];
    assert_eq!(texts(&document), expected);
    assert!(document.passages[1..].iter().all(|p| p.heading == ["2. Doors"]));
}

#[test]
fn an_id_stays_when_other_parts_change() {
    let one = html("<h2>Doors</h2><p>A door is 0.9 m wide.</p>");
    let two = html("<p>New first.</p><h2>Doors</h2><p>A door is 0.9 m wide.</p><p>A door is 0.9 m wide.</p>");
    assert_eq!(one.passages[0].id, two.passages[1].id);
    assert_eq!(two.passages[2].id, format!("{}-2", one.passages[0].id));
}

#[test]
fn inline_html_becomes_the_text_a_reader_sees() {
    let cases = [
        ("<p>8&nbsp;m<sup>2</sup> and 12 m&sup2;</p>", "8 m² and 12 m²"),
        ("<p>3 kg/m<sup>3</sup>, 0.5 W/m<sup>2</sup>K</p>", "3 kg/m³, 0.5 W/m²K"),
        ("<p>width 1.5 m<sup>1)</sup> or more<sup>[2]</sup></p>", "width 1.5 m or more"),
        ("<p>10<sup>3</sup> lx, the 1<sup>st</sup> floor</p>", "10³ lx, the 1st floor"),
        ("<p>2<sup>1</sup>/<sub>2</sub> ft, CO<sub>2</sub></p>", "2 1/2 ft, CO2"),
        ("<p>a&shy;b c\u{200b}d\u{202e}e</p>", "ab cde"),
        ("<p>one<!-- 5 m --> two<script>3 m</script></p>", "one two"),
        ("<p>was <del>2 m</del> <ins>3 m</ins></p>", "was 3 m"),
        ("<div>bare <b>text</b> 4&thinsp;m</div>", "bare text 4 m"),
        ("<p>20&deg;C and 20 <sup>o</sup>C</p>", "20°C and 20 °C"),
    ];
    for (page, expected) in cases {
        assert_eq!(texts(&html(page)), [expected], "{page}");
    }
}

#[test]
fn what_a_reader_does_not_see_is_not_read() {
    let hidden = [
        r#"<p style="DISPLAY : NONE !important">X</p>"#,
        r#"<style>.a{display:none}</style><div class="b a"><p>X</p></div>"#,
        r#"<style>@media screen{#a>p{visibility:hidden}}</style><div id=a><p>X</p></div>"#,
        r#"<style>p{display:none!important}</style><p style="display:block">X</p>"#,
        r#"<style>/* } */ .x,.a{opacity:0.01}</style><p class=a>X</p>"#,
        r#"<style>#a{display:none} p.b{display:none} p{display:block} .b{display:block}</style><p id=a>X</p><p class=b>X"#,
        r#"<p style="font:0/0 a">X</p>"#,
        r#"<p style="font:bold 1px/1.5 serif">X</p>"#,
        r#"<p style="font-size:1px">X</p>"#,
        r#"<p style="text-indent:-9999px">X</p>"#,
        r#"<p style="position:absolute;clip:rect(0,0,0,0)">X</p>"#,
        r#"<p style="height:0;overflow:hidden">X</p>"#,
        r#"<p style="transform:translateX(-200vw)">X</p>"#,
        r#"<p style="color:transparent">X</p>"#,
        r#"<p style="color:white">X</p>"#,
        "<p><font color='#FFFFFF'>X</font></p>",
        r#"<body bgcolor=black><p>X</p></body>"#,
        r#"<table bgcolor="navy"><tr><td style="color:#000080">X</td><td></td></tr></table>"#,
        r#"<div style="background:#eee"><span style="color:#eeeeee">X</span></div>"#,
        "<template><p>X</p></template><noscript>X</noscript><select><option>X</select>",
        "<dialog><p>X</p></dialog><div role=navigation>X</div><iframe>X</iframe>",
        "<header><div hidden><h1>X</h1></div></header>",
        "<dl><div hidden><dt>X</dt><dd>X</dd></div></dl>",
        "<ul><li hidden>X</li></ul>",
    ];
    for page in hidden {
        let document = html(page);
        assert!(!shown(&document).contains('X'), "{page}: {}", shown(&document));
    }
    let visible = [
        r#"<style>.a{display:none}.b{display:block}</style><p class="a b">X</p>"#,
        r#"<style>.a:hover{display:none} @media print{p{display:none}}</style><p class=a>X</p>"#,
        r#"<div style="background:#000;color:#fff"><p>X</p></div>"#,
        r#"<p style="font:1 12px/1.5 serif">X</p>"#,
        r#"<p style="background:url(a.png);color:white">X</p>"#,
        r#"<form action="/"><h1>T</h1><p>X</p></form>"#,
        r#"<p style="margin-left:-10px;opacity:.9;font-size:0.8em">X</p>"#,
    ];
    for page in visible {
        assert!(texts(&html(page)).contains(&"X"), "{page}");
    }
}

#[test]
fn tables_that_only_place_things_are_text() {
    let page = "<table><tr><td><h1>Title</h1><p>A door is 0.9 m.</p></td><td><p>Second.</p></td></tr></table>";
    assert_eq!(texts(&html(page)), ["A door is 0.9 m.", "Second."]);
}

#[test]
fn charsets_are_found() {
    let german = "<p>Fläche 8 m² für Gäste</p>";
    let latin: Vec<u8> = german.chars().map(|c| c as u8).collect();
    let meta = [b"<meta charset=iso-8859-1>".as_slice(), &latin].concat();
    let utf16: Vec<u8> = german.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked = [&[0xff, 0xfe], utf16.as_slice()].concat();
    let cases: [(&[u8], &str); 7] = [
        (german.as_bytes(), "text/html"),
        (german.as_bytes(), "text/html; charset=iso-8859-1"),
        (&latin, "text/html; charset=ISO-8859-1"),
        (&latin, "text/html"),
        (&meta, "text/html"),
        (&utf16, "text/html"),
        (&marked, "text/html"),
    ];
    for (i, (bytes, content_type)) in cases.into_iter().enumerate() {
        let document = read(bytes, Some(content_type), "page", &options()).unwrap();
        assert_eq!(texts(&document), ["Fläche 8 m² für Gäste"], "case {i}");
    }
}

#[test]
fn kinds_are_told_from_bytes_type_and_name() {
    type Case = (&'static [u8], Option<&'static str>, &'static str, Result<Kind, ()>);
    let cases: [Case; 10] = [
        (b"<!doctype html><p>a", None, "x", Ok(Kind::Html)),
        (b"plain", None, "x.html?y=1", Ok(Kind::Html)),
        (b"# a", Some("text/plain"), "https://h.test/a.md", Ok(Kind::Markdown)),
        (b"%PDF-1.4 ...", Some("text/html"), "x", Ok(Kind::Pdf)),
        (b"text", Some("application/octet-stream"), "x", Ok(Kind::Text)),
        (b"PK\x03\x04...", Some("text/html"), "x.html", Err(())),
        (b"text", Some("application/json"), "x", Err(())),
        (b"text", Some("application/pdf"), "x", Err(())),
        (b"\x00\x01\x02\x03\x04\x05", None, "x.txt", Err(())),
        (b"", None, "x.txt", Ok(Kind::Text)),
    ];
    for (bytes, content_type, name, expected) in cases {
        assert_eq!(Kind::of(bytes, content_type, name).map_err(drop), expected, "{name} {content_type:?}");
    }
}

/// Runs on a thread with a small stack: what recurses with its input overflows it.
fn bounded(name: &str, seconds: u64, work: impl FnOnce() + Send + 'static) {
    let start = Instant::now();
    let thread = std::thread::Builder::new().stack_size(2 << 20).spawn(work).unwrap();
    thread.join().unwrap_or_else(|_| panic!("{name} panics"));
    assert!(start.elapsed() < Duration::from_secs(seconds), "{name} took {:?}", start.elapsed());
}

#[test]
fn hostile_pages_are_read_within_bounds() {
    let pages: [(&str, String); 11] = [
        ("nested", "<div>".repeat(200_000) + "X"),
        ("nested tables", "<table><tr><td>".repeat(50_000)),
        ("nested lists", "<ul><li>".repeat(50_000) + "X"),
        ("closing in vain", "<span></div>".repeat(100_000) + "X"),
        ("closing themselves", "<div/>".repeat(100_000) + "X"),
        ("unclosed formatting", "<b><font size=1><i>x<p>".repeat(50_000)),
        ("misnested", "<a><div></a>".repeat(50_000)),
        ("many tags", "<p>a".repeat(500_000)),
        ("huge spans", "<table><tr><td colspan=99999 rowspan=99999>1<td>2".repeat(2_000)),
        (
            "many rules",
            format!("<style>{}</style>{}", "div p.a b{color:red}".repeat(5000), "<p class=a>x".repeat(20_000)),
        ),
        ("braces", format!("<style>{}</style>X", "@media screen{a{".repeat(50_000))),
    ];
    for (name, page) in pages {
        let start = Instant::now();
        bounded(name, 30, move || {
            let document = html(&page);
            assert!(document.passages.len() <= 600_000);
        });
        println!("{name}: {:?}", start.elapsed());
    }
    let document = html(&("<p>first</p>".to_owned() + &"<div>".repeat(1000) + "<p>last</p>"));
    assert_eq!(texts(&document), ["first"]);
    assert!(document.warnings.iter().any(|w| w.contains("too deep")), "{:?}", document.warnings);
}

#[test]
fn hostile_bytes_are_read_or_refused_clearly() {
    let refused = |bytes: &[u8], name: &str| match read(bytes, None, name, &options()) {
        Err(Error::Read { code, .. }) => code,
        other => panic!("{name}: {other:?}"),
    };
    let large = Options { max_bytes: 1000, ..options() };
    let error = read(&[b'a'; 1001], None, "a.txt", &large).unwrap_err();
    assert_eq!(error.to_string(), "a.txt: has 1001 bytes, the limit is 1000");
    assert_eq!(refused(&[0; 5000], "zeros.txt"), "unsupported_type");
    assert_eq!(refused(b"%PDF-1.4 and nothing else", "a.pdf"), "pdf_unreadable");

    let broken =
        read(b"A door \xff\xfe is 0.9\0 m wide.", Some("text/plain; charset=utf-8"), "a.txt", &options()).unwrap();
    assert_eq!(texts(&broken), ["A door \u{fffd}\u{fffd} is 0.9 m wide."]);
    assert_eq!(broken.warnings.len(), 2, "{:?}", broken.warnings);

    bounded("50 MB of text", 60, || {
        let text = "A corridor is 1.5 m wide and not a centimeter less.\n".repeat(1_000_000);
        let document = read(text.as_bytes(), None, "a.txt", &Options::default()).unwrap();
        assert!(document.passages.len() > 10_000);
        assert!(document.passages.iter().all(|p| p.text.len() < 2_000 && p.kind == PassageKind::Prose));
    });
    bounded("gaps that are no columns", 30, || {
        let text = "x   yyyyyyyyyyyyyyy\nxxxxxxxxxx   y\n".repeat(50_000);
        let document = read(text.as_bytes(), None, "a.txt", &Options::default()).unwrap();
        assert!(document.passages.iter().all(|p| p.kind == PassageKind::Prose));
    });
    bounded("one line of 20 MB", 60, || {
        let document = read(&vec![b'x'; 20 << 20], None, "a.txt", &Options::default()).unwrap();
        assert_eq!(document.passages.iter().map(|p| p.text.len()).sum::<usize>(), 20 << 20);
    });
    bounded("a page of Markdown quotes", 30, || {
        let text = ">".repeat(50_000) + "\n" + &"[".repeat(50_000) + &"*a_".repeat(20_000);
        read(text.as_bytes(), None, "a.md", &Options::default()).unwrap();
    });
}

fn code(result: Result<Document, Error>) -> String {
    match result {
        Err(Error::Read { code, .. }) => code.to_owned(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn pdf_files_are_read_within_limits() {
    let file = std::fs::read(documents().join("hallen.pdf")).unwrap();
    let with = |path: &str, limits: Limits| {
        let program = if path.is_empty() {
            program(limits)
        } else {
            Program { path: path.into(), arguments: Vec::new(), limits }
        };
        read(&file, None, "hallen.pdf", &Options { pdf: Some(program), ..Options::default() })
    };
    let limits = Limits::default();
    assert_eq!(code(read(&file, None, "hallen.pdf", &Options::default())), "pdf_unavailable");
    assert_eq!(code(with("/does/not/exist", limits)), "pdf_unavailable");
    assert_eq!(code(with("", Limits { memory_bytes: 1 << 20, ..limits })), "pdf_crashed");
    assert_eq!(code(with("", Limits { output_bytes: 100, ..limits })), "pdf_too_much");
    // `sleep` with the memory and the time as seconds: it never answers.
    let start = Instant::now();
    assert_eq!(code(with("/bin/sleep", Limits { time: Duration::from_millis(300), ..limits })), "pdf_timeout");
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    assert_eq!(code(with("/bin/true", limits)), "pdf_crashed");
}

#[test]
fn damaged_and_swollen_pdf_files_are_refused_or_read_in_part() {
    let file = std::fs::read(documents().join("hallen.pdf")).unwrap();
    let mut outcomes = std::collections::BTreeMap::<String, usize>::new();
    for round in 0..24usize {
        let mut damaged = file.clone();
        // A fixed walk over the file: a byte here and there, and in some rounds the end is missing.
        for k in 0..1 + round % 6 * 4 {
            let at = (round * 7919 + k * 104_729) % damaged.len();
            damaged[at] ^= (k * 37 + round + 1) as u8;
        }
        if round % 3 == 2 {
            damaged.truncate(damaged.len() - round * 97 % damaged.len());
        }
        let outcome = match read(&damaged, Some("application/pdf"), "damaged.pdf", &options()) {
            Ok(_) => "read".to_owned(),
            Err(Error::Read { code, .. }) => code.to_owned(),
            Err(other) => panic!("{other}"),
        };
        *outcomes.entry(outcome).or_default() += 1;
    }
    println!("{outcomes:?}");
    assert!(outcomes.contains_key("read") && outcomes.contains_key("pdf_unreadable"), "{outcomes:?}");

    let bomb = swollen();
    assert!(bomb.len() < 3 << 20);
    let limits = Limits { memory_bytes: 128 << 20, time: Duration::from_secs(20), ..Limits::default() };
    let start = Instant::now();
    let result = read(&bomb, None, "bomb.pdf", &Options { pdf: Some(program(limits)), ..Options::default() });
    println!("a file that unpacks to 300 MB: {result:?} after {:?}", start.elapsed());
    assert!(result.is_err() && start.elapsed() < Duration::from_secs(40));
}

/// Returns a small file with a page whose content unpacks to 300 MB.
fn swollen() -> Vec<u8> {
    use std::io::Write;
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let part = b"BT (x) Tj ET\n".repeat(80_000);
    (0..300).for_each(|_| packed.write_all(&part).unwrap());
    // Packed twice, as the format allows.
    let mut again = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    again.write_all(&packed.finish().unwrap()).unwrap();
    let stream = again.finish().unwrap();
    let mut file = b"%PDF-1.4\n".to_vec();
    let mut starts = Vec::new();
    let mut object = |file: &mut Vec<u8>, body: &[u8]| {
        starts.push(file.len());
        file.extend(format!("{} 0 obj\n", starts.len()).bytes().chain(body.iter().copied()).chain(*b"\nendobj\n"));
    };
    object(&mut file, b"<< /Type /Catalog /Pages 2 0 R >>");
    object(&mut file, b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>");
    object(&mut file, b"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 100 100] /Contents 4 0 R /Resources << >> >>");
    let head = format!("<< /Length {} /Filter [/FlateDecode /FlateDecode] >>\nstream\n", stream.len());
    object(&mut file, &[head.as_bytes(), &stream, b"\nendstream"].concat());
    let at = file.len();
    file.extend(b"xref\n0 5\n0000000000 65535 f \n");
    starts.iter().for_each(|s| file.extend(format!("{s:010} 00000 n \n").bytes()));
    file.extend(format!("trailer\n<< /Size 5 /Root 1 0 R >>\nstartxref\n{at}\n%%EOF\n").bytes());
    file
}

#[test]
fn the_shared_sample_of_a_pdf_file_reads() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/llm/fixtures/web/rules_sample.pdf");
    let Ok(bytes) = std::fs::read(&path) else {
        return eprintln!("skipped: no ../shared beside the project");
    };
    let document = read(&bytes, None, "rules_sample.pdf", &options()).unwrap();
    println!("{}", shown(&document));
    assert!(document.passages.iter().all(|p| p.page == Some(1) && p.heading.starts_with(&["Room sizes".to_owned()])));
    let table = document.passages.iter().find(|p| p.kind == PassageKind::Table).map(|p| p.text.as_str());
    let rows = "Room | Min. area (m²) | Min. width (m)\nSingle bedroom | 8 | 2.2\nDouble bedroom | 12 | 2.6\nBathroom | 4 | 1.5";
    assert_eq!(table, Some(rows));
    assert_eq!(document.title.as_deref(), Some("Room sizes (self-written sample)"));
}
