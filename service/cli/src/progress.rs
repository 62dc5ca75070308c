//! Progress on standard error: a moving line on a terminal, plain lines elsewhere.

use std::io::{self, IsTerminal};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Progress of making worlds.
pub struct Progress {
    bar: ProgressBar,
    plain: bool,
}

impl Progress {
    /// Returns the progress of `count` worlds.
    pub fn of(count: usize) -> Self {
        if !io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden(), plain: true };
        }
        let bar = if count == 1 { ProgressBar::new_spinner() } else { ProgressBar::new(count as u64) };
        let template = if count == 1 { "{spinner} {msg}" } else { "{bar:30} {pos} of {len} worlds, {eta} left  {msg}" };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar, plain: false }
    }

    /// Returns a progress that says nothing.
    pub fn silent() -> Self {
        Self { bar: ProgressBar::hidden(), plain: false }
    }

    /// Says something that matters, whatever the terminal.
    pub fn say(&self, what: &str) {
        if self.plain { eprintln!("{what}") } else { self.bar.println(what) }
    }

    /// Says what is being done now; terminals only.
    pub fn doing(&self, what: &str) {
        self.bar.set_message(what.to_owned());
    }

    /// Says that one thing is done.
    pub fn done(&self, what: &str) {
        if self.plain {
            eprintln!("{what}");
        }
    }

    /// Counts a finished world.
    pub fn count(&self) {
        self.bar.inc(1);
    }

    /// Clears the moving line.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
