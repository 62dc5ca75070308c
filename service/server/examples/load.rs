//! Load on a server, from a process of its own: many clients that search (half of the calls), retrieve rules, classify
//! prompts, make scene graphs and small worlds, check worlds, and amend rules where that is asked for. Prints times by call,
//! errors, and the memory of the server.
//!
//! `cargo run --release -p d3dgen-server --example load -- http://127.0.0.1:50051 [--clients 64] [--seconds 60] [--pid PID]
//! [--amending 0]`; so many of the clients do nothing but amend.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use d3dgen_proto::v1::amend_knowledge_request::Change;
use d3dgen_proto::v1::asset_service_client::AssetServiceClient;
use d3dgen_proto::v1::domain_service_client::DomainServiceClient;
use d3dgen_proto::v1::generate_world_request::Start;
use d3dgen_proto::v1::generate_world_response::Event;
use d3dgen_proto::v1::knowledge_service_client::KnowledgeServiceClient;
use d3dgen_proto::v1::world_service_client::WorldServiceClient;
use d3dgen_proto::v1::{
    AmendKnowledgeRequest, BuildingRequest, CheckWorldRequest, ClassifyDomainRequest, GenerateSceneGraphRequest,
    GenerateWorldRequest, RetrieveConstraintsRequest, RuleSentence, SearchAssetsRequest, SearchConstraintsRequest,
    World,
};
use tonic::transport::{Channel, Endpoint};
use tonic::{Code, Status};

const QUESTIONS: [&str; 8] = [
    "corridor width",
    "door clear width for wheelchairs",
    "Raumhöhe",
    "toilet for visitors",
    "patient room area",
    "daylight in offices",
    "stairs handrail",
    "robot docking station",
];
const THINGS: [&str; 6] = ["office chair", "hospital bed", "lamp on a desk", "shelf under 1 m", "sink", "whiteboard"];

/// What one client saw: milliseconds by kind of call, and errors by kind and code.
type Seen = (BTreeMap<&'static str, Vec<f64>>, BTreeMap<(&'static str, String), u64>);

#[tokio::main]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let url = words.first().ok_or("name the address of a server")?.clone();
    let option = |name: &str, usual: u64| {
        let at = words.iter().position(|w| w == name).and_then(|i| words.get(i + 1));
        at.map_or(Ok(usual), |v| v.parse())
    };
    let (clients, seconds, pid) = (option("--clients", 64)?, option("--seconds", 60)?, option("--pid", 0)?);
    let amending = option("--amending", 0)?;
    let first = Endpoint::new(url.clone())?.connect().await?;
    let made = world(&mut WorldServiceClient::new(first).max_decoding_message_size(64 << 20), 1).await?;
    let made = made.ok_or("the server made no world to check")?;
    let begun = Instant::now();
    let until = begun + Duration::from_secs(seconds);
    let mut all = Vec::new();
    for n in 0..clients {
        let channel = Endpoint::new(url.clone())?.connect().await?;
        all.push(match n < amending {
            true => tokio::spawn(amend(n, channel, until)),
            false => tokio::spawn(client(n, channel, until, made.clone())),
        });
    }
    let mut memory = Vec::new();
    while Instant::now() < until {
        memory.push(resident_mb(pid));
        tokio::time::sleep(Duration::from_secs(5).min(until.saturating_duration_since(Instant::now()))).await;
    }
    let (mut times, mut errors): Seen = Default::default();
    for client in all {
        let (own, wrong) = client.await?;
        own.into_iter().for_each(|(kind, ms)| times.entry(kind).or_default().extend(ms));
        wrong.into_iter().for_each(|(key, n)| *errors.entry(key).or_default() += n);
    }
    memory.push(resident_mb(pid));
    println!("{clients} clients for {:.0} s", begun.elapsed().as_secs_f64());
    for (kind, ms) in &mut times {
        ms.sort_by(f64::total_cmp);
        let at = |share: f64| ms[((ms.len() - 1) as f64 * share) as usize];
        println!(
            "{kind:<20} {:>6} calls  p50 {:>7.1} ms  p99 {:>7.1} ms  most {:>7.1} ms",
            ms.len(),
            at(0.5),
            at(0.99),
            at(1.0)
        );
    }
    println!("errors: {errors:?}");
    println!("memory of the server, MB: {memory:.0?}");
    Ok(())
}

const PROMPT: &str = "apartment with a kitchen, a bathroom, a living room and two bedrooms";

