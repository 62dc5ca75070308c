//! Words of twelve languages, read with the shipped lexicon and a few words of rooms.

use d3dgen_language::{Lexicon, Reading, TokenKind};

fn lexicon() -> Lexicon {
    let mut lexicon = Lexicon::shipped();
    for (language, value, phrases) in [
        ("en", "bedroom", &["bedroom", "master bedroom"][..]),
        ("en", "kitchen", &["kitchen"]),
        ("en", "waiting_area", &["waiting room"]),
        ("de", "meeting_room", &["Besprechungsraum"]),
        ("de", "kitchen", &["küche"]),
        ("de", "office", &["büro"]),
        ("fr", "waiting_area", &["salle d'attente"]),
        ("fr", "kitchen", &["cuisine"]),
        ("es", "bedroom", &["dormitorio"]),
        ("it", "kitchen", &["cucina"]),
        ("pt", "meeting_room", &["sala de reuniões"]),
        ("nl", "bedroom", &["slaapkamer"]),
        ("nl", "office", &["kantoor"]),
        ("pl", "bathroom", &["łazienka"]),
        ("pl", "kitchen", &["kuchnia"]),
        ("ru", "kitchen", &["кухня"]),
        ("ru", "bedroom", &["спальня"]),
        ("zh", "bedroom", &["卧室"]),
        ("zh", "kitchen", &["厨房"]),
        ("ja", "kitchen", &["キッチン", "台所"]),
        ("ja", "meeting_room", &["会議室"]),
        ("ko", "meeting_room", &["회의실"]),
    ] {
        phrases.iter().for_each(|p| lexicon.add(language, "room", value, p));
    }
    lexicon
}

/// Compares chunks: a number, `class.value` of the first sense, or the words themselves.
fn check(language: &str, text: &str, expected: &[&str]) {
    let lexicon = lexicon();
    let reading = lexicon.read(text);
    assert_eq!(reading.languages().first(), Some(&language), "{text}");
    let found: Vec<String> = reading.chunks().iter().map(|c| shown(&reading, c.tokens.start)).collect();
    assert_eq!(found, expected, "{text}");
}

fn shown(reading: &Reading, token: usize) -> String {
    let chunk = reading.chunks().iter().find(|c| c.tokens.start == token).expect("it begins a chunk");
    match (chunk.number, chunk.senses.iter().find(|s| s.class == "room").or(chunk.senses.first())) {
        (Some(number), _) => number.to_string(),
        (None, Some(sense)) => format!("{}.{}", sense.class, sense.value),
        (None, None) => chunk.text.clone(),
    }
}

#[test]
fn inflected_words_meet_their_entry() {
    check(
        "en",
        "two bedrooms and a kitchen",
        &["2", "room.bedroom", "particle.and", "particle.article", "room.kitchen"],
    );
    check("de", "drei Besprechungsräume", &["3", "room.meeting_room"]);
    check("de", "Kueche ohne Bueros", &["room.kitchen", "particle.no", "room.office"]);
    check("fr", "les salles d'attente", &["particle.article", "room.waiting_area"]);
    check("es", "cuatro dormitorios", &["4", "room.bedroom"]);
    check("it", "due cucine", &["2", "room.kitchen"]);
    check("pt", "duas salas de reunião", &["2", "room.meeting_room"]);
    check("nl", "vier slaapkamers zonder kantoren", &["4", "room.bedroom", "particle.no", "room.office"]);
    check("pl", "z łazienkami i kuchnią", &["particle.from", "room.bathroom", "particle.and", "room.kitchen"]);
    check("ru", "две спальни с кухней", &["2", "room.bedroom", "particle.from", "room.kitchen"]);
}

#[test]
fn scripts_without_spaces_are_taken_apart() {
    check("zh", "两间卧室和厨房", &["2", "classifier.place", "room.bedroom", "particle.and", "room.kitchen"]);
    check("ja", "会議室2つとキッチン", &["room.meeting_room", "2", "classifier.thing", "particle.and", "room.kitchen"]);
    check("ko", "회의실 3개와 로봇", &["room.meeting_room", "3", "classifier.thing", "particle.and", "robot.any"]);
}

#[test]
fn numbers_of_several_words() {
    let lexicon = lexicon();
    for (text, number) in [
        ("two hundred and ten people", 210.0),
        ("twenty-four beds", 24.0),
        ("1,200 people", 1200.0),
        ("1.5 million people", 1_500_000.0),
        ("einundzwanzig Betten", 21.0),
        ("zweihundert Plätze", 200.0),
        ("vijfentwintig bedden", 25.0),
        ("vingt-quatre lits", 24.0),
        ("soixante-quinze lits", 75.0),
        ("quatre-vingt-dix lits", 90.0),
        ("treinta y dos camas", 32.0),
        ("ventiquattro letti", 24.0),
        ("vinte e cinco camas", 25.0),
        ("dwadzieścia pięć łóżek", 25.0),
        ("двадцать пять коек", 25.0),
        ("三十二张床", 32.0),
        ("两百个座位", 200.0),
        ("百二十席", 120.0),
        ("서른두 명", 32.0),
        ("백이십 명", 120.0),
        ("1.200 m² Fläche mit Büro", 1200.0),
    ] {
        let reading = lexicon.read(text);
        assert_eq!(reading.chunks()[0].number, Some(number), "{text}: {:?}", reading.chunks());
    }
    // two numbers stay two
    let reading = lexicon.read("two 4 bed rooms");
    assert_eq!(reading.chunks()[..2].iter().map(|c| c.number).collect::<Vec<_>>(), [Some(2.0), Some(4.0)]);
}

