//! `serve`: a folder of models on a server of its own, with a page that shows them.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Args;
use serde_json::json;

use crate::browser::server::Server;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::{count, plural};

/// Show the models of a folder in a browser
///
/// A server that answers range requests, so that .mlod files are read by need, and a page at / that
/// shows .mlod, .mlz and .mlq files. Ctrl-C ends it. Programs on this machine can read the folder,
/// and so can pages that a browser on it shows; hidden files are not served, nor what links lead
/// to outside.
#[derive(Args)]
pub struct Serve {
    /// Folder to serve
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Port to listen at; 0 is any that is free
    #[arg(long, value_name = "N", default_value_t = 8080)]
    port: u16,
    /// Address to listen at; 0.0.0.0 lets other machines in
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    host: IpAddr,
    /// End after so many seconds
    #[arg(long, value_name = "S", value_parser = seconds)]
    seconds: Option<Duration>,
}

/// True from the start of a server on; Ctrl-C then ends that first.
static IS_SERVING: AtomicBool = AtomicBool::new(false);
/// True if a server should end.
static STOP: AtomicBool = AtomicBool::new(false);

/// Makes a server that runs end, and returns true if there is one that was not told yet.
pub fn end() -> bool {
    IS_SERVING.load(Ordering::Relaxed) && !STOP.swap(true, Ordering::Relaxed)
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| *seconds >= 0.0);
    let time = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    time.ok_or_else(|| "must be a number of seconds".to_owned())
}

impl Serve {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if !self.folder.is_dir() {
            let reason = match self.folder.exists() {
                true => "is a file; name its folder",
                false => "no such folder",
            };
            return Err(Failure::at(&self.folder, reason));
        }
        let address = SocketAddr::new(self.host, self.port);
        let failed = |error| {
            let port = "; --port 0 takes one that is free";
            Failure::new(format_args!("cannot listen at {address}: {error}{port}"))
        };
        let server = Server::bind(&self.folder, address).map_err(failed)?;
        let url = format!("http://{}/", server.address().map_err(failed)?);
        session.tell(&format!("{} at {url}", files::name(&self.folder)));
        let start = Instant::now();
        STOP.store(false, Ordering::Relaxed);
        IS_SERVING.store(true, Ordering::Relaxed);
        server.run(self.seconds, &STOP);
        IS_SERVING.store(false, Ordering::Relaxed);
        let get = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let counts = server.counts();
        let [requests, bytes, errors] = [&counts.requests, &counts.bytes, &counts.errors].map(get);
        let text = format!(
            "{} request{}, {} bytes sent, {} error{}\n",
            count(requests as usize),
            plural(requests as usize),
            count(bytes as usize),
            count(errors as usize),
            plural(errors as usize),
        );
        let figures = json!({
            "folder": files::name(&self.folder),
            "url": url,
            "requests": requests,
            "bytes": bytes,
            "errors": errors,
            "serve_seconds": start.elapsed().as_secs_f64(),
        });
        Ok(Answer::new(figures, text))
    }
}
