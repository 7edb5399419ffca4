//! Strips in compressed parts.

use serde_json::Value;

use crate::compress::{TEXTURED, number};
use crate::run::Run;

#[test]
fn strips_come_back_as_the_same_faces_and_materials() {
    let run = Run::new();
    std::fs::write(run.path("two.mtl"), "newmtl sky\nKd 0 0 1\nnewmtl sea\nKd 0 1 0\n").unwrap();
    std::fs::write(run.path("in.obj"), TEXTURED).unwrap();
    run.sample("gyroid", 6_000, "large.ply");
    for (input, back) in [("in.obj", "back.obj"), ("large.ply", "back.ply")] {
        let way = ["--scheme", "parts", "--bits", "9"];
        let plain = run.json(&[&["compress", input, "plain.mlq"], &way[..]].concat());
        let strips = [&["compress", input, "strips.mlq", "--strips"], &way[..]].concat();
        let bytes = |threads: &str| {
            run.json(&[&strips[..], &["--threads", threads]].concat());
            std::fs::read(run.path("strips.mlq")).unwrap()
        };
        assert!(bytes("1") == bytes("3"), "the same for any number of threads");
        let strips = run.json(&strips);
        assert_eq!(plain["strips"], Value::Null);
        for field in ["faces", "vertices", "parts", "bytes_positions", "bytes_attributes"] {
            assert_eq!(plain[field], strips[field], "{field}");
        }
        let counts = &strips["strips"];
        assert!(number(counts, "indices") < 3.0 * number(&strips, "faces"), "{strips}");
        let bytes = number(&strips, "bytes_connectivity");
        assert!(bytes >= number(counts, "indices") + 4.0 * number(&strips, "parts"), "{strips}");
        run.json(&["decompress", "plain.mlq", back]);
        let plain = run.json(&["info", back]);
        run.json(&["decompress", "strips.mlq", back]);
        let stripped = run.json(&["info", back]);
        for field in ["faces", "vertices", "edges", "closed", "materials", "attributes", "bounds"] {
            assert_eq!(plain[field], stripped[field], "{field}");
        }
        let apart = |of: &Value| (number(of, "area"), number(of, "volume"));
        let ((area, volume), (is_area, is_volume)) = (apart(&plain), apart(&stripped));
        assert!((area - is_area).abs() < 1e-6 * area && (volume - is_volume).abs() < 1e-6);
    }
}