#[test]
fn compounds_are_taken_apart_and_keep_their_place() {
    let lexicon = lexicon();
    let reading = lexicon.read("Ein Meisterbüro");
    let written: Vec<&str> = reading.chunks().iter().map(|c| reading.written(c.tokens.clone())).collect();
    assert_eq!(written, ["Ein", "Meister", "büro"]);
    assert!(reading.chunks()[2].is("room", "office"));
    assert!(reading.tokens()[2].joined);
    let reading = lexicon.read("zwei Vierbettzimmer");
    let numbers: Vec<Option<f64>> = reading.chunks().iter().map(|c| c.number).collect();
    assert_eq!(numbers, [Some(2.0), Some(4.0), None, None]);
}

#[test]
fn misspelled_words_are_mended_and_told() {
    let lexicon = lexicon();
    let reading = lexicon.read("3 bedrom flat with a kithcen");
    let meant: Vec<&str> = reading.misspellings().iter().map(|m| m.meant.as_str()).collect();
    assert_eq!(meant, ["bedroom", "kitchen"]);
    assert_eq!(&reading.text()[reading.misspellings()[0].bytes.clone()], "bedrom");
    // proper words stay what they are
    assert!(lexicon.read("a warden with a kitten").misspellings().is_empty());
}

#[test]
fn languages_are_told_apart_also_in_one_text() {
    let lexicon = lexicon();
    for (text, languages) in [
        ("Wir brauchen eine Küche. We need two bedrooms and a kitchen.", &["en", "de"][..]),
        ("una casa con cocina y dos dormitorios", &["es"]),
        ("um apartamento com cozinha e dois banheiros", &["pt"]),
        ("un appartement avec une cuisine", &["fr"]),
        ("un appartamento con una cucina e due bagni", &["it"]),
        ("een huis met drie slaapkamers", &["nl"]),
        ("東京の会議室", &["ja"]),
    ] {
        assert_eq!(lexicon.read(text).languages(), languages, "{text}");
    }
}

#[test]
fn languages_that_nobody_reads_are_named() {
    let lexicon = lexicon();
    for (text, name) in [
        ("kontor i København til 35 medarbejdere", Some("Danish")),
        ("kaksi makuuhuonetta ja keittiö", Some("Finnish")),
        ("شقة من غرفتين", Some("Arabic")),
        ("two bedrooms", None),
        ("drei Besprechungsräume", None),
    ] {
        assert_eq!(lexicon.read(text).unread(), name, "{text}");
    }
}

#[test]
fn any_text_is_read_and_every_token_is_in_one_chunk() {
    let lexicon = lexicon();
    // a small generator of its own: the same texts on every machine
    let mut state = 7u64;
    let mut random = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let words = [
        "two",
        "küche",
        "ё",
        "三十",
        "회의실",
        "1,2,3",
        "́",
        "\u{202e}",
        "🦀",
        "d'",
        "--",
        "m²",
        "\0",
        "４",
        "bedroooom",
        "\n",
        "; ",
        "ﷺ",
    ];
    for _ in 0..400 {
        let mut text = String::new();
        for _ in 0..random(40) {
            match random(3) {
                0 => text.push(char::from_u32(random(0x3_0000) as u32).unwrap_or('x')),
                1 => text.push(' '),
                _ => text.push_str(words[random(words.len() as u64) as usize]),
            }
        }
        let reading = lexicon.read(&text);
        let mut next = 0;
        for chunk in reading.chunks() {
            assert_eq!(chunk.tokens.start, next, "{text:?}");
            next = chunk.tokens.end;
        }
        assert_eq!(next, reading.tokens().len(), "{text:?}");
        for token in reading.tokens() {
            assert!(text.get(token.bytes.clone()).is_some_and(|t| !t.is_empty()), "{text:?}");
        }
        let alphabetic = text.char_indices().filter(|(_, c)| c.is_alphanumeric());
        for (at, _) in alphabetic {
            assert!(reading.tokens().iter().any(|t| t.bytes.contains(&at)), "{text:?} at {at}");
        }
    }
    assert_eq!(lexicon.read("a-b").tokens().iter().filter(|t| t.kind == TokenKind::Mark).count(), 0);
}
