//! Locks, ties and fusing: the same options in every verb that simplifies or compresses.

use std::collections::{BTreeMap, BTreeSet};

use meshlod::mesh::{Connectivity, FaceId, Side, Twin, VertexId};
use meshlod::{Mesh, ReadOptions, Scene, WriteOptions, samples};

use crate::run::Run;

type Bits = [u64; 3];

fn bits(position: [f64; 3]) -> Bits {
    // -0 is at the same place as 0.
    position.map(|x| (x + 0.0).to_bits())
}

/// Two terrains side by side, the second the mirror image of the first, in 32-bit coordinates. They
/// share no vertex.
fn tiles() -> Mesh {
    let mut mesh = samples::terrain(800);
    let single = |p: &[f64; 3]| p.map(|x| f64::from(x as f32));
    mesh.positions = mesh.positions.iter().map(single).collect();
    let (vertices, right) = (mesh.positions.len(), mesh.bounds().max[0]);
    let mirrored: Vec<_> =
        mesh.positions.iter().map(|&[x, y, z]| [2.0 * right - x, y, z]).collect();
    mesh.positions.extend(mirrored.iter().map(single));
    let other = |face: &[VertexId; 3]| face.map(|v| VertexId::new(vertices + v.index()));
    let faces: Vec<_> = mesh.faces.iter().map(other).map(|[a, b, c]| [a, c, b]).collect();
    mesh.faces.extend(faces);
    mesh
}

/// Two balls that cross.
fn balls() -> Mesh {
    let mut mesh = samples::sphere(600);
    let (vertices, faces) = (mesh.positions.len(), mesh.faces.clone());
    let moved: Vec<_> = mesh.positions.iter().map(|[x, y, z]| [x + 1.0, y + 0.1, *z]).collect();
    mesh.positions.extend(moved);
    mesh.faces.extend(faces.iter().map(|f| f.map(|v| VertexId::new(vertices + v.index()))));
    mesh
}

fn write(run: &Run, name: &str, mesh: Mesh) {
    meshlod::write(run.path(name), &Scene::from_mesh("", mesh), &WriteOptions::default()).unwrap();
}

fn read(run: &Run, name: &str) -> Mesh {
    meshlod::read(run.path(name), &ReadOptions::default()).unwrap().into_mesh()
}

/// Returns the positions on the boundary.
fn boundary(mesh: &Mesh) -> BTreeSet<Bits> {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let on = |v: &usize| connectivity.marks(VertexId::new(*v)).boundary();
    (0..mesh.positions.len()).filter(on).map(|v| bits(mesh.positions[v])).collect()
}

/// Returns the number of places with more than one used vertex.
fn shared_places(mesh: &Mesh) -> usize {
    let used = mesh.used_vertices();
    let mut at: BTreeMap<Bits, usize> = BTreeMap::new();
    let there = mesh.positions.iter().zip(used).filter(|(_, used)| *used);
    there.for_each(|(p, _)| *at.entry(bits(*p)).or_default() += 1);
    at.values().filter(|&&count| count > 1).count()
}

/// Returns the boundary edges by the positions of their ends, sorted.
fn boundary_edges(mesh: &Mesh) -> Vec<[Bits; 2]> {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let sides =
        (0..mesh.faces.len()).flat_map(|f| (0..3).map(move |k| Side::new(FaceId::new(f), k)));
    let open = sides.filter(|&side| connectivity.twin(side) == Twin::Boundary);
    let ends = open.map(|side| side.ends(&mesh.faces).map(|v| bits(mesh.positions[v.index()])));
    let mut edges: Vec<_> = ends.collect();
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    edges.sort_unstable();
    edges
}

/// Returns the edges that both tiles have: a boundary edge of each.
fn common_edges(mesh: &Mesh) -> Vec<[Bits; 2]> {
    let edges = boundary_edges(mesh);
    edges.windows(2).filter(|two| two[0] == two[1]).map(|two| two[0]).collect()
}

/// Returns true if the tiles make one disc without a hole where they have edges in common, by the
/// Euler number.
fn fits(mesh: &Mesh) -> bool {
    let used = mesh.used_vertices();
    let there = mesh.positions.iter().zip(used).filter(|(_, used)| *used);
    let vertices = there.map(|(p, _)| bits(*p)).collect::<BTreeSet<_>>().len();
    let (faces, common) = (mesh.faces.len(), common_edges(mesh).len());
    let edges = (3 * faces + boundary_edges(mesh).len()) / 2 - common;
    common >= 2 && vertices + faces == edges + 1
}

