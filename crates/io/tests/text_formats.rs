//! OBJ, OFF and SMF: the shared files against known counts and against tobj.

use std::fs;

use meshlod_fixtures::shared_mesh;
use meshlod_io::{ParseError, obj, off, smf};
use meshlod_mesh::{Connectivity, LayerKind, Mesh};

fn read(name: &str, bytes: &[u8]) -> Result<Mesh, ParseError> {
    let mesh = match name.rsplit('.').next() {
        Some("obj") => obj::read(bytes, &mut |_| None)?.meshes.remove(0).mesh,
        Some("off") => off::read(bytes)?,
        _ => smf::read(bytes)?,
    };
    assert_eq!(mesh.validate(), Ok(()), "{name}");
    Ok(mesh)
}

/// File, vertices, triangles, boundary edges, non-manifold edges; `None` where polygons were
/// counted instead.
type Known = (&'static str, usize, usize, Option<(usize, usize)>);

const CLOSED: Option<(usize, usize)> = Some((0, 0));

const GOOD: [Known; 31] = [
    ("bishop.obj", 250, 496, CLOSED),
    ("eight.off", 766, 1536, CLOSED),
    ("femur.off", 3897, 7798, CLOSED),
    ("triceratops.off", 2832, 5660, CLOSED),
    ("cow-2904.off", 2904, 5804, CLOSED),
    ("cow-2903.obj", 2903, 5804, CLOSED),
    ("cow.smf", 2904, 5804, CLOSED),
    ("slope.smf", 1252, 2432, Some((70, 0))),
    ("bones.smf", 2154, 4204, CLOSED),
    ("feline-10k.obj", 4998, 10000, CLOSED),
    ("squirrel-20k.obj", 10160, 20336, Some((0, 4))),
    ("fish-blub-low.obj", 945, 1886, CLOSED),
    ("fish-bream.obj", 1988, 3707, Some((249, 0))),
    ("fish-clown.obj", 1356, 2672, CLOSED),
    ("fish-aquarium-big-a.obj", 2496, 832, Some((2496, 0))),
    ("fish-aquarium-small-a.obj", 138, 46, Some((138, 0))),
    ("buddha-20k.obj", 9990, 20000, CLOSED),
    ("max-planck-25k.off", 12556, 25108, CLOSED),
    ("fandisk.off", 6475, 12946, CLOSED),
    ("rocker-arm.obj", 10044, 20088, CLOSED),
    ("spot.obj", 2930, 5856, CLOSED),
    ("suzanne.obj", 507, 968, None),
    ("teapot.obj", 3644, 6320, Some((1036, 0))),
    ("homer.obj", 6002, 12000, CLOSED),
    ("pirate.obj", 2889, 5010, Some((740, 0))),
    ("turbine.off", 9210, 18460, CLOSED),
    ("lion-head.off", 8356, 16674, Some((36, 0))),
    ("skyscraper.obj", 2022, 3692, CLOSED),
    ("sponza.obj", 60848, 66450, None),
    ("fish-aquarium-big-b.obj", 2452, 824, Some((2452, 0))),
    ("fish-aquarium-medium-a.obj", 456, 152, Some((456, 0))),
];

#[test]
fn shared_meshes_have_their_known_counts() {
    for (name, vertices, faces, edges) in GOOD {
        let Some(path) = shared_mesh(name) else { continue };
        let mesh = read(name, &fs::read(path).unwrap()).unwrap();
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (vertices, faces), "{name}");
        if let Some(edges) = edges {
            assert_eq!(edge_counts(&mesh), edges, "{name}");
        }
    }
}

/// Counts boundary edges and non-manifold edges.
fn edge_counts(mesh: &Mesh) -> (usize, usize) {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    (connectivity.boundary_edges(), connectivity.non_manifold_edges())
}

#[test]
fn odd_but_valid_files_are_read() {
    for (name, vertices, faces) in [
        ("negative-indices.obj", 8, 12),
        ("line-continuation.obj", 92, 66),
        ("nan-color.obj", 8, 12),
        ("single-normal.obj", 4, 2),
        ("whitespace.off", 8, 12),
        ("comments.off", 8, 12),
        ("degenerate-triangle.obj", 3, 1),
        ("degenerate-faces.obj", 6, 4),
        ("non-manifold-wrap.obj", 10, 12),
        ("no-final-newline.obj", 3, 1),
        ("hourglass-vertex.obj", 23, 40),
        ("fan-3-faces-1-edge.obj", 5, 3),
        ("moebius.obj", 280, 448),
        ("blobby-flipped-faces.off", 2027, 4050),
        ("degtri-sliding.off", 8, 8),
        ("triangle-through-tetra.off", 7, 5),
        ("mask-cone-touching.off", 1230, 2332),
        ("beetle-non-manifold.obj", 1148, 2053),
        ("openscad-non-manifold.obj", 717, 1442),
        ("nm-edges-simple-noff.off", 12, 8),
        ("non-manifold-face-graph.off", 24, 21),
        ("degtri-four.off", 5, 4),
        ("all-degenerate.off", 7, 7),
        ("not-enough-indices.obj", 3, 1),
    ] {
        let Some(path) = shared_mesh(&format!("broken/{name}")) else { continue };
        let mesh = read(name, &fs::read(path).unwrap()).unwrap();
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (vertices, faces), "{name}");
    }
}

