//! The answer to a request: its status, its headers and its body.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::sync::LazyLock;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::folder::{Folder, OpenFile};
use super::head::Head;
use super::range::{SentPart, part};
use crate::browser::{FORMATS, VIEWER};

/// Bytes that are sent behind the head.
pub enum Body {
    Bytes(Vec<u8>),
    /// So many bytes of a file, from where it stands.
    File(File, u64),
}

/// An answer.
pub struct Response {
    pub status: u16,
    headers: Vec<(&'static str, String)>,
    pub body: Body,
}

/// The page and the decoders, as they are sent to browsers that read gzip.
static PACKED: LazyLock<[Vec<u8>; 2]> = LazyLock::new(|| [VIEWER, FORMATS].map(packed));

fn packed(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    let written = encoder.write_all(text.as_bytes()).and_then(|()| encoder.finish());
    written.expect("memory takes all that is written")
}

/// Returns the answer to a request.
pub fn answer(head: &Head, folder: &Folder) -> Response {
    match &*head.method {
        "GET" | "HEAD" => {}
        "OPTIONS" => return leave(),
        _ => return Response::error(405).with("Allow", "GET, HEAD, OPTIONS"),
    }
    match &*head.path {
        "/" => text(head, VIEWER, &PACKED[0], "text/html; charset=utf-8"),
        "/.meshlod/formats.js" => text(head, FORMATS, &PACKED[1], "text/javascript; charset=utf-8"),
        "/.meshlod/files.json" => {
            let list = serde_json::to_vec(&folder.list()).unwrap_or_default();
            Response::new(200, Body::Bytes(list)).with("Content-Type", "application/json")
        }
        path => folder.file(path).map_or_else(|| Response::error(404), |file| sent(head, file)),
    }
}

/// Answers a browser that asks whether a page of another origin may ask.
fn leave() -> Response {
    Response::new(204, Body::Bytes(Vec::new()))
        .with("Access-Control-Allow-Methods", "GET, HEAD, OPTIONS")
        .with("Access-Control-Allow-Headers", "Range, If-Range, If-None-Match")
        .with("Access-Control-Max-Age", "86400")
}

fn text(head: &Head, text: &str, packed: &[u8], media_type: &str) -> Response {
    let answer = match head.takes_gzip {
        true => Response::new(200, Body::Bytes(packed.to_vec())).with("Content-Encoding", "gzip"),
        false => Response::new(200, Body::Bytes(text.into())),
    };
    answer.with("Content-Type", media_type).with("Vary", "Accept-Encoding")
}

/// Returns a file, or the part of it that is asked for.
fn sent(head: &Head, open: OpenFile) -> Response {
    let OpenFile { mut file, length, modified, tag, media_type } = open;
    let date = httpdate::fmt_http_date(modified);
    // A cache on the way may have made the tag weak.
    let is_tag = |known: &str| known.strip_prefix("W/").unwrap_or(known) == tag || known == "*";
    let same = |tags: &str| tags.split(',').map(str::trim).any(is_tag);
    let facts = |answer: Response| {
        answer
            .with("ETag", &tag)
            .with("Last-Modified", &date)
            .with("Accept-Ranges", "bytes")
            .with("Cache-Control", "no-cache")
    };
    if head.if_none_match.as_deref().is_some_and(same) {
        return facts(Response::new(304, Body::Bytes(Vec::new())));
    }
    // A part goes only with parts of the same file, and a range means nothing to HEAD.
    let has_part = head.method == "GET";
    let is_same = head.if_range.as_ref().is_none_or(|known| *known == tag || *known == date);
    let (status, range) = match part(head.range.as_deref().filter(|_| has_part && is_same), length)
    {
        SentPart::Whole => (200, 0..length),
        SentPart::Some(range) => (206, range),
        SentPart::Nothing => {
            return Response::error(416).with("Content-Range", &format!("bytes */{length}"));
        }
    };
    if range.start > 0 && file.seek(SeekFrom::Start(range.start)).is_err() {
        return Response::error(500);
    }
    let answer = Response::new(status, Body::File(file, range.end - range.start));
    let answer = facts(answer).with("Content-Type", media_type);
    match status {
        206 => {
            let last = range.end - 1;
            answer.with("Content-Range", &format!("bytes {}-{last}/{length}", range.start))
        }
        _ => answer,
    }
}

impl Response {
    fn new(status: u16, body: Body) -> Self {
        Self { status, headers: Vec::new(), body }
    }

    /// Creates an answer that says what is wrong.
    pub fn error(status: u16) -> Self {
        let line = format!("{status} {}\n", reason(status));
        Self::new(status, Body::Bytes(line.into()))
            .with("Content-Type", "text/plain; charset=utf-8")
    }

    fn with(mut self, name: &'static str, value: &str) -> Self {
        self.headers.push((name, value.to_owned()));
        self
    }

    /// Returns the head that goes before the body.
    pub fn head(&self, closes: bool) -> String {
        let length = match &self.body {
            Body::Bytes(bytes) => bytes.len() as u64,
            Body::File(_, length) => *length,
        };
        let mut head = format!("HTTP/1.1 {} {}\r\n", self.status, reason(self.status));
        let date = httpdate::fmt_http_date(std::time::SystemTime::now());
        let connection = if closes { "close" } else { "keep-alive" };
        let common = [
            ("Date", &*date),
            ("Server", "meshlod"),
            ("Connection", connection),
            ("Access-Control-Allow-Origin", "*"),
            (
                "Access-Control-Expose-Headers",
                "Accept-Ranges, Content-Length, Content-Range, ETag, Last-Modified",
            ),
            ("X-Content-Type-Options", "nosniff"),
        ];
        let own = self.headers.iter().map(|(name, value)| (*name, &**value));
        for (name, value) in common.into_iter().chain(own) {
            head += &format!("{name}: {value}\r\n");
        }
        if !matches!(self.status, 204 | 304) {
            head += &format!("Content-Length: {length}\r\n");
        }
        head + "\r\n"
    }
}

impl Body {
    /// Reads the next bytes of the body into a buffer; 0 at its end, or where a file has become
    /// shorter.
    pub fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Self::Bytes(bytes) => {
                let count = bytes.len().min(buffer.len());
                buffer[..count].copy_from_slice(&bytes[..count]);
                bytes.drain(..count);
                Ok(count)
            }
            Self::File(file, left) => {
                let most = usize::try_from(*left).unwrap_or(usize::MAX).min(buffer.len());
                let count = file.read(&mut buffer[..most])?;
                *left -= count as u64;
                Ok(count)
            }
        }
    }

    /// Returns the number of bytes that are left.
    pub fn left(&self) -> u64 {
        match self {
            Self::Bytes(bytes) => bytes.len() as u64,
            Self::File(_, left) => *left,
        }
    }
}

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        204 => "No Content",
        206 => "Partial Content",
        304 => "Not Modified",
        400 => "Bad Request",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        416 => "Range Not Satisfiable",
        431 => "Request Header Fields Too Large",
        503 => "Service Unavailable",
        _ => "Internal Server Error",
    }
}
