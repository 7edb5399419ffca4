//! A connection: requests one after the other, each within a time.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::ServerCounts;
use super::answer::{Response, answer};
use super::folder::Folder;
use super::head::{Head, Parsed, parse};

/// Time for the head of a request, from the end of the answer before.
const HEAD_TIME: Duration = Duration::from_secs(15);
/// Time for an answer, and the least rate at which it must be taken beyond, in bytes a second.
const BODY_TIME: Duration = Duration::from_secs(30);
const LEAST_RATE: u64 = 4 << 10;
/// Bytes that are read and written at a time.
const BLOCK: usize = 64 << 10;

/// Tells a client that there are too many.
pub fn refuse(mut stream: TcpStream) {
    let _ = stream.set_write_timeout(Some(Duration::from_millis(100)));
    let _ = stream.write_all(Response::error(503).head(true).as_bytes());
}

/// Answers requests until one side ends the connection.
pub fn serve(mut stream: TcpStream, folder: &Folder, counts: &ServerCounts) {
    let _ = stream.set_nodelay(true);
    let mut read = Vec::new();
    loop {
        let (head, mut reply) = match next_head(&mut stream, &mut read) {
            Ok(Parsed::Whole(head, length)) => {
                read.drain(..length);
                let reply = answer(&head, folder);
                (Some(head), reply)
            }
            Ok(Parsed::Wrong(status)) => (None, Response::error(status)),
            Ok(Parsed::Part) | Err(_) => return,
        };
        let closes = head.as_ref().is_none_or(|head| head.closes);
        counts.requests.fetch_add(1, Ordering::Relaxed);
        if reply.status >= 400 {
            counts.errors.fetch_add(1, Ordering::Relaxed);
        }
        if send(&mut stream, head.as_ref(), &mut reply, closes, counts).is_err() || closes {
            return;
        }
    }
}

/// Reads until there is a whole head; a part of one if the client has ended.
fn next_head(stream: &mut TcpStream, read: &mut Vec<u8>) -> io::Result<Parsed> {
    let end = Instant::now() + HEAD_TIME;
    let mut block = [0; 4096];
    loop {
        match parse(read) {
            Parsed::Part => {}
            parsed => return Ok(parsed),
        }
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(if read.is_empty() { Parsed::Part } else { Parsed::Wrong(408) });
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut block) {
            Ok(0) => return Ok(Parsed::Part),
            Ok(count) => read.extend_from_slice(&block[..count]),
            Err(error) if is_late(&error) => {}
            Err(error) => return Err(error),
        }
    }
}

fn is_late(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), Interrupted | TimedOut | WouldBlock)
}

/// Sends an answer, without its body if only the head is asked for.
fn send(
    stream: &mut TcpStream,
    head: Option<&Head>,
    reply: &mut Response,
    closes: bool,
    counts: &ServerCounts,
) -> io::Result<()> {
    let length = reply.body.left();
    let end = Instant::now() + BODY_TIME + Duration::from_secs(length / LEAST_RATE);
    let mut block = reply.head(closes).into_bytes();
    let has_body = head.is_none_or(|head| head.method != "HEAD");
    let mut buffer = vec![0; BLOCK.min(usize::try_from(length).unwrap_or(BLOCK)).max(1)];
    loop {
        // What is small goes with the head, in one packet.
        if has_body && reply.body.left() > 0 {
            let count = reply.body.read(&mut buffer)?;
            if count == 0 {
                // The file has become shorter: only the end of the connection can say so.
                counts.errors.fetch_add(1, Ordering::Relaxed);
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            block.extend_from_slice(&buffer[..count]);
            counts.bytes.fetch_add(count as u64, Ordering::Relaxed);
        }
        let left = end.saturating_duration_since(Instant::now());
        stream.set_write_timeout(Some(left.max(Duration::from_millis(1))))?;
        stream.write_all(&block)?;
        block.clear();
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        if !has_body || reply.body.left() == 0 {
            return stream.flush();
        }
    }
}