/// Rebuilds the levels of a file of strips.
fn strip_levels(run: &Run, name: &str, positions: &[[f64; 3]]) -> Vec<Mesh> {
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(run.path(name)).unwrap()).unwrap();
    // A fused mesh has vertices of its own.
    let fused: Option<Vec<[f64; 3]>> =
        json.get("positions").map(|list| serde_json::from_value(list.clone()).unwrap());
    let positions = fused.as_deref().unwrap_or(positions);
    // Where objects meet, strips have wedges, of which several are at one vertex.
    let vertex = |v: &serde_json::Value| {
        let wedge = v.as_u64().unwrap() as usize;
        let wedges = json.get("wedges");
        wedges.map_or(wedge, |wedges| wedges[wedge]["vertex"].as_u64().unwrap() as usize) as u32
    };
    let level = |level: &serde_json::Value| {
        let mut faces = Vec::new();
        for strip in level["strips"].as_array().unwrap() {
            let strip: Vec<u32> = strip.as_array().unwrap().iter().map(vertex).collect();
            for three in strip.windows(3) {
                let [a, b, c] = [three[0], three[1], three[2]];
                if a != b && b != c && c != a {
                    faces.push([a, b, c].map(VertexId));
                }
            }
        }
        Mesh::new(positions.to_vec(), faces)
    };
    json["levels"].as_array().unwrap().iter().map(level).collect()
}

/// Runs every verb that simplifies, down to a tenth of the faces, and returns the levels by verb.
fn levels(run: &Run, file: &str, options: &[&str]) -> Vec<(&'static str, Mesh)> {
    let go = |arguments: &[&str]| {
        run.json(&[arguments, options].concat());
    };
    go(&["simplify", file, "s.ply", "--ratio", "10%"]);
    go(&["lods", file, "l.ply", "--levels", "50%,10%"]);
    go(&["build", file, "b.mlod", "--lossless"]);
    for (name, error) in [("fine", "1%"), ("coarse", "100%")] {
        let out = format!("b-{name}.ply");
        run.json(&["extract", "b.mlod", &out, "--error", error, "--precision", "f64"]);
    }
    go(&[
        "strip", file, "--levels", "40%,10%", "--filter", "repair", "--out", "t.json", "--verify",
    ]);
    go(&["compare", file, "--ratio", "10%", "--methods", "qem", "--no-pictures", "--out", "c"]);
    let positions = read(run, file).positions;
    let files = ["s.ply", "l_LOD1.ply", "l_LOD2.ply", "b-fine.ply", "b-coarse.ply", "c/qem-10.ply"];
    let mut levels: Vec<_> = files.into_iter().map(|file| (file, read(run, file))).collect();
    levels.extend(strip_levels(run, "t.json", &positions).into_iter().map(|mesh| ("strip", mesh)));
    levels
}

#[test]
fn a_locked_boundary_is_in_every_level_of_every_verb() {
    let run = Run::new();
    write(&run, "in.ply", tiles());
    let expected = boundary(&read(&run, "in.ply"));
    for (what, level) in levels(&run, "in.ply", &["--lock-boundary", "--no-stitch"]) {
        assert!(boundary(&level) == expected, "{what}");
        assert!(level.faces.len() < 1100, "{what}: {}", level.faces.len());
    }
    for (what, level) in levels(&run, "in.ply", &["--topology", "keep"]) {
        assert!(boundary(&level) != expected, "{what}");
    }
}

#[test]
fn tied_tiles_fit_in_every_level_of_every_verb() {
    let run = Run::new();
    write(&run, "in.ply", tiles());
    assert!(fits(&read(&run, "in.ply")));
    let tied = ["--topology", "keep", "--lock-contacts"];
    for (what, level) in levels(&run, "in.ply", &tied) {
        assert!(fits(&level), "{what}");
    }
    let free = levels(&run, "in.ply", &tied[..2]);
    assert!(free.iter().any(|(_, level)| !fits(level)));
    // What is locked stays as it was.
    let whole = common_edges(&read(&run, "in.ply"));
    for (what, level) in levels(&run, "in.ply", &["--topology", "keep", "--lock-contacts=exclude"])
    {
        assert!(common_edges(&level) == whole, "{what}");
    }
}

#[test]
fn locks_from_a_file_hold_in_every_verb() {
    let run = Run::new();
    write(&run, "in.ply", tiles());
    let mesh = read(&run, "in.ply");
    let locked = [7, 100, 333];
    let flags: Vec<u8> = (0..mesh.positions.len()).map(|v| u8::from(locked.contains(&v))).collect();
    let json = serde_json::json!({ "format": "meshlod-locks", "version": 1,
        "meshes": [{ "flags": flags }] });
    std::fs::write(run.path("l.json"), json.to_string()).unwrap();
    for (what, level) in levels(&run, "in.ply", &["--locks", "l.json"]) {
        let used = level.used_vertices();
        let there: BTreeSet<Bits> = level
            .positions
            .iter()
            .zip(used)
            .filter(|(_, used)| *used)
            .map(|(p, _)| bits(*p))
            .collect();
        for v in locked {
            assert!(there.contains(&bits(mesh.positions[v])), "{what}: {v}");
        }
    }
}

