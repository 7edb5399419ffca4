//! Real meshes with reference counts of defects from other programs.

use std::path::Path;

use meshlod_check::{
    CheckOptions, Degeneracy, Finding, Kind, Kinds, RepairOptions, RepairStep, Summary, findings,
    repair,
};
use meshlod_fixtures::{shared_broken, shared_mesh};
use meshlod_io::{ReadOptions, read};
use meshlod_mesh::Mesh;

/// File, number of boundary edges, number of non-manifold edges.
const EDGES: [(&str, usize, usize); 31] = [
    ("bishop.obj", 0, 0),
    ("eight.off", 0, 0),
    ("femur.off", 0, 0),
    ("cow.smf", 0, 0),
    ("slope.smf", 70, 0),
    ("bunny.ply", 223, 0),
    ("bunny.stl", 223, 0),
    ("bunny-closed.ply", 0, 0),
    ("feline-10k.obj", 0, 0),
    ("horse.ply", 0, 0),
    ("squirrel-20k.obj", 0, 4),
    ("fish-clown.obj", 0, 0),
    ("fish-bream.obj", 249, 0),
    ("fish-aquarium-big-a.obj", 2496, 0),
    ("fish-aquarium-big-b.obj", 2452, 0),
    ("dolphins.ply", 24, 3),
    ("dragon.ply", 4270, 0),
    ("buddha-100k.ply", 0, 50),
    ("igea.ply", 0, 0),
    ("fandisk.off", 0, 0),
    ("teapot.obj", 1036, 0),
    ("turbine.off", 0, 0),
    ("lion-head.off", 36, 0),
    ("terrain-jacksboro.ply", 1490, 0),
    ("broken/non-manifold-wrap.obj", 8, 1),
    ("broken/hourglass-vertex.obj", 0, 0),
    ("broken/fan-3-faces-1-edge.obj", 6, 1),
    ("broken/moebius.obj", 112, 0),
    ("broken/shark.ply", 186, 6),
    ("broken/beetle-non-manifold.obj", 296, 47),
    ("broken/mask-cone-touching.off", 124, 0),
];

/// File, kind of finding, number of findings.
const COUNTS: [(&str, Kind, usize); 13] = [
    ("cow-2904.off", Kind::CoincidentVertices, 1),
    ("cow-2904.off", Kind::NonManifoldVertex, 0),
    ("cow-2903.obj", Kind::NonManifoldVertex, 1),
    ("cow.smf", Kind::UnusedVertex, 1),
    ("bunny.ply", Kind::UnusedVertex, 35947 - 34834),
    ("suzanne.obj", Kind::DuplicateFace, 1),
    ("lion-head.off", Kind::BoundaryLoop, 1),
    ("broken/hourglass-vertex.obj", Kind::NonManifoldVertex, 1),
    ("broken/degenerate-faces.obj", Kind::UnusedVertex, 1),
    ("broken/degtri-sliding.off", Kind::DegenerateFace, 4),
    ("broken/mask-cone-touching.off", Kind::CoincidentVertices, 30),
    ("broken/openscad-non-manifold.obj", Kind::DegenerateFace, 1),
    ("broken/cow-flipped-edges.ply", Kind::InconsistentEdge, 12),
];

/// All kinds except intersections, which have their own tests.
fn found(mesh: &Mesh) -> Vec<Finding> {
    let kinds = Kinds::ALL.without(Kind::SelfIntersection).without(Kind::Contact);
    findings(mesh, &CheckOptions { kinds, ..CheckOptions::default() })
}

/// Reads a shared mesh; `None` if it is not available.
fn shared(name: &str) -> Option<Mesh> {
    let path = shared_mesh(name)?;
    Some(read(&path, &ReadOptions::default()).expect("a mesh").flatten())
}

#[test]
fn edges_are_as_many_as_others_counted() {
    for (name, boundary, non_manifold) in EDGES {
        let Some(mesh) = shared(name) else { continue };
        let found = found(&mesh);
        let lengths = found.iter().map(|finding| match finding {
            Finding::BoundaryLoop { vertices, closed } => vertices.len() - usize::from(!closed),
            _ => 0,
        });
        let summary: Summary = found.iter().collect();
        let counts = (lengths.sum::<usize>(), summary.count(Kind::NonManifoldEdge));
        assert_eq!(counts, (boundary, non_manifold), "{name}");
    }
}

#[test]
fn other_kinds_are_as_many_as_others_counted() {
    for (name, kind, count) in COUNTS {
        let Some(mesh) = shared(name) else { continue };
        let summary: Summary = found(&mesh).iter().collect();
        assert_eq!(summary.count(kind), count, "{name}: {}", kind.name());
    }
}

#[test]
fn coincident_vertices_beside_the_first_are_as_many_as_others_counted() {
    let Some(mesh) = shared("broken/openscad-non-manifold.obj") else { return };
    let beside = found(&mesh).into_iter().map(|finding| match finding {
        Finding::CoincidentVertices { vertices } => vertices.len() - 1,
        Finding::DegenerateFace { shape, .. } => {
            assert_eq!(shape, Degeneracy::ZeroArea);
            0
        }
        _ => 0,
    });
    assert_eq!(beside.sum::<usize>(), 59);
}

#[test]
fn repaired_meshes_have_no_errors_and_stay() {
    let whole =
        ["squirrel-20k.obj", "buddha-100k.ply", "dolphins.ply", "suzanne.obj", "sponza.obj"];
    let scans = ["pig.stl", "teapot.obj", "pirate.obj", "city.glb", "dragon.ply"];
    let files = whole.iter().chain(&scans).filter_map(|name| shared_mesh(name));
    for path in files.chain(shared_broken()) {
        repaired_has_no_errors(&path);
    }
}

fn repaired_has_no_errors(path: &Path) {
    // Only those broken files that can be read.
    let Ok(scene) = read(path, &ReadOptions::default()) else { return };
    for mesh in scene.meshes {
        let (mended, report) = repair(&mesh.mesh, &RepairOptions::default());
        assert_eq!(mended.validate(), Ok(()), "{}", path.display());
        let kinds = match report.count(RepairStep::NotOrientable) {
            0 => Kinds::errors(),
            _ => Kinds::errors().without(Kind::InconsistentEdge),
        };
        let left = findings(&mended, &CheckOptions { kinds, ..CheckOptions::default() });
        assert_eq!(left, [], "{}", path.display());
        let (again, nothing) = repair(&mended, &RepairOptions::default());
        assert!(again == mended && nothing.is_unchanged(), "{}: {nothing:?}", path.display());
    }
}
