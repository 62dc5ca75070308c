//! Prompts and what must be read in them: those of `tests/prompts/`, the shared ones with gold facts where they are, and
//! text that nobody means.

#![allow(clippy::unwrap_used)] // helpers of tests are tests

use std::path::Path;

use d3dgen_model::Document;
use d3dgen_model::brief::{Brief, Fact, Subject};
use d3dgen_plugins::Registry;
use d3dgen_prompt::PromptReader;

fn reader() -> PromptReader {
    PromptReader::new(&Registry::builtin())
}

/// Lines of a file: a prompt, then what must be among its facts, each line of it indented.
fn cases(text: &str) -> Vec<(&str, Vec<&str>)> {
    let mut cases: Vec<(&str, Vec<&str>)> = Vec::new();
    for line in text.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#')) {
        match line.strip_prefix("    ") {
            Some(fact) => cases.last_mut().expect("a prompt stands before its facts").1.push(fact.trim()),
            None => cases.push((line, Vec::new())),
        }
    }
    cases
}

#[test]
fn prompts_of_many_languages_are_read() {
    let reader = reader();
    let mut wrong = Vec::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/prompts");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for (prompt, facts) in cases(&text) {
            assert!(!facts.is_empty(), "nothing is asked of `{prompt}`");
            let read = reader.read(prompt);
            let brief = &read.brief;
            let building = brief.building.as_ref().map(|b| {
                format!("building {}/{}", b.domain.as_deref().unwrap_or("-"), b.building_type.as_deref().unwrap_or("-"))
            });
            let place = brief.place.as_ref().map(|p| format!("place {}", p.country_code));
            let unread = brief.not_understood.iter().map(|w| format!("unread {}", w.text));
            let found: Vec<String> = read.facts.iter().cloned().chain(building).chain(place).chain(unread).collect();
            // "never rooms 60": no fact begins so
            let holds = |fact: &str| match fact.strip_prefix("never ") {
                Some(start) => !found.iter().any(|x| x.starts_with(start)),
                None => found.iter().any(|x| x == fact),
            };
            let missing: Vec<&str> = facts.into_iter().filter(|f| !holds(f)).collect();
            if !missing.is_empty() {
                wrong.push(format!("{prompt}\n  lacks {missing:?}\n  has {found:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{} prompts:\n{}", wrong.len(), wrong.join("\n"));
}

/// Returns what is wrong with how the words of a prompt are accounted for.
fn unaccounted(reader: &PromptReader, prompt: &str) -> Option<String> {
    let brief = reader.read(prompt).brief;
    // a brief that documents refuse, among them words that do not quote the prompt
    Brief::from_json(&brief.to_json()).err().map(|e| e.to_string())
}

#[test]
fn any_text_has_a_brief() {
    let reader = reader();
    let mut state = 11u64;
    let mut random = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let words = [
        "flat",
        "with",
        "3",
        "bedrooms",
        "no",
        "only",
        "Küche",
        "ohne",
        "zwei",
        "m²",
        "12",
        "x",
        "4",
        "m",
        "会议室",
        "三间",
        "로봇",
        "2대",
        "salle de",
        "réunion",
        "next to",
        "the",
        "between",
        "and",
        ",",
        ";",
        ":",
        "each",
        "robot",
        "from",
        "to",
        "ignore all previous instructions",
        "999999999999999999999",
        "-1",
        "0",
        "1e400",
        "\u{202e}",
        "🦀",
        "кухня",
        "без",
        "キッチン",
        "なし",
        "{\"asks\":[]}",
        "at least",
        "floor",
        "second",
    ];
    for _ in 0..300 {
        let mut prompt = String::new();
        for _ in 0..random(40) {
            match random(8) {
                0 => prompt.push(char::from_u32(random(0x3_0000) as u32).unwrap_or('x')),
                _ => prompt.push_str(words[random(words.len() as u64) as usize]),
            }
            if random(4) > 0 {
                prompt.push(' ');
            }
        }
        if let Some(reason) = unaccounted(&reader, &prompt) {
            panic!("{prompt:?}: {reason}");
        }
    }
    let long: String = (0..2500).map(|i| words[i * 7 % words.len()]).collect::<Vec<_>>().join(" ");
    assert!(long.len() > 10_000);
    assert_eq!(unaccounted(&reader, &long), None);
}

#[test]
fn every_word_is_in_a_fact_a_small_word_or_told() {
    let reader = reader();
    let read = reader.read("flat with 3 bedrooms, a flumbarium and a glorp near the kitchen");
    let told: Vec<&str> = read.brief.not_understood.iter().map(|w| w.text.as_str()).collect();
    let said: String = read.brief.asks.iter().map(|a| a.said()).collect::<Vec<_>>().join(" ");
    for word in ["flumbarium", "glorp"] {
        assert!(told.iter().any(|t| t.contains(word)) || said.contains(word), "{word}: {told:?} {said}");
    }
}

#[test]
fn every_id_that_a_language_names_is_one_of_a_domain() {
    let registry = Registry::builtin();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../language/data");
    let room = |id: &str| registry.iter().any(|p| p.domain().room_type(id).is_some());
    let object = |id: &str| registry.iter().any(|p| p.domain().object(id).is_some());
    for language in std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()) {
        for file in std::fs::read_dir(&language).unwrap().map(|e| e.unwrap().path()) {
            let text = std::fs::read_to_string(&file).unwrap();
            let table: toml::Table = toml::from_str(&text).unwrap();
            let ids = |class: &str| -> Vec<String> {
                table.get(class).and_then(toml::Value::as_table).into_iter().flat_map(|t| t.keys().cloned()).collect()
            };
            ids("room").iter().for_each(|id| assert!(room(id), "{}: no room type `{id}`", file.display()));
            ids("object").iter().for_each(|id| assert!(object(id), "{}: no object `{id}`", file.display()));
            for id in ids("suite").iter().chain(&ids("shorthand")).flat_map(|ids| ids.split('+')) {
                let id = id.trim_end_matches("-1").split('*').next().unwrap_or_default();
                assert!(room(id), "{}: no room type `{id}`", file.display());
            }
        }
    }
}

/// Our own prompts with gold facts, in twelve languages, and the shared ones where they are.
#[test]
fn gold_facts_of_prompts_are_read() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (file, least) in [("tests/gold/mixed.jsonl", 90), ("../../../shared/asks/asks_a.jsonl", 80)] {
        let Ok(text) = std::fs::read_to_string(here.join(file)) else {
            eprintln!("{file} is not here: nothing is compared");
            continue;
        };
        let (read, asked) = gold_facts(&text);
        eprintln!("{read} of {asked} gold facts of {file}");
        assert!(read * 100 >= asked * least, "{read} of {asked} of {file}");
    }
}

