//! Load on a server, from a process of its own: many clients that search (80 %), and retrieve rules or make a world of five
//! rooms (20 %). Prints times, errors, and the memory of the server.
//!
//! `cargo run --release -p d3dgen-server --example load -- http://127.0.0.1:50051 [--clients 64] [--seconds 60] [--pid PID]`

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use d3dgen_proto::v1::asset_service_client::AssetServiceClient;
use d3dgen_proto::v1::generate_world_request::Start;
use d3dgen_proto::v1::knowledge_service_client::KnowledgeServiceClient;
use d3dgen_proto::v1::world_service_client::WorldServiceClient;
use d3dgen_proto::v1::{
    BuildingRequest, GenerateWorldRequest, RetrieveConstraintsRequest, SearchAssetsRequest, SearchConstraintsRequest,
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
    let begun = Instant::now();
    let until = begun + Duration::from_secs(seconds);
    let mut all = Vec::new();
    for n in 0..clients {
        let channel = Endpoint::new(url.clone())?.connect().await?;
        all.push(tokio::spawn(client(n, channel, until)));
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
            "{kind:<9} {:>6} calls  p50 {:>7.1} ms  p99 {:>7.1} ms  most {:>7.1} ms",
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

async fn client(n: u64, channel: Channel, until: Instant) -> Seen {
    let mut knowledge = KnowledgeServiceClient::new(channel.clone());
    let mut assets = AssetServiceClient::new(channel.clone());
    let mut worlds = WorldServiceClient::new(channel).max_decoding_message_size(64 << 20);
    let (mut times, mut errors): Seen = Default::default();
    let mut turn = n;
    while Instant::now() < until {
        turn += 1;
        let begun = Instant::now();
        let (kind, answer) = match turn % 10 {
            8 => {
                let asked = RetrieveConstraintsRequest {
                    domain_id: Some("hospital".into()),
                    country_code: Some("DE".into()),
                    room_labels: vec!["patient room".into(), "corridor".into(), "office".into()],
                    ..Default::default()
                };
                ("retrieve", knowledge.retrieve_constraints(asked).await.map(drop))
            }
            9 => ("generate", world(&mut worlds, turn * 1000 + n).await),
            odd if odd % 2 == 1 => {
                let query = THINGS[turn as usize / 2 % THINGS.len()].into();
                let asked = SearchAssetsRequest { query, page_size: 10, ..Default::default() };
                ("search", assets.search_assets(asked).await.map(drop))
            }
            _ => {
                let query = QUESTIONS[turn as usize / 2 % QUESTIONS.len()].into();
                let asked = SearchConstraintsRequest { query, page_size: 10, ..Default::default() };
                ("search", knowledge.search_constraints(asked).await.map(drop))
            }
        };
        match answer {
            Ok(()) => times.entry(kind).or_default().push(begun.elapsed().as_secs_f64() * 1000.0),
            Err(status) => {
                *errors.entry((kind, format!("{:?}", status.code()))).or_default() += 1;
                if status.code() == Code::ResourceExhausted {
                    tokio::time::sleep(Duration::from_millis(500)).await; // as the answer asks
                }
            }
        }
    }
    (times, errors)
}

async fn world(worlds: &mut WorldServiceClient<Channel>, seed: u64) -> Result<(), Status> {
    let prompt = "apartment with a kitchen, a bathroom, a living room and two bedrooms".into();
    let building = BuildingRequest { prompt, seed, ..Default::default() };
    let asked = GenerateWorldRequest { start: Some(Start::Building(building)), ..Default::default() };
    let mut stream = worlds.generate_world(asked).await?.into_inner();
    while stream.message().await?.is_some() {}
    Ok(())
}

/// Returns the resident memory of a process, MB; 0 where the system does not tell.
fn resident_mb(pid: u64) -> f64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:")).unwrap_or("0");
    line.split_whitespace().next().and_then(|kb| kb.parse::<f64>().ok()).unwrap_or_default() / 1024.0
}
