//! Progress of an experiment: a bar on a terminal, otherwise a line for each run.

use std::io::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

/// Steps of the bar for one drive, whatever its number of keyframes.
const STEPS: u64 = 1_000;

/// The drives of an experiment.
pub(super) struct Progress {
    bar: ProgressBar,
    drives: u64,
    begun: Instant,
    ended: AtomicU64,
}

/// One drive.
pub(super) struct Drive<'a> {
    progress: &'a Progress,
    name: String,
    begun: Instant,
    keyframes: usize,
    heard: usize,
    steps: u64,
}

impl Progress {
    /// Starts a number of runs.
    pub fn new(drives: usize) -> Self {
        let drives = drives as u64;
        let bar = ProgressBar::new(drives * STEPS);
        let style = ProgressStyle::with_template("{msg:40} {wide_bar} {percent:>3} % {left:>12}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        // Extrapolates from the whole elapsed time: runs differ, and the bar's own estimate jumps with each of them.
        let left = |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let (done, whole) = (state.pos(), state.len().unwrap_or(0));
            let _ = write!(out, "{}", left(state.elapsed(), done, whole));
        };
        bar.set_style(style.with_key("left", left));
        bar.enable_steady_tick(Duration::from_millis(250));
        let progress = Self { bar, drives, begun: Instant::now(), ended: AtomicU64::new(0) };
        progress.tell(&format!("{drives} runs remaining"));
        progress
    }

    /// Starts one run.
    pub fn drive(&self, name: String, keyframes: usize) -> Drive<'_> {
        self.bar.set_message(name.clone());
        Drive { progress: self, name, begun: Instant::now(), keyframes, heard: 0, steps: 0 }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Writes a line where there is no terminal.
    fn tell(&self, line: &str) {
        if self.bar.is_hidden() {
            // A closed standard error is ignored: the results are written elsewhere.
            let _ = writeln!(std::io::stderr(), "{line}");
        }
    }
}

impl Drive<'_> {
    /// Counts a keyframe.
    pub fn keyframe(&mut self) {
        self.heard += 1;
        let steps = (self.heard as u64 * STEPS / self.keyframes.max(1) as u64).min(STEPS);
        self.progress.bar.inc(steps - self.steps);
        self.steps = steps;
    }

    /// Ends the run.
    pub fn end(self) {
        let Self { progress, name, begun, steps, .. } = self;
        progress.bar.inc(STEPS - steps);
        let ended = progress.ended.fetch_add(1, Ordering::Relaxed) + 1;
        let took = HumanDuration(begun.elapsed());
        let left = left(progress.begun.elapsed(), ended, progress.drives);
        progress.tell(&format!("{ended} of {}: {name}, {took}; {left}", progress.drives));
    }
}

/// Returns the estimated remaining time, at the average rate so far.
fn left(elapsed: Duration, done: u64, whole: u64) -> String {
    if done == 0 {
        return String::from("begun");
    }
    let left = elapsed.mul_f64(whole.saturating_sub(done) as f64 / done as f64);
    format!("{} left", HumanDuration(left))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_as_the_same_share_of_the_way_did() {
        let minute = Duration::from_mins(1);
        assert_eq!(left(minute, 0, 4), "begun");
        assert_eq!(left(minute, 1, 4), "3 minutes left");
        assert_eq!(left(minute, 4, 4), "0 seconds left");
    }

    #[test]
    fn a_drive_fills_its_part_of_the_bar_whatever_it_has_heard() {
        let progress = Progress::new(2);
        let mut drive = progress.drive(String::from("a"), 3);
        drive.keyframe();
        assert_eq!(progress.bar.position(), 333);
        for _ in 0..5 {
            drive.keyframe();
        }
        drive.end();
        progress.drive(String::from("b"), 7).end();
        assert_eq!(progress.bar.position(), 2 * STEPS);
    }
}