#[test]
fn broken_files_give_one_line_with_the_place() {
    for (name, message) in [
        ("zero-bytes.obj", "byte 0: the file is empty"),
        ("zero-bytes.off", "byte 0: the file is empty"),
        ("malformed-index.obj", "line 28: a face refers to vertex 0, but indices start at 1"),
        ("utf16-be.obj", "byte 0: this is UTF-16 text; save it as UTF-8"),
        ("number-formats.obj", "line 11: \"3.1+e2\" is not a number"),
        ("points-only.obj", "line 11: the file ends without faces (8 vertices)"),
        ("wireframe-only.obj", "line 23: the file ends without faces (8 vertices)"),
        ("inf-nan.obj", "line 1: \"inf\" is not a finite number"),
        (
            "huge-count.off",
            "line 2: the header declares 353535235358 vertices and 6 faces, but only 289 bytes follow",
        ),
        ("bunny-damaged.smf", "byte 1901: a zero byte: this is not a text file"),
    ] {
        let Some(path) = shared_mesh(&format!("broken/{name}")) else { continue };
        let error = read(name, &fs::read(path).unwrap()).unwrap_err().to_string();
        assert_eq!(error, message, "{name}");
    }
}

/// Compares the positions, uvs and normals of all corners with those that tobj reads.
#[test]
fn obj_says_the_same_as_tobj() {
    for (name, ..) in GOOD {
        let Some(path) = shared_mesh(name).filter(|_| name.ends_with(".obj")) else { continue };
        let bytes = fs::read(path).unwrap();
        let mesh = read(name, &bytes).unwrap();
        let (models, _) = tobj::load_obj_buf(
            &mut &bytes[..],
            &tobj::LoadOptions { triangulate: false, ..Default::default() },
            |_| Ok(Default::default()),
        )
        .unwrap();
        let mut ours: Vec<String> = corners(&mesh);
        let mut theirs: Vec<String> = models.iter().flat_map(|m| their_corners(&m.mesh)).collect();
        for corners in [&mut ours, &mut theirs] {
            corners.sort();
            // Triangulation repeats corners of polygons.
            corners.dedup();
        }
        assert_eq!(ours.len(), theirs.len(), "{name}");
        for (ours, theirs) in ours.iter().zip(&theirs) {
            assert_eq!(ours, theirs, "{name}");
        }
    }
}

/// Formats position, uv and normal of every corner, rounded to 32 bits.
fn corners(mesh: &Mesh) -> Vec<String> {
    let layer = |kind| mesh.attributes.as_ref().and_then(|attributes| attributes.layer(kind));
    let (uvs, normals) = (layer(LayerKind::Uv(0)), layer(LayerKind::Normal));
    let mut corners = Vec::new();
    for (i, face) in mesh.faces.iter().enumerate() {
        for (corner, v) in face.iter().enumerate() {
            let of = |layer: Option<&meshlod_mesh::Layer>| {
                let wedge = mesh.attributes.as_ref()?.corners[i][corner];
                Some(layer?.of(wedge).to_vec())
            };
            let position = mesh.positions[v.index()].map(|x| x as f32);
            corners.push(format!("{position:?} {:?} {:?}", of(uvs), of(normals)));
        }
    }
    corners
}

fn their_corners(mesh: &tobj::Mesh) -> Vec<String> {
    let of = |values: &[f32], indices: &[u32], corner: usize, width: usize| {
        let at = *indices.get(corner)? as usize * width;
        Some(values[at..at + width].to_vec())
    };
    (0..mesh.indices.len())
        .map(|corner| {
            let position = of(&mesh.positions, &mesh.indices, corner, 3).unwrap();
            let uv = of(&mesh.texcoords, &mesh.texcoord_indices, corner, 2);
            let normal = of(&mesh.normals, &mesh.normal_indices, corner, 3);
            format!("{position:?} {uv:?} {normal:?}")
        })
        .collect()
}