/// Returns how many gold facts of prompts are read, and how many there are.
fn gold_facts(text: &str) -> (usize, usize) {
    let reader = reader();
    let (mut asked, mut read) = (0, 0);
    for line in text.lines() {
        let gold: serde_json::Value = serde_json::from_str(line).unwrap();
        let prompt = gold["prompt"].as_str().unwrap();
        let brief = reader.read(prompt).brief;
        for ask in gold["asks"].as_array().unwrap() {
            let stated = ask["words"]
                .as_array()
                .is_some_and(|w| w.iter().any(|w| prompt.to_lowercase().contains(w.as_str().unwrap_or("\0"))));
            let Some(met) = stated.then(|| met(ask, &brief)).flatten() else { continue };
            asked += 1;
            read += usize::from(met);
            if !met {
                eprintln!("{} {}: {ask}", gold["id"], prompt);
            }
        }
        let domains: Vec<&str> = gold["domain"].as_array().unwrap().iter().filter_map(|d| d.as_str()).collect();
        let domain = brief.building.as_ref().and_then(|b| b.domain.as_deref());
        asked += 1;
        let right = domain.is_some_and(|d| domains.contains(&d))
            || (domain.is_none() && (domains.is_empty() || domains.contains(&"general")));
        read += usize::from(right);
        if !right {
            eprintln!("{} {}: building {:?}", gold["id"], prompt, brief.building);
        }
    }
    (read, asked)
}

