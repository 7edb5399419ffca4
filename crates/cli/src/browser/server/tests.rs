//! Requests of every kind, good and bad, over real connections.

use std::fs;
use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use tempfile::TempDir;

use super::Server;

/// A server of a folder with a few files.
struct Served {
    folder: TempDir,
    address: SocketAddr,
    server: Arc<Server>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Served {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("served");
        fs::create_dir_all(root.join("deep/er")).unwrap();
        let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
        write("secret.mlod", b"secret");
        write("served/a.mlod", &(0..=255).collect::<Vec<u8>>());
        write("served/empty.mlz", b"");
        write("served/.hidden.mlod", b"secret");
        write("served/deep/er/b c%.mlq", b"inner");
        write("served/notes.txt", b"text");
        let address = SocketAddr::new(Ipv4Addr::LOCALHOST.into(), 0);
        let server = Arc::new(Server::bind(&root, address).unwrap());
        let address = server.address().unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let (runs, stops) = (Arc::clone(&server), Arc::clone(&stop));
        let thread = Some(thread::spawn(move || runs.run(None, &stops)));
        Self { folder, address, server, stop, thread }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        stream
    }

    /// Sends bytes and returns all that comes until the server ends the connection.
    fn raw(&self, request: &[u8]) -> String {
        let mut stream = self.connect();
        // The server may refuse before it has read all.
        let _ = stream.write_all(request);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Asks for a path with more headers, on a connection of its own.
    fn get(&self, path: &str, headers: &str) -> String {
        self.raw(format!("GET {path} HTTP/1.1\r\nConnection: close\r\n{headers}\r\n").as_bytes())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn status(answer: &str) -> &str {
    answer.split(' ').nth(1).unwrap_or_default()
}

fn header<'a>(answer: &'a str, name: &str) -> &'a str {
    let prefix = format!("{name}: ");
    let head = answer.split("\r\n\r\n").next().unwrap();
    head.lines().find_map(|line| line.strip_prefix(&prefix)).unwrap_or_default()
}

fn body(answer: &str) -> &str {
    answer.split_once("\r\n\r\n").unwrap_or_default().1
}

#[test]
fn files_are_sent_whole_and_in_parts() {
    let served = Served::new();
    let whole = served.get("/deep/er/b%20c%25.mlq?query", "");
    assert_eq!((status(&whole), body(&whole)), ("200", "inner"));
    assert_eq!(header(&whole, "Access-Control-Allow-Origin"), "*");
    assert_eq!(header(&whole, "Accept-Ranges"), "bytes");
    assert_eq!(header(&whole, "Content-Encoding"), "");
    let part = served.get("/a.mlod", "Range: bytes=65-67\r\n");
    assert_eq!((status(&part), body(&part)), ("206", "ABC"));
    assert_eq!(header(&part, "Content-Range"), "bytes 65-67/256");
    assert_eq!(header(&part, "Content-Length"), "3");
    for several in ["bytes=0-1,5-6", "bytes=0-0,0-0,0-0", "bytes=5-2"] {
        let whole = served.get("/notes.txt", &format!("Range: {several}\r\n"));
        assert_eq!((status(&whole), body(&whole)), ("200", "text"), "{several}");
    }
    let huge = served.get("/notes.txt", "Range: bytes=1-99999999999999999999\r\n");
    assert_eq!((status(&huge), body(&huge)), ("206", "ext"));
    let head =
        served.raw(b"HEAD /notes.txt HTTP/1.1\r\nConnection: close\r\nRange: bytes=1-2\r\n\r\n");
    assert_eq!((status(&head), header(&head, "Content-Length"), body(&head)), ("200", "4", ""));
    let last = served.get("/notes.txt", "Range: bytes=-2\r\n");
    assert_eq!((status(&last), body(&last)), ("206", "xt"));
    let beyond = served.get("/a.mlod", "Range: bytes=256-\r\n");
    assert_eq!((status(&beyond), header(&beyond, "Content-Range")), ("416", "bytes */256"));
    assert_eq!(header(&served.get("/empty.mlz", ""), "Content-Length"), "0");
}

#[test]
fn parts_are_of_one_file() {
    let served = Served::new();
    let tag = header(&served.get("/notes.txt", ""), "ETag").to_owned();
    let same = format!("Range: bytes=1-2\r\nIf-Range: {tag}\r\n");
    assert_eq!(body(&served.get("/notes.txt", &same)), "ex");
    assert_eq!(status(&served.get("/notes.txt", &format!("If-None-Match: {tag}\r\n"))), "304");
    let weak = format!("If-None-Match: \"other\", W/{tag}\r\n");
    assert_eq!(status(&served.get("/notes.txt", &weak)), "304");
    // Parts need the bytes, of which a weak tag says nothing.
    let unsure = format!("Range: bytes=1-2\r\nIf-Range: W/{tag}\r\n");
    assert_eq!(status(&served.get("/notes.txt", &unsure)), "200");
    fs::write(served.folder.path().join("served/notes.txt"), b"another text").unwrap();
    let other = served.get("/notes.txt", &same);
    assert_eq!((status(&other), body(&other)), ("200", "another text"));
    assert_ne!(header(&other, "ETag"), tag);
}

#[test]
fn nothing_outside_the_folder_is_sent() {
    let served = Served::new();
    for path in [
        "/../secret.mlod",
        "/deep/../../secret.mlod",
        "/..%2fsecret.mlod",
        "/%2e%2e/secret.mlod",
        "/%2e%2e%2fsecret.mlod",
        "/..%5csecret.mlod",
        "/deep/..\\..\\secret.mlod",
        "//a.mlod",
        "/a.mlod/",
        "/a.mlod%00",
        "/a.mlod%00.txt",
        "/.hidden.mlod",
        "/%2ehidden.mlod",
        "/./a.mlod",
        "/deep",
        "/deep/",
        "/%ff",
        "/missing",
        "/.meshlod/other",
    ] {
        let answer = served.get(path, "");
        assert_eq!(status(&answer), "404", "{path}: {answer}");
        assert!(!answer.contains("secret"), "{path}");
    }
    assert_eq!(status(&served.get("http://example.com/a.mlod", "")), "400");
}

#[cfg(unix)]
#[test]
fn links_are_followed_inside_only() {
    use std::os::unix::fs::symlink;
    let served = Served::new();
    let root = served.folder.path().join("served");
    symlink("../secret.mlod", root.join("out.mlod")).unwrap();
    symlink("..", root.join("up")).unwrap();
    symlink("notes.txt", root.join("in.txt")).unwrap();
    assert_eq!(body(&served.get("/in.txt", "")), "text");
    for path in ["/out.mlod", "/up/secret.mlod", "/up/served/notes.txt/.."] {
        assert_eq!(status(&served.get(path, "")), "404", "{path}");
    }
}

#[test]
fn the_page_and_what_it_needs() {
    let served = Served::new();
    let page = served.get("/", "");
    assert!(page.contains("<title>meshlod</title>") && page.ends_with("</html>\n"));
    let packed = served.get("/", "Accept-Encoding: br, gzip;q=0.8\r\n");
    assert_eq!(header(&packed, "Content-Encoding"), "gzip");
    let length = |answer| header(answer, "Content-Length").parse::<usize>().unwrap();
    assert!(length(&packed) < length(&page) / 2);
    assert!(served.get("/.meshlod/formats.js", "").contains("decodePacked"));
    let list: serde_json::Value =
        serde_json::from_str(body(&served.get("/.meshlod/files.json", ""))).unwrap();
    let paths: Vec<_> = list.as_array().unwrap().iter().map(|file| &file["path"]).collect();
    assert_eq!(paths, ["a.mlod", "deep/er/b c%.mlq", "empty.mlz"]);
    assert_eq!(list[0]["bytes"], 256);
}

#[test]
fn a_connection_answers_one_request_after_the_other() {
    let served = Served::new();
    let all = served.raw(
        b"HEAD /notes.txt HTTP/1.1\r\n\r\nGET /notes.txt HTTP/1.1\r\n\r\n\
          OPTIONS /notes.txt HTTP/1.1\r\n\r\nPUT /notes.txt HTTP/1.1\r\n\r\n\
          GET /missing HTTP/1.0\r\n\r\nGET /notes.txt HTTP/1.1\r\n\r\n",
    );
    let statuses: Vec<_> = all.split("HTTP/1.1 ").skip(1).map(|answer| &answer[..3]).collect();
    assert_eq!(statuses, ["200", "200", "204", "405", "404"]);
    assert_eq!(all.matches("\r\n\r\ntext").count(), 1, "{all}");
    assert_eq!(all.matches("Content-Length: 4\r\n").count(), 2);
    let counts = served.server.counts();
    assert_eq!(counts.requests.load(Ordering::Relaxed), 5);
    assert_eq!(counts.errors.load(Ordering::Relaxed), 2);
}

#[test]
fn what_is_no_request_is_refused() {
    let served = Served::new();
    let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(20_000));
    let many = format!("GET / HTTP/1.1\r\n{}\r\n", "A: b\r\n".repeat(100));
    for (request, expected) in [
        (&b"nonsense\r\n\r\n"[..], "400"),
        (b"GET / HTTP/9.9\r\n\r\n", "400"),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc", "400"),
        (b"GET a.mlod HTTP/1.1\r\n\r\n", "400"),
        (b"GET /\0 HTTP/1.1\r\n\r\n", "400"),
        (long.as_bytes(), "431"),
        (many.as_bytes(), "431"),
    ] {
        assert_eq!(status(&served.raw(request)), expected, "{:?}", request.get(..20));
    }
    // A body is not read, so what follows cannot be told from it.
    let smuggled = b"GET /notes.txt HTTP/1.1\r\nContent-Length: 9\r\n\r\nGET /x HTTP/1.1\r\n\r\n";
    assert_eq!(served.raw(smuggled).matches("HTTP/1.1 ").count(), 1);
}

