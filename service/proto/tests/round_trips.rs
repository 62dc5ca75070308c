//! Documents that exist go through their messages and come back as they were: every shipped domain and knowledge base,
//! the documents of worlds of several domains, and what is known of every asset of the library.

use std::sync::Arc;
use std::time::Instant;

use d3dgen_assets::annotation::Annotation;
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::library::Library;
use d3dgen_model::Document;
use d3dgen_model::domain::Domain;
use d3dgen_model::seed::Stream;
use d3dgen_pipeline::generate::{Settings, generate_world};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_plugins::Registry;
use d3dgen_proto::convert::{self, Contract, from_message, from_proto, to_message, to_proto};
use d3dgen_proto::v1;
use prost::Message;

/// Sends a document through its message, as bytes on a wire, and compares what comes back.
fn round_trip<D: Contract + PartialEq + std::fmt::Debug>(document: &D) {
    let message = to_proto(document).unwrap_or_else(|e| panic!("{}: {e}", D::KIND));
    let sent = D::Message::decode(message.encode_to_vec().as_slice()).expect("just written");
    let back: D = from_proto(&sent).unwrap_or_else(|e| panic!("{}: {e}", D::KIND));
    // messages do not tell a negative zero from zero
    let text = |document: &D| document.to_json().replace(": -0.0", ": 0.0");
    let (found, wanted) = (text(&back), text(document));
    if let Some((found, wanted)) = found.lines().zip(wanted.lines()).find(|(a, b)| a != b) {
        panic!("{}: {found} instead of {wanted}", D::KIND);
    }
    assert!(back == *document && found == wanted, "{} is not what it was", D::KIND);
}

#[test]
fn domains_and_knowledge_bases() {
    let registry = Registry::builtin();
    assert!(registry.iter().count() >= 6);
    for plugin in registry.iter() {
        // what others lend it is no part of its document
        round_trip(&Domain { lent: Arc::default(), ..plugin.domain().clone() });
        round_trip(plugin.knowledge());
    }
}

#[test]
fn documents_of_worlds() {
    let registry = Registry::builtin();
    for prompt in [
        "two-bedroom flat in Germany, for a cleaning robot",
        "hospital ward with 8 rooms in Germany, for a delivery robot",
        "office for 12 people in New York with two meeting rooms",
        "primary school with four classrooms, wheelchair access, no canteen",
        "warehouse with a loading dock, an office and charging for two robots",
    ] {
        let request = Request { prompt: prompt.into(), seed: 3, ..Default::default() };
        let made = generate_world(&request, &registry, &Settings::default(), &mut |_| {}, &false.into()).unwrap();
        round_trip(&made.world.scene_graph);
        round_trip(&made.world.floorplan);
        round_trip(&made.world.placements);
        round_trip(&made.world.scenario);
        round_trip(&made.world);
        round_trip(&made.report);
    }
}

#[test]
fn annotations_of_the_library() {
    let registry = Registry::builtin();
    let catalog = Catalog::new(registry.iter().map(|p| p.domain()));
    let library = Library::new(&catalog);
    for asset in library.assets() {
        let annotation = asset.annotation(&catalog);
        let message: v1::AssetAnnotation = to_message(&annotation).unwrap();
        let back: Annotation = from_message(&message).unwrap();
        assert_eq!(back, annotation);
    }
}

#[test]
fn a_world_takes_milliseconds() {
    let request = Request { prompt: "hospital ward with 10 rooms in Germany".into(), ..Default::default() };
    let registry = Registry::builtin();
    let world = generate_world(&request, &registry, &Settings::default(), &mut |_| {}, &false.into()).unwrap().world;
    let message = to_proto(&world).unwrap(); // reads the plan
    let best = |mut act: Box<dyn FnMut()>| {
        let times = (0..10).map(|_| {
            let begun = Instant::now();
            act();
            begun.elapsed()
        });
        times.min().unwrap_or_default()
    };
    let (one, sent) = (world.clone(), message.clone());
    let out = best(Box::new(move || assert!(to_proto(&one).is_ok())));
    let shape = best(Box::new(move || assert!(convert::value(&sent).is_ok())));
    let back = best(Box::new(move || assert!(from_proto::<d3dgen_model::world::World>(&message).is_ok())));
    println!(
        "{} objects, {} KB of JSON: to the message {out:?}, to JSON {shape:?}, to the checked document {back:?}",
        world.placements.placements.len(),
        world.to_json().len() / 1024
    );
    assert!(out.as_millis() < 100 && shape.as_millis() < 100, "a document takes milliseconds, not {out:?}, {shape:?}");
}

#[test]
fn changed_bytes_are_refused_or_read_and_never_break_the_reader() {
    let request = Request { prompt: "flat with four rooms".into(), ..Default::default() };
    let registry = Registry::builtin();
    let world = generate_world(&request, &registry, &Settings::default(), &mut |_| {}, &false.into()).unwrap().world;
    let whole = to_proto(&world).unwrap().encode_to_vec();
    let knowledge = to_proto(registry.get("office").unwrap().knowledge()).unwrap().encode_to_vec();
    let mut chance = Stream::new(7, "changed_bytes");
    let (mut read, mut refused) = (0, 0);
    for round in 0..400 {
        let mut bytes = if round % 4 == 0 { knowledge.clone() } else { whole.clone() };
        for _ in 0..=chance.below(3) {
            let at = chance.below(bytes.len());
            bytes[at] = u8::try_from(chance.below(256)).unwrap();
        }
        if round % 5 == 0 {
            bytes.truncate(chance.below(bytes.len()));
        }
        let outcome = if round % 4 == 0 {
            v1::KnowledgeBase::decode(bytes.as_slice()).ok().map(|m| convert::value(&m).is_ok())
        } else {
            v1::World::decode(bytes.as_slice()).ok().map(|m| convert::value(&m).is_ok())
        };
        match outcome {
            Some(true) => read += 1,
            Some(false) | None => refused += 1,
        }
    }
    assert!(read > 20 && refused > 20, "{read} read, {refused} refused: the changes try little");
}
