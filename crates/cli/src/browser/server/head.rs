//! The head of a request: what it asks for, within limits.

/// Greatest length of a head, in bytes.
pub const MOST_BYTES: usize = 16 << 10;
const MOST_HEADERS: usize = 64;

/// Head of a request.
#[derive(Debug)]
pub struct Head {
    pub method: String,
    /// Path of the target, still encoded, without its query.
    pub path: String,
    pub range: Option<String>,
    pub if_range: Option<String>,
    pub if_none_match: Option<String>,
    pub takes_gzip: bool,
    /// True if the connection ends with the answer.
    pub closes: bool,
}

/// Reading of the bytes that have come so far.
#[derive(Debug)]
pub enum Parsed {
    /// A head, and its length.
    Whole(Head, usize),
    /// The beginning of one.
    Part,
    /// No request, or one that is too long: the status that says so.
    Wrong(u16),
}

/// Parses the head at the start of some bytes.
pub fn parse(bytes: &[u8]) -> Parsed {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(bytes) {
        Ok(httparse::Status::Complete(length)) if length <= MOST_BYTES => {
            head_of(&request).map_or_else(Parsed::Wrong, |head| Parsed::Whole(head, length))
        }
        Ok(httparse::Status::Partial) if bytes.len() < MOST_BYTES => Parsed::Part,
        Ok(_) | Err(httparse::Error::TooManyHeaders) => Parsed::Wrong(431),
        Err(_) => Parsed::Wrong(400),
    }
}

fn head_of(request: &httparse::Request<'_, '_>) -> Result<Head, u16> {
    let text = |name: &str| {
        let header = request.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name));
        header.and_then(|header| std::str::from_utf8(header.value).ok()).map(str::trim)
    };
    let has = |name: &str, word: &str| {
        let words = text(name).unwrap_or_default().split([',', ';']);
        words.map(str::trim).any(|found| found.eq_ignore_ascii_case(word))
    };
    let target = request.path.unwrap_or_default();
    let path = target.split(['?', '#']).next().unwrap_or_default();
    if !path.starts_with('/') && path != "*" {
        return Err(400);
    }
    // No answer needs a body, so none is read, and the next request could not be found.
    let has_body = text("transfer-encoding").is_some()
        || text("content-length").is_some_and(|length| length != "0");
    let is_old = request.version == Some(0);
    Ok(Head {
        method: request.method.unwrap_or_default().to_owned(),
        path: path.to_owned(),
        range: text("range").map(str::to_owned),
        if_range: text("if-range").map(str::to_owned),
        if_none_match: text("if-none-match").map(str::to_owned),
        takes_gzip: has("accept-encoding", "gzip"),
        closes: has_body
            || has("connection", "close")
            || is_old && !has("connection", "keep-alive"),
    })
}