#[test]
fn rounded_levels_have_locked_vertices_within_the_rounding() {
    let run = Run::new();
    write(&run, "in.ply", tiles());
    let built = run.json(&["build", "in.ply", "b.mlod", "--lock-boundary"]);
    let rounding = built["rounding"].as_f64().unwrap();
    assert!(built["held"]["locked"].as_u64() > Some(0) && rounding > 0.0);
    run.json(&["extract", "b.mlod", "b.ply", "--error", "100%", "--precision", "f64"]);
    let level = read(&run, "b.ply");
    for place in boundary(&read(&run, "in.ply")) {
        let place = place.map(f64::from_bits);
        let far = |p: &[f64; 3]| (0..3).map(|k| (p[k] - place[k]).powi(2)).sum::<f64>().sqrt();
        let nearest = level.positions.iter().map(far).fold(f64::INFINITY, f64::min);
        assert!(nearest <= 1.001 * rounding, "{nearest} of {rounding}");
    }
}

#[test]
fn every_verb_fuses() {
    let run = Run::new();
    write(&run, "in.ply", balls());
    for (what, level) in levels(&run, "in.ply", &["--fuse"]) {
        let connectivity = Connectivity::new(&level.faces, level.positions.len());
        assert!(connectivity.is_closed(), "{what}");
        let (_, components) = meshlod::mesh::face_components(&level.faces, level.positions.len());
        assert_eq!(components, 1, "{what}");
        // Ratios refer to the faces before fusing.
        assert!(what.starts_with("b-") || level.faces.len() <= 600, "{what}");
    }
    let packed = run.json(&["compress", "in.ply", "c.mlq", "--fuse"]);
    assert_eq!(packed["fused"]["input_faces"], balls().faces.len());
    assert_eq!(packed["faces"], packed["fused"]["output_faces"]);
}

#[test]
fn compressed_contacts_stay_together() {
    let run = Run::new();
    write(&run, "in.ply", tiles());
    let expected = shared_places(&read(&run, "in.ply"));
    assert!(expected > 10);
    let shared = |file: &str, options: &[&str]| {
        run.json(&[&["compress", "in.ply", file], options].concat());
        if file.ends_with("glb") {
            return shared_places(
                &meshlod::read(run.path(file), &ReadOptions { weld: meshlod::io::Weld::Off })
                    .unwrap()
                    .into_mesh(),
            );
        }
        run.json(&["decompress", file, "d.ply", "--precision", "f64"]);
        shared_places(&read(&run, "d.ply"))
    };
    for file in ["a.mlq", "a.mlz", "a.glb"] {
        for bits in ["9", "14"] {
            let here = shared(file, &["--lock-contacts", "--bits", bits]);
            assert!(here >= expected, "{file}, {bits}: {here} of {expected}");
        }
    }
    assert!(shared("a.mlq", &["--bits", "11"]) < expected, "blocks have grids of their own");
}

#[test]
fn what_a_verb_cannot_hold_is_refused() {
    let run = Run::new();
    write(&run, "in.ply", samples::terrain(200));
    let refused: &[(&[&str], &str)] = &[
        (&["build", "in.ply", "a.mlod", "--topology", "free"], "keeps the topology"),
        (&["build", "in.ply", "a.mlod", "--vanish-below", "1%"], "keeps the topology"),
        (
            &["build", "in.ply", "a.mlod", "--model", "right-triangles", "--lock-boundary"],
            "right-triangles",
        ),
        (&["build", "in.ply", "a.mlod", "--model", "right-triangles", "--fuse"], "right-triangles"),
        (&["strip", "in.ply", "--topology", "free"], "keep the topology"),
        (&["compress", "in.ply", "a.mlq", "--topology", "free"], "changes no topology"),
        (&["compress", "in.ply", "a.mlq", "--lock-boundary"], "no lock holds"),
        (&["compress", "in.ply", "a.mlz", "--lock-contacts=exclude"], "no lock holds"),
        (&["compress", "in.ply", "a.mlz", "--locks", "a.json"], "no lock holds"),
        (&["compress", "in.ply", "a.mlq", "--lock-contacts", "--scheme", "blocks"], "one grid"),
        (&["lods", "in.ply", "a.ply", "--lock-contacts=always"], "possible values"),
        (
            &["compare", "in.ply", "--ratio", "1%", "--out", "c", "--fuse", "--locks", "a.json"],
            "cannot be used",
        ),
    ];
    for (arguments, reason) in refused {
        let done = run.run(arguments);
        assert_eq!(done.code, 2, "{arguments:?}: {done:?}");
        assert!(format!("{done:?}").contains(reason), "{arguments:?}: {done:?}");
    }
}
