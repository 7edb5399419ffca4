//! Options and reports in the forms that serde gives them: names, defaults, and what is refused.

use std::fmt::Debug;

use meshlod::check::{
    CheckOptions, ContactPolicy, HoleLimits, Kind, Kinds, LockOptions, RepairOptions, Stitch,
};
use meshlod::codec::{Lattice, TransportOptions, TransportQuantization};
use meshlod::flock::levels::{ChainOptions, ModelAxes};
use meshlod::flock::nearest::{CutFocus, NearestOptions};
use meshlod::flock::select::policies::Factors;
use meshlod::flock::select::{Budget, PolicyName};
use meshlod::io::{Precision, Weld};
use meshlod::jobs::{
    BuildRequest, CheckRequest, CompressRequest, CompressTarget, ErrorLimit, ExtractRequest,
    FocusRequest, LevelModel, MeasureRequest, Packing, PositionScheme, QueryRequest, QueryTarget,
    RepairRequest, WrittenAs, check,
};
use meshlod::measure::{BeyondOptions, CertifiedOptions, DistanceOptions};
use meshlod::mesh::{AttributeBounds, ConditionOptions, Lock, Locks, Search, VertexId};
use meshlod::multires::{ErrorKind, Focus, Ground, GroundShape, Storage, UpdateLimits};
use meshlod::simplify::AttributeWeights;
use meshlod::strip::{CacheAware, Prices, StripOptions, StripQuality};
use meshlod::{
    Bound, Constraints, Format, Method, Options, ReadOptions, Target, Topology, VertexLocking,
    WriteOptions, samples, simplify,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, from_value, json, to_value};

/// Checks that options come back as they were from JSON and from TOML, which leaves out what is
/// `None`, that no field must be given, and that a misspelt one is refused.
fn options_as<T: Serialize + DeserializeOwned + Default>(options: &T, expected: &Value) {
    let written = to_value(options).unwrap();
    for (field, value) in expected.as_object().unwrap() {
        assert_eq!(&written[field], value, "{field}");
    }
    let read: T = from_value(written.clone()).unwrap();
    assert_eq!(to_value(&read).unwrap(), written);
    let of_toml: T = toml::from_str(&toml::to_string(options).unwrap()).unwrap();
    assert_eq!(to_value(&of_toml).unwrap(), written);
    let of_part: T = from_value(expected.clone()).unwrap();
    assert_eq!(to_value(&of_part).unwrap(), written);
    let none: T = from_value(json!({})).unwrap();
    assert_eq!(to_value(&none).unwrap(), to_value(T::default()).unwrap());
    let error = from_value::<T>(json!({ "misspelt": 1 })).err().map(|error| error.to_string());
    assert!(error.is_some_and(|error| error.contains("unknown field `misspelt`")));
}

/// Checks that one value comes back as it was from JSON.
fn form<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: T, expected: &Value) {
    assert_eq!(&to_value(&value).unwrap(), expected);
    assert_eq!(from_value::<T>(expected.clone()).unwrap(), value);
}

fn some_locks() -> (Locks, Value) {
    let locks = Locks { of_vertex: vec![Lock::Free, Lock::Locked], ties: vec![vec![VertexId(3)]] };
    (locks, json!({ "of_vertex": ["free", "locked"], "ties": [[3]] }))
}

#[test]
fn options_of_simplification_and_measuring() {
    let (locks, locks_json) = some_locks();
    options_as(
        &Options {
            method: Method::QemEndpoint,
            topology: Topology::Keep,
            boundary_weight: Some(2.5),
            locks: locks.clone(),
            ..Options::default()
        },
        &json!({
            "method": "qem-endpoint", "topology": "keep", "boundary_weight": 2.5, "locks": locks_json,
        }),
    );
    options_as(
        &Constraints { locks: VertexLocking::Given(vec![locks]), fuse: true, ..Default::default() },
        &json!({ "locks": { "given": [locks_json] }, "fuse": true }),
    );
    options_as(&AttributeWeights { uv: 2.0, ..Default::default() }, &json!({ "uv": 2.0 }));
    let searched = ConditionOptions { search: Search::Unbalanced, ..Default::default() };
    options_as(&searched, &json!({ "search": "unbalanced", "borders": "stitch" }));
    options_as(&DistanceOptions { samples: 7, ..Default::default() }, &json!({ "samples": 7 }));
    options_as(&CertifiedOptions { floor: 0.0, ..Default::default() }, &json!({ "floor": 0.0 }));
    options_as(&BeyondOptions { slack: 0.5, ..Default::default() }, &json!({ "slack": 0.5 }));
}

