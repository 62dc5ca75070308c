//! How long each stage of a world takes, all attempts together.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use d3dgen_pipeline::generate::{Event, Stage};

/// Time spent in each stage.
#[derive(Default)]
pub struct StageClock {
    begun: Option<Instant>,
    last: Duration,
    spent: [Duration; Stage::ALL.len()],
}

impl StageClock {
    /// Hears that a stage begins or ends.
    pub fn hear(&mut self, event: &Event<'_>) {
        match event {
            Event::Started(..) => self.begun = Some(Instant::now()),
            Event::Finished(stage, ..) => {
                if let Some(begun) = self.begun.take() {
                    self.last = begun.elapsed();
                    self.spent[*stage as usize] += self.last;
                }
            }
            Event::Furnished(..) => {}
            Event::Rejected(..) => self.begun = None,
        }
    }

    /// Returns how long the stage that ended last took.
    pub fn last(&self) -> Duration {
        self.last
    }

    /// Returns the stages in order, with the time of each.
    pub fn times(&self) -> Vec<(&'static str, Duration)> {
        Stage::ALL.iter().map(|s| (s.name(), self.spent[*s as usize])).collect()
    }

    /// Returns the times of the stages that ran, ms to the microsecond, as worlds are measured with.
    pub fn stage_ms(&self) -> BTreeMap<String, f64> {
        let ran = self.times().into_iter().filter(|(_, time)| !time.is_zero());
        ran.map(|(stage, time)| (stage.to_owned(), (time.as_secs_f64() * 1e6).round() / 1e3)).collect()
    }
}
