//! A server of the files in a folder, with ranges, for pages that read levels by need.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `mod`, `connection` | who is listened to, and for how long |
//! | `head`, `range` | what is asked |
//! | `folder`, `answer` | what is sent |
//!
//! It reads the head of a request by `httparse`, and needs neither a runtime nor tasks: a thread
//! has a connection, and few connections come from one browser.

mod answer;
mod connection;
mod folder;
mod head;
mod range;
#[cfg(test)]
mod tests;

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use folder::Folder;

/// Connections at a time; a browser opens six.
const MOST_CONNECTIONS: usize = 64;
/// Time between two looks at whether the server should end.
const PAUSE: Duration = Duration::from_millis(10);

/// Requests and bytes of a server so far.
#[derive(Debug, Default)]
pub struct ServerCounts {
    /// Requests that were answered.
    pub requests: AtomicU64,
    /// Bytes of the bodies that were sent.
    pub bytes: AtomicU64,
    /// Requests that were answered with an error, or could not be answered.
    pub errors: AtomicU64,
}

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    folder: Arc<Folder>,
    counts: Arc<ServerCounts>,
    open: Arc<AtomicUsize>,
}

impl Server {
    /// Listens at an address for requests of the files in a folder; port 0 is any that is free.
    ///
    /// # Errors
    /// A folder that is missing, and a port that is taken or may not be used.
    pub fn bind(folder: &Path, address: SocketAddr) -> io::Result<Self> {
        let folder = Arc::new(Folder::open(folder)?);
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, folder, counts: Arc::default(), open: Arc::default() })
    }

    /// Returns the address at which the server listens.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Returns what the server has done so far.
    pub fn counts(&self) -> &ServerCounts {
        &self.counts
    }

    /// Answers requests until the time is over, if there is a limit, or `stop` is set.
    pub fn run(&self, limit: Option<Duration>, stop: &AtomicBool) {
        let start = Instant::now();
        while !stop.load(Ordering::Relaxed) && limit.is_none_or(|limit| start.elapsed() < limit) {
            match self.listener.accept() {
                Ok((stream, _)) => self.attend(stream),
                // Nobody is there, or whoever was has gone, or there are no descriptors left.
                Err(_) => thread::sleep(PAUSE),
            }
        }
    }

    /// Answers the requests of a connection on a thread of its own.
    fn attend(&self, stream: TcpStream) {
        if stream.set_nonblocking(false).is_err() {
            return;
        }
        let guard = OpenConnection::new(&self.open);
        if self.open.load(Ordering::Relaxed) > MOST_CONNECTIONS {
            self.counts.errors.fetch_add(1, Ordering::Relaxed);
            return connection::refuse(stream);
        }
        let (folder, counts) = (Arc::clone(&self.folder), Arc::clone(&self.counts));
        let spawned = thread::Builder::new().name("connection".into()).spawn(move || {
            let _guard = guard;
            connection::serve(stream, &folder, &counts);
        });
        if spawned.is_err() {
            self.counts.errors.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Counts a connection while it is open.
struct OpenConnection(Arc<AtomicUsize>);

impl OpenConnection {
    fn new(open: &Arc<AtomicUsize>) -> Self {
        open.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(open))
    }
}

impl Drop for OpenConnection {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}