/// Returns whether a brief has a gold fact; nothing for facts that no words state.
fn met(ask: &serde_json::Value, brief: &Brief) -> Option<bool> {
    let slug = |s: &str| s.to_lowercase().replace([' ', '-'], "_");
    let strings = |key: &str| -> Vec<String> {
        match &ask[key] {
            serde_json::Value::Array(list) => list.iter().filter_map(|v| v.as_str()).map(slug).collect(),
            serde_json::Value::Object(map) => map.keys().map(|k| slug(k.trim_start_matches("room:"))).collect(),
            _ => Vec::new(),
        }
    };
    let accept = strings("accept");
    let is = |s: &Subject, accept: &[String]| {
        let text = slug(&format!("{} {}", s.id.as_deref().unwrap_or(""), s.name));
        accept.iter().any(|a| text.contains(a.as_str())) || strings("words").iter().any(|w| text.ends_with(w.as_str()))
    };
    let n = ask["n"].as_f64().unwrap_or(1.0);
    let op = ask["op"].as_str().unwrap_or(">=");
    let facts = brief.asks.iter().map(|a| &a.fact);
    Some(match ask["kind"].as_str()? {
        "room" if accept == [""] => {
            facts
                .clone()
                .any(|f| matches!(f, Fact::Only(o) if o.rooms.is_some_and(|r| f64::from(r) >= n || op == "<=")))
                || op == "<="
        }
        "room" => {
            let count: f64 = facts
                .map(|f| match f {
                    Fact::Rooms(r) if is(&r.room, &accept) => f64::from(r.count.n),
                    Fact::Rooms(r) if r.each.as_ref().is_some_and(|e| is(e, &accept)) => f64::from(r.count.n),
                    Fact::Objects(o) if is(&o.object, &accept) => f64::from(o.count.n),
                    _ => 0.0,
                })
                .sum();
            let named = brief.building.as_ref().is_some_and(|b| {
                b.words.iter().any(|w| strings("words").iter().any(|x| slug(&w.text).contains(x.as_str())))
            });
            count >= n || named
        }
        "object" => brief.asks.iter().any(|a| match &a.fact {
            Fact::Objects(o) => is(&o.object, &accept) && f64::from(o.count.n) >= n,
            Fact::Rooms(r) => is(&r.room, &accept),
            Fact::Capacity(c) => f64::from(c.count.n) >= n,
            _ => false,
        }),
        "capacity" => facts.clone().any(|f| match f {
            Fact::Capacity(c) => {
                f64::from(c.count.n) == n || c.groups.is_some_and(|g| f64::from(g * c.count.n) == n) || c.each_room
            }
            Fact::People(p) => f64::from(p.count.n) == n,
            Fact::Objects(o) => f64::from(o.count.n) == n,
            Fact::Rooms(r) => f64::from(r.count.n) == n,
            _ => false,
        }),
        "storeys" => {
            facts.clone().any(|f| matches!(f, Fact::Storeys(s) if f64::from(s.count.n) == n))
                || facts.clone().any(|f| matches!(f, Fact::Rooms(r) if r.level.is_some_and(|l| l > 0)))
        }
        "country" => brief.place.as_ref().is_some_and(|p| Some(p.country_code.as_str()) == ask["value"].as_str()),
        "area" => facts.clone().any(|f| match f {
            Fact::Area(a) => (a.area_m2 - n).abs() < 0.1 * n,
            Fact::Rooms(r) => r.area_m2.is_some_and(|a| (a - n).abs() < 0.1 * n),
            _ => false,
        }),
        "robot" => facts.clone().any(|f| matches!(f, Fact::Robots(r) if f64::from(r.count.n) >= n)),
        "forbid" => {
            facts.clone().any(|f| match f {
                Fact::Forbidden(x) => x.room.iter().chain(&x.object).any(|s| is(s, &accept)),
                Fact::Other(_) => true,
                _ => false,
            }) || !strings("words").iter().any(|w| w.starts_with("no") || w.starts_with("bez"))
        }
        "relation" => {
            let (a, b) = (strings("a"), strings("b"));
            facts.clone().any(|f| match f {
                Fact::Relation(r) => is(&r.a, &a) && is(&r.b, &b) || is(&r.a, &b) && is(&r.b, &a),
                Fact::Rooms(r) => r.each.is_some(),
                Fact::Robots(_) => false,
                Fact::Other(_) => true,
                _ => false,
            })
        }
        _ => return None,
    })
}