#[test]
fn options_of_checks_and_repair() {
    options_as(
        &CheckOptions { kinds: Kinds::NONE.with(Kind::BadIndex), ..Default::default() },
        &json!({ "kinds": ["bad-index"], "broad_phase": "tree" }),
    );
    options_as(
        &LockOptions { contacts: Some(ContactPolicy::Tie), boundary: Lock::Locked },
        &json!({ "contacts": "tie", "boundary": "locked" }),
    );
    let of_any_length = HoleLimits { edges: 8, length: None };
    let none_stitched = RepairOptions {
        stitch: Stitch::Off,
        holes: Some(of_any_length),
        unused: false,
        ..Default::default()
    };
    options_as(
        &none_stitched,
        &json!({ "stitch": "off", "holes": { "edges": 8, "length": null }, "unused": false }),
    );
    options_as(
        &RepairOptions { stitch: Stitch::Within(0.5), weld: Some(0.0), ..Default::default() },
        &json!({ "stitch": { "within": 0.5 }, "weld": 0.0, "holes": null }),
    );
    options_as(&HoleLimits { length: Some(2.5), ..Default::default() }, &json!({ "length": 2.5 }));
    let written_as = Some(WrittenAs { format: Format::Ply, precision: Precision::Auto });
    options_as(
        &RepairRequest { fuse: true, written_as, ..Default::default() },
        &json!({ "fuse": true, "written_as": { "format": "ply", "precision": "auto" } }),
    );
}

#[test]
fn options_of_files_levels_and_bytes() {
    options_as(
        &MeasureRequest { certified: true, poses: Some(8), ..Default::default() },
        &json!({ "samples": 500_000, "certified": true, "poses": 8 }),
    );
    options_as(&ReadOptions { weld: Weld::Within(0.5) }, &json!({ "weld": { "within": 0.5 } }));
    options_as(&WriteOptions { precision: Precision::F64 }, &json!({ "precision": "f64" }));
    let model = LevelModel::RightTriangles;
    options_as(
        &BuildRequest { errors: ErrorKind::Bound, model, ..Default::default() },
        &json!({ "errors": "bound", "model": "right-triangles", "rounding": "0.005%" }),
    );
    let target = QueryTarget::Error(ErrorLimit::Length(Bound::OfDiagonal(0.01)));
    let query = QueryRequest { target, focus: FocusRequest::Frustum, ..Default::default() };
    options_as(
        &ExtractRequest { query, crop: true, ..Default::default() },
        &json!({
            "query": {
                "target": { "error": { "length": "1%" } },
                "focus": "frustum",
                "camera": null,
                "up": null,
            },
            "crop": true,
        }),
    );
    options_as(&Storage { rounding: Some(0.5), ..Default::default() }, &json!({ "rounding": 0.5 }));
    options_as(&UpdateLimits { changes: Some(9), ..Default::default() }, &json!({ "changes": 9 }));
    options_as(
        &CompressRequest {
            target: CompressTarget::Reduction(0.5),
            packing: Packing::Resident {
                scheme: Some(PositionScheme::Parts { strips: Some(StripQuality::Fast) }),
                attributes: AttributeBounds::default(),
            },
            ..Default::default()
        },
        &json!({
            "target": { "reduction": 0.5 },
            "packing": { "resident": {
                "scheme": { "parts": { "strips": "fast" } },
                "attributes": to_value(AttributeBounds::default()).unwrap(),
            } },
        }),
    );
    let quantization = TransportQuantization::Lattice(Lattice::new(-9).unwrap());
    options_as(
        &TransportOptions { quantization, ..Default::default() },
        &json!({ "quantization": { "lattice": { "exponent": -9 } }, "block_faces": 320 }),
    );
    options_as(&AttributeBounds { uv: 0.5, ..Default::default() }, &json!({ "uv": 0.5 }));
    let cache = CacheAware { entries: 24, ..CacheAware::default() };
    options_as(
        &StripOptions { cache: Some(cache), seed: 7, ..StripOptions::default() },
        &json!({ "cache": to_value(cache).unwrap(), "seed": 7 }),
    );
    options_as(&cache, &json!({ "entries": 24 }));
    options_as(&Prices::with_restarts(), &json!({ "strip": 3.0 }));
}