#[test]
fn many_connections_are_answered_and_more_are_refused() {
    let served = Served::new();
    let workers: Vec<_> = (0..16)
        .map(|_| {
            let mut stream = served.connect();
            thread::spawn(move || {
                let mut all = String::new();
                for _ in 0..20 {
                    stream.write_all(b"GET /notes.txt HTTP/1.1\r\n\r\n").unwrap();
                }
                stream.write_all(b"GET /notes.txt HTTP/1.0\r\n\r\n").unwrap();
                stream.read_to_string(&mut all).unwrap();
                all.matches("\r\n\r\ntext").count()
            })
        })
        .collect();
    assert!(workers.into_iter().all(|worker| worker.join().unwrap() == 21));
    let idle: Vec<_> = (0..super::MOST_CONNECTIONS + 8).map(|_| served.connect()).collect();
    let refused = || {
        idle.iter().filter(|stream| {
            stream.set_nonblocking(true).unwrap();
            let mut start = [0; 12];
            stream.peek(&mut start).is_ok_and(|count| start[..count].ends_with(b"503"))
        })
    };
    for _ in 0..500 {
        if refused().count() >= 8 {
            break;
        }
        thread::sleep(Duration::from_millis(10));
    }
    assert!(refused().count() >= 8);
    drop(idle);
    let again = (0..500).find(|_| {
        thread::sleep(Duration::from_millis(10));
        status(&served.get("/notes.txt", "")) == "200"
    });
    assert!(again.is_some());
}
