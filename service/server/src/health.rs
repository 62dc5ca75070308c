//! What is well and what is not: store, indexes, lanes. Told on pages, over gRPC health and in the log, and looked at every
//! second by [`watch`], which also logs work that is older than its deadline.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tonic_health::ServingStatus;
use tonic_health::server::HealthReporter;

use crate::core::Core;
use crate::grpc;
use crate::pool::{Lane, Overdue};

/// Time between two looks.
const EVERY: Duration = Duration::from_secs(1);

/// What is well; where it is not, why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Health {
    /// Whether changes can be stored; what is stored can be read either way.
    pub store: Result<(), String>,
    /// Whether searches are answered.
    pub index: Result<(), String>,
    /// Whether work is begun.
    pub lanes: Result<(), String>,
}

/// The names of the parts in gRPC health, beside the services.
const PARTS: [&str; 3] = ["store", "index", "lanes"];
/// Services that cannot answer much without their index.
const SEARCHED: [&str; 2] = ["d3dgen.v1.KnowledgeService", "d3dgen.v1.AssetService"];

impl Health {
    /// Looks at everything. May touch the disk: not for threads that answer calls.
    pub fn of(core: &Core, overdue: &[Overdue]) -> Self {
        let store = core.databases.check_writable().map_err(|e| e.to_string());
        let index = if core.databases.is_indexed() { Ok(()) } else { Err("is being made".to_owned()) };
        let stuck = core.pool.stuck(overdue);
        let names: Vec<&str> = stuck.iter().map(|lane: &Lane| lane.name()).collect();
        let lanes = match names.as_slice() {
            [] => Ok(()),
            names => Err(format!("stuck: {}", names.join(", "))),
        };
        Self { store, index, lanes }
    }

    /// Returns true when the process does what it can: another start would help nothing.
    pub fn is_live(&self) -> bool {
        self.lanes.is_ok()
    }

    /// Returns true when every call is answered.
    pub fn is_ready(&self) -> bool {
        self.parts().into_iter().all(|(_, part)| part.is_ok())
    }

    /// Returns a line for each part.
    pub fn text(&self) -> String {
        let line = |(name, part): (&str, &Result<(), String>)| match part {
            Ok(()) => format!("{name}: ok\n"),
            Err(reason) => format!("{name}: {reason}\n"),
        };
        self.parts().map(line).concat()
    }

    fn parts(&self) -> [(&'static str, &Result<(), String>); PARTS.len()] {
        let [store, index, lanes] = PARTS;
        [(store, &self.store), (index, &self.index), (lanes, &self.lanes)]
    }

    /// Returns whether a name of gRPC health is well; the empty one is the whole server.
    fn serves(&self, name: &str) -> bool {
        match self.parts().into_iter().find(|(part, _)| *part == name) {
            Some((_, part)) => part.is_ok(),
            None if name.is_empty() => self.is_ready(),
            None => self.lanes.is_ok() && (self.index.is_ok() || !SEARCHED.contains(&name)),
        }
    }

    /// Tells gRPC health.
    async fn report(&self, reporter: &HealthReporter) {
        for name in PARTS.into_iter().chain(grpc::NAMES).chain([""]) {
            let status = if self.serves(name) { ServingStatus::Serving } else { ServingStatus::NotServing };
            reporter.set_service_status(name, status).await;
        }
    }
}

/// Tells gRPC health that nothing is answered any more.
pub async fn report_stop(reporter: &HealthReporter) {
    for name in PARTS.into_iter().chain(grpc::NAMES).chain([""]) {
        reporter.set_service_status(name, ServingStatus::NotServing).await;
    }
}

/// Looks at everything now, tells gRPC health, and keeps it for the pages.
pub async fn look(core: &Arc<Core>, reporter: &HealthReporter) {
    let overdue = core.pool.overdue();
    for late in overdue.iter().filter(|late| late.is_new) {
        let (method, request_id, lane, s) = (&late.method, &late.request_id, late.lane.name(), late.time.as_secs_f64());
        tracing::error!(%request_id, %method, lane, s, "work goes on after the deadline of its call");
    }
    core.metrics.overdue.store(i64::try_from(overdue.len()).unwrap_or(i64::MAX), Ordering::Relaxed);
    let asked = Arc::clone(core);
    let Ok(found) = tokio::task::spawn_blocking(move || Health::of(&asked, &overdue)).await else { return };
    let before = core.health.swap(Arc::new(found.clone()));
    if *before != found {
        match found.is_ready() {
            true => tracing::info!("everything is answered"),
            false => tracing::warn!(health = found.text().trim().replace('\n', ", "), "not everything is answered"),
        }
    }
    found.report(reporter).await;
}

/// Looks every second, for as long as it runs.
pub async fn watch(core: Arc<Core>, reporter: HealthReporter) {
    loop {
        tokio::time::sleep(EVERY).await;
        look(&core, &reporter).await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_says_what_it_keeps_from_being_answered() {
        let well = Health { store: Ok(()), index: Ok(()), lanes: Ok(()) };
        assert!(well.is_live() && well.is_ready() && well.serves("") && well.serves("d3dgen.v1.WorldService"));
        let full = Health { store: Err("no room".into()), ..well.clone() };
        assert!(full.is_live() && !full.is_ready() && !full.serves("store") && !full.serves(""));
        assert!(full.serves("d3dgen.v1.WorldService"), "reading goes on");
        assert_eq!(full.text(), "store: no room\nindex: ok\nlanes: ok\n");
        let early = Health { index: Err("is being made".into()), ..well.clone() };
        assert!(!early.serves("d3dgen.v1.AssetService") && early.serves("d3dgen.v1.WorldService"));
        let stuck = Health { lanes: Err("stuck: work".into()), ..well };
        assert!(!stuck.is_live() && !stuck.serves("d3dgen.v1.WorldService"));
    }
}
