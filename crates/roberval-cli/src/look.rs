//! What a terminal is shown beyond the plain text: colours, and that work goes on.

use std::env;
use std::io::{self, IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Work of less than this needs no word.
const PATIENCE: Duration = Duration::from_secs(1);

/// How the command looks.
#[derive(Debug, Clone, Copy, Default)]
pub struct Look {
    /// Tables on the standard output are coloured.
    pub colour: bool,
    /// Long work says on the standard error that it goes on.
    pub progress: bool,
}

impl Look {
    /// Colours and progress where someone looks: a terminal, `NO_COLOR` not set.
    #[must_use]
    pub fn of_terminal() -> Self {
        let set = |name: &str| env::var_os(name).is_some_and(|value| !value.is_empty());
        let dumb = env::var_os("TERM").is_some_and(|term| term == "dumb");
        Self {
            colour: io::stdout().is_terminal() && !set("NO_COLOR") && !dumb,
            progress: io::stderr().is_terminal() && !dumb,
        }
    }

    /// Does the work, and says each second that it goes on.
    pub(crate) fn during<T>(self, work: impl FnOnce() -> T) -> T {
        let clock = self.progress.then(Clock::start).flatten();
        let result = work();
        drop(clock);
        result
    }
}

/// A line on the standard error that counts seconds until it is dropped.
struct Clock {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Clock {
    /// `None` where there is no thread to be had: nothing is lost.
    fn start() -> Option<Self> {
        let (stop, stopped) = channel();
        let count = move || {
            let start = Instant::now();
            let mut shown = false;
            while stopped.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown = true;
                let seconds = start.elapsed().as_secs();
                // A closed standard error must not stop the work. The cursor goes back, so that
                // what is said meanwhile replaces the line.
                let _ = write!(io::stderr(), "roberval: working, {seconds} s\r");
            }
            if shown {
                let _ = write!(io::stderr(), "\r\x1b[K");
            }
        };
        let thread = Builder::new().spawn(count).ok()?;
        Some(Self {
            stop: Some(stop),
            thread: Some(thread),
        })
    }
}

impl Drop for Clock {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