#[test]
fn options_of_flocks() {
    options_as(&Budget { triangles: 9, ..Budget::default() }, &json!({ "triangles": 9 }));
    let (locks, locks_json) = some_locks();
    options_as(
        &ChainOptions { axes: ModelAxes::FISH, locks: Some(locks), ..Default::default() },
        &json!({ "axes": to_value(ModelAxes::FISH).unwrap(), "locks": locks_json }),
    );
    options_as(&ModelAxes::FISH, &json!({ "forward": [-1.0, 0.0, 0.0] }));
    options_as(
        &NearestOptions { focus: CutFocus::Everything, ..Default::default() },
        &json!({ "focus": "everything" }),
    );
    form(Factors::WithoutLayer, &json!("without-layer"));
}

#[test]
fn all_kinds_are_all_those_to_come() {
    form(Kinds::ALL, &json!("all"));
    form(Kinds::NONE, &json!([]));
    form(CheckOptions::default().kinds, &json!("all"));
    assert_eq!(from_value::<Kinds>(to_value(Kind::ALL).unwrap()).unwrap(), Kinds::ALL);
    let refused = |kinds: Value| from_value::<Kinds>(kinds).unwrap_err().to_string();
    assert!(refused(json!("none")).contains("expected a list of kinds of findings, or \"all\""));
    assert!(refused(json!(["all"])).contains("unknown variant `all`"));
}

#[test]
fn what_has_no_default_is_given_whole_and_checked() {
    let shape = GroundShape::Line([[0.0; 2], [1.0; 2]]);
    form(
        Ground { up: 2, shape },
        &json!({ "up": 2, "shape": { "line": [[0.0, 0.0], [1.0, 1.0]] } }),
    );
    let refused = from_value::<Focus>(json!({ "ground": { "up": 2 } })).unwrap_err();
    assert!(refused.to_string().contains("missing field `shape`"));
    let refused = from_value::<Lattice>(json!({ "exponent": 961 })).unwrap_err();
    assert!(refused.to_string().contains("must be between -960 and 960"));
}

#[test]
fn targets_name_their_unit() {
    for (target, expected) in [
        (Target::Faces(100), json!({ "faces": 100 })),
        (Target::Ratio(0.25), json!({ "ratio": 0.25 })),
        (Target::Error(0.5), json!({ "error": 0.5 })),
    ] {
        form(target, &expected);
    }
}

#[test]
fn names_are_those_that_print() {
    fn names<T, const N: usize>(all: [T; N], name: impl Fn(&T) -> String)
    where
        T: Serialize + DeserializeOwned + PartialEq + Debug,
    {
        for one in all {
            let written = to_value(&one).unwrap();
            assert_eq!(written, name(&one));
            assert_eq!(from_value::<T>(written).unwrap(), one);
        }
    }
    names(Method::ALL, Method::to_string);
    names(Topology::ALL, Topology::to_string);
    names(ContactPolicy::ALL, ContactPolicy::to_string);
    names(Precision::ALL, Precision::to_string);
    names(PolicyName::ALL, PolicyName::to_string);
    names(Kind::ALL, |kind| kind.name().to_owned());
}

#[test]
fn a_report_of_a_simplification_has_its_fields() {
    let mesh = samples::sphere(400);
    let (_, report) = simplify(&mesh, Target::Faces(100), &Options::default()).unwrap();
    let json = to_value(report).unwrap();
    assert_eq!(json["method"], "lindstrom-turk");
    assert_eq!([&json["input_faces"], &json["reached"]], [&json!(mesh.faces.len()), &json!(true)]);
    assert_eq!(json["contractions"]["edges"], report.contractions.edges);
    assert_eq!(json["refusals"]["last_faces"], 0);
    assert_eq!(json["proof"], Value::Null);
    assert_eq!(json["volume"]["held"], json!({ "contractions": 0, "bounds": null }));
}

#[test]
fn a_report_of_a_check_tells_kinds_apart() {
    let mut mesh = samples::sphere(400);
    let face = mesh.faces.len();
    mesh.faces.push(mesh.faces[7]);
    mesh.positions.push([0.0; 3]);
    let json =
        to_value(check(&mesh, &CheckRequest { limit: 1, ..Default::default() }, &()).unwrap())
            .unwrap();
    assert_eq!(json["summary"]["duplicate-face"], 1);
    assert_eq!(json["summary"]["bad-index"], Value::Null, "only what was found");
    let findings = json["findings"].as_array().unwrap();
    let vertex = mesh.positions.len() - 1;
    assert!(findings.contains(&json!({ "kind": "unused-vertex", "vertex": vertex })), "{json}");
    assert!(findings.contains(&json!({ "kind": "duplicate-face", "face": face, "of": 7 })));
}