async fn client(n: u64, channel: Channel, until: Instant, made: World) -> Seen {
    let mut knowledge = KnowledgeServiceClient::new(channel.clone());
    let mut assets = AssetServiceClient::new(channel.clone());
    let mut domains = DomainServiceClient::new(channel.clone());
    let mut worlds = WorldServiceClient::new(channel).max_decoding_message_size(64 << 20);
    let mut seen = Seen::default();
    let mut turn = n;
    while Instant::now() < until {
        turn += 1;
        let begun = Instant::now();
        let building = BuildingRequest { prompt: PROMPT.into(), seed: turn * 1000 + n, ..Default::default() };
        let (kind, answer) = match turn % 20 {
            1 | 11 => {
                let asked = RetrieveConstraintsRequest {
                    domain_id: Some("hospital".into()),
                    country_code: Some("DE".into()),
                    room_labels: vec!["patient room".into(), "corridor".into(), "office".into()],
                    ..Default::default()
                };
                ("RetrieveConstraints", knowledge.retrieve_constraints(asked).await.map(drop))
            }
            3 | 13 => {
                let asked = ClassifyDomainRequest { prompt: PROMPT.into(), ..Default::default() };
                ("ClassifyDomain", domains.classify_domain(asked).await.map(drop))
            }
            5 | 15 => {
                let asked = GenerateSceneGraphRequest { building: Some(building) };
                ("GenerateSceneGraph", worlds.generate_scene_graph(asked).await.map(drop))
            }
            7 | 17 => {
                let asked = CheckWorldRequest { world: Some(made.clone()) };
                ("CheckWorld", worlds.check_world(asked).await.map(drop))
            }
            9 | 19 => ("GenerateWorld", world(&mut worlds, building.seed).await.map(drop)),
            odd if odd % 4 == 0 => {
                let query = THINGS[turn as usize / 2 % THINGS.len()].into();
                let asked = SearchAssetsRequest { query, page_size: 10, ..Default::default() };
                ("SearchAssets", assets.search_assets(asked).await.map(drop))
            }
            _ => {
                let query = QUESTIONS[turn as usize / 2 % QUESTIONS.len()].into();
                let asked = SearchConstraintsRequest { query, page_size: 10, ..Default::default() };
                ("SearchConstraints", knowledge.search_constraints(asked).await.map(drop))
            }
        };
        note(&mut seen, kind, begun, answer).await;
    }
    seen
}

/// Amends rules for as long as it may.
async fn amend(n: u64, channel: Channel, until: Instant) -> Seen {
    let mut knowledge = KnowledgeServiceClient::new(channel);
    let mut seen = Seen::default();
    let mut turn = 0;
    while Instant::now() < until {
        turn += 1;
        let begun = Instant::now();
        let text = format!("Corridors are at least {}.{:02} m wide.", 2 + n % 3, turn % 100);
        let change = Some(Change::Sentence(RuleSentence { text, language: None }));
        let asked = AmendKnowledgeRequest { domain_id: "hospital".into(), change, ..Default::default() };
        let answer = knowledge.amend_knowledge(asked).await.map(drop);
        note(&mut seen, "AmendKnowledge", begun, answer).await;
    }
    seen
}

/// Notes what came of a call, and waits where the answer asks for it.
async fn note((times, errors): &mut Seen, kind: &'static str, begun: Instant, answer: Result<(), Status>) {
    match answer {
        Ok(()) => times.entry(kind).or_default().push(begun.elapsed().as_secs_f64() * 1000.0),
        Err(status) => {
            *errors.entry((kind, format!("{:?}", status.code()))).or_default() += 1;
            if status.code() == Code::ResourceExhausted {
                tokio::time::sleep(Duration::from_millis(500)).await;
            }
        }
    }
}

/// Makes a world.
async fn world(worlds: &mut WorldServiceClient<Channel>, seed: u64) -> Result<Option<World>, Status> {
    let building = BuildingRequest { prompt: PROMPT.into(), seed, ..Default::default() };
    let asked = GenerateWorldRequest { start: Some(Start::Building(building)), ..Default::default() };
    let mut stream = worlds.generate_world(asked).await?.into_inner();
    let mut made = None;
    while let Some(news) = stream.message().await? {
        if let Some(Event::World(checked)) = news.event {
            made = checked.world;
        }
    }
    Ok(made)
}

/// Returns the resident memory of a process, MB; 0 where the system does not tell.
fn resident_mb(pid: u64) -> f64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:")).unwrap_or("0");
    line.split_whitespace().next().and_then(|kb| kb.parse::<f64>().ok()).unwrap_or_default() / 1024.0
}
