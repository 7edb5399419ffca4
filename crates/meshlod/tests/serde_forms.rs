//! Options and reports in the forms that serde gives them: names, defaults, and what is refused.

use std::fmt::Debug;

use meshlod::check::{CheckOptions, ContactPolicy, HoleLimits, Kind, Kinds, RepairOptions};
use meshlod::codec::{CompressionTarget, Reconstruction, Scheme};
use meshlod::flock::scene::ScenarioName;
use meshlod::flock::select::{Budget, PolicyName};
use meshlod::io::Precision;
use meshlod::measure::{CertifiedOptions, DistanceOptions};
use meshlod::mesh::{Lock, Locks, VertexId};
use meshlod::multires::{ErrorKind, Storage};
use meshlod::strip::StripQuality;
use meshlod::{
    BuildOptions, CompressOptions, Constraints, Method, Options, Target, Topology, VertexLocking,
    check_report, samples, simplify,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, from_value, json, to_value};

/// Checks that options come back as they were, that no field must be given, and that a misspelt one
/// is refused.
fn options_as<T: Serialize + DeserializeOwned + Default>(options: &T, expected: &Value) {
    let written = to_value(options).unwrap();
    for (field, value) in expected.as_object().unwrap() {
        assert_eq!(&written[field], value, "{field}");
    }
    let read: T = from_value(written.clone()).unwrap();
    assert_eq!(to_value(&read).unwrap(), written);
    let of_part: T = from_value(expected.clone()).unwrap();
    assert_eq!(to_value(&of_part).unwrap(), written);
    let none: T = from_value(json!({})).unwrap();
    assert_eq!(to_value(&none).unwrap(), to_value(T::default()).unwrap());
    let error = from_value::<T>(json!({ "misspelt": 1 })).err().map(|error| error.to_string());
    assert!(error.is_some_and(|error| error.contains("unknown field `misspelt`")));
}

#[test]
fn options_come_back_and_need_no_field_and_refuse_misspelt_ones() {
    let locks = Locks { of_vertex: vec![Lock::Free, Lock::Locked], ties: vec![vec![VertexId(3)]] };
    let locks_json = json!({ "of_vertex": ["free", "locked"], "ties": [[3]] });
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
    options_as(&DistanceOptions { samples: 7, ..Default::default() }, &json!({ "samples": 7 }));
    options_as(&CertifiedOptions { floor: 0.0, ..Default::default() }, &json!({ "floor": 0.0 }));
    options_as(
        &CheckOptions { kinds: Kinds::NONE.with(Kind::BadIndex), ..Default::default() },
        &json!({ "kinds": ["bad-index"], "broad_phase": "tree" }),
    );
    let any_length = HoleLimits { edges: 8, length: f64::INFINITY };
    options_as(
        &RepairOptions { holes: Some(any_length), unused: false, ..Default::default() },
        &json!({ "holes": { "edges": 8, "length": null }, "unused": false }),
    );
    let storage = Storage { rounding: Some(0.5), ..Storage::default() };
    options_as(
        &BuildOptions { errors: ErrorKind::Bound, storage, ..Default::default() },
        &json!({ "errors": "bound", "storage": to_value(storage).unwrap() }),
    );
    options_as(
        &CompressOptions {
            target: CompressionTarget::Reduction(0.5),
            scheme: Some(Scheme::Parts(Reconstruction::Truncated)),
            strips: Some(StripQuality::Fast),
            ..Default::default()
        },
        &json!({
            "target": { "reduction": 0.5 }, "scheme": { "parts": "truncated" }, "strips": "fast",
        }),
    );
    options_as(&Budget { triangles: 9, ..Budget::default() }, &json!({ "triangles": 9 }));
}

#[test]
fn targets_name_their_unit() {
    for (target, expected) in [
        (Target::Faces(100), json!({ "faces": 100 })),
        (Target::Ratio(0.25), json!({ "ratio": 0.25 })),
        (Target::Error(0.5), json!({ "error": 0.5 })),
    ] {
        assert_eq!(to_value(target).unwrap(), expected);
        assert_eq!(from_value::<Target>(expected).unwrap(), target);
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
    names(ScenarioName::ALL, ScenarioName::to_string);
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
    let json = to_value(check_report(&mesh, &CheckOptions::default(), 1)).unwrap();
    assert_eq!(json["summary"]["duplicate-face"], 1);
    assert_eq!(json["summary"]["bad-index"], Value::Null, "only what was found");
    let findings = json["findings"].as_array().unwrap();
    let vertex = mesh.positions.len() - 1;
    assert!(findings.contains(&json!({ "kind": "unused-vertex", "vertex": vertex })), "{json}");
    assert!(findings.contains(&json!({ "kind": "duplicate-face", "face": face, "of": 7 })));
}
