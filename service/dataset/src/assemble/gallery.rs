//! The gallery: one page with small plans of some worlds and filters over what the index says of them. It opens from a folder,
//! without a server.

use std::collections::BTreeMap;
use std::io::Read;

use serde_json::{Value, json};

use crate::row::Row;
use crate::shelf::Stored;

const PAGE: &str = include_str!("gallery.html");
/// Gap between storeys that are drawn side by side, cm.
const GAP_CM: i64 = 200;

/// Worlds of the gallery.
#[derive(Debug, Default)]
pub struct Gallery(Vec<Value>);

impl Gallery {
    /// Adds a world, where it has a plan.
    pub fn add(&mut self, key: &str, split: &str, shard: &str, stored: &Stored) {
        let Some(plan) = plan(stored) else { return };
        let Row { prompt, seed, domain, kind, country, rooms, figures, .. } = &stored.row;
        let figure = |name: &str| figures.get(name).copied();
        self.0.push(json!({
            "key": key, "split": split, "shard": shard, "prompt": prompt, "seed": seed, "kind": kind.as_ref().unwrap_or(domain),
            "country": country, "rooms": rooms, "area": figure("net_area_m2"), "objects": figure("objects"), "plan": plan,
        }));
    }

    /// Returns the page.
    pub fn page(&self, title: &str, worlds: u64) -> String {
        // nothing in the data may end the script or begin a comment in it
        let safe = |value: &Value| value.to_string().replace('<', "\\u003c");
        let about = json!({ "title": title, "worlds": worlds });
        PAGE.replace("\"@ABOUT@\"", &safe(&about)).replace("\"@WORLDS@\"", &safe(&Value::Array(self.0.clone())))
    }
}

/// Returns the outlines of rooms and the doors of a world in cm, storeys side by side.
fn plan(stored: &Stored) -> Option<Value> {
    let document = |name: &str| {
        let (_, bytes) = stored.members.iter().find(|(ext, _)| ext == name)?;
        let mut text = Vec::new();
        flate2::read::GzDecoder::new(bytes.as_slice()).read_to_end(&mut text).ok()?;
        serde_json::from_slice::<Value>(&text).ok()
    };
    let plan =
        document("world.json.gz").map(|mut w| w["floorplan"].take()).or_else(|| document("floorplan.json.gz"))?;
    let rooms = plan["rooms"].as_array()?;
    let cm = |v: &Value| (v.as_f64().unwrap_or(0.0) * 100.0).round() as i64;
    let level = |room: &Value| room["level"].as_i64().unwrap_or(0);
    let corners = |room: &Value| -> Vec<[i64; 2]> {
        room["polygon"].as_array().into_iter().flatten().map(|p| [cm(&p["x"]), cm(&p["y"])]).collect()
    };
    let mut spans: BTreeMap<i64, (i64, i64)> = BTreeMap::new();
    for room in rooms {
        let span = spans.entry(level(room)).or_insert((i64::MAX, i64::MIN));
        for [x, _] in corners(room) {
            *span = (span.0.min(x), span.1.max(x));
        }
    }
    let mut shifts = BTreeMap::new();
    let mut right = 0;
    for (level, (from, to)) in &spans {
        shifts.insert(*level, right - from);
        right += to - from + GAP_CM;
    }
    let shift = |l: i64| shifts.get(&l).copied().unwrap_or(0);
    let drawn = rooms.iter().map(|room| {
        let points: Vec<[i64; 2]> = corners(room).into_iter().map(|[x, y]| [x + shift(level(room)), y]).collect();
        json!([room["room_type"], points])
    });
    Some(Value::Array(drawn.collect()))
}
