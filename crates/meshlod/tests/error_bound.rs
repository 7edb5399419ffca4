//! An error that is asked for is kept: checked against the bounds of `certified_distance`.

use meshlod::jobs::{self, Aim, SimplifyRequest};
use meshlod::measure::{CertifiedOptions, certified_distance};
use meshlod::mesh::{Lock, Locks, VertexId};
use meshlod::simplify::Simplifier;
use meshlod::{Bound, Mesh, Method, Options, Report, Scene, Target, samples, simplify};
use meshlod_fixtures as fixtures;

/// The bounds of the distance between two meshes, relative to `error`.
fn apart(a: &Mesh, b: &Mesh, error: f64) -> [f64; 2] {
    let found = certified_distance(a, b, &CertifiedOptions::default()).unwrap().symmetric();
    [found.lower / error, found.upper / error]
}

/// Simplifies to a part of the diagonal, checks the proof, and returns level and report.
fn kept(mesh: &Mesh, part: f64, options: &Options) -> (Mesh, Report) {
    let error = part * mesh.bounds().diagonal();
    let (level, report) = simplify(mesh, Target::Error(error), options).unwrap();
    let proof = report.proof.unwrap();
    assert!(proof.asked == error && proof.proved <= error, "{proof:?}");
    let [lower, upper] = apart(mesh, &level, error);
    assert!(lower <= 1.0 && upper <= 1.02, "{part}: between {lower} and {upper} of {error}");
    (level, report)
}

#[test]
fn an_error_is_kept_on_closed_open_and_textured_surfaces() {
    let mut mended = 0;
    for method in [Method::LindstromTurk, Method::Qem] {
        let options = Options { method, ..Options::default() };
        for mesh in [samples::fish(4_000), samples::terrain(5_000), samples::gyroid(8_000)] {
            for part in [0.001, 0.003, 0.01] {
                let (level, report) = kept(&mesh, part, &options);
                assert!(level.faces.len() < mesh.faces.len(), "something was contracted");
                mended += report.proof.unwrap().rounds;
            }
        }
    }
    assert!(mended > 0, "the kernel alone does not keep the error");
}

#[test]
fn methods_that_estimate_keep_an_error_too() {
    let mesh = samples::knot(2_000);
    let mut mended = 0;
    for method in [Method::QemEndpoint, Method::LeeJang, Method::Spr] {
        let (_, report) = kept(&mesh, 0.005, &Options { method, ..Options::default() });
        mended += report.proof.unwrap().rounds;
    }
    assert!(mended > 0, "their estimates alone do not keep the error");
}

#[test]
fn an_error_is_kept_where_components_vanish_and_vertices_are_held() {
    let mut pieces = samples::torus(2_000);
    for i in 0..40 {
        let first = pieces.positions.len();
        let at = |x: f64| x * 0.01 + 0.02 * f64::from(i);
        let small = samples::sphere(60);
        pieces
            .positions
            .extend(small.positions.iter().map(|p| [at(p[0]), p[1] * 0.01, 1.0 + p[2] * 0.01]));
        let face = |face: &[VertexId; 3]| face.map(|v| VertexId::new(v.index() + first));
        pieces.faces.extend(small.faces.iter().map(face));
    }
    let pieces = Mesh::new(pieces.positions, pieces.faces);
    let (_, report) = kept(&pieces, 0.02, &Options::default());
    assert!(report.vanished > 0);
    let mut locks = Locks { of_vertex: vec![Lock::Free; pieces.positions.len()], ties: Vec::new() };
    locks.of_vertex.iter_mut().step_by(7).for_each(|lock| *lock = Lock::Locked);
    kept(&pieces, 0.01, &Options { locks, ..Options::default() });
}

#[test]
fn an_error_is_kept_on_soups_and_tiny_meshes() {
    let soup = fixtures::scene(3);
    kept(&soup, 0.01, &Options::default());
    for mesh in [fixtures::tetrahedron(), fixtures::fan(), fixtures::hourglass(), fixtures::cube()]
    {
        for part in [1e-6, 0.1, 10.0] {
            kept(&mesh, part, &Options::default());
        }
    }
}

#[test]
fn what_cannot_be_proved_is_told() {
    let line = fixtures::mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]]);
    let (_, report) = simplify(&line, Target::Error(0.1), &Options::default()).unwrap();
    assert_eq!(report.proof, None, "a line has no area to measure");
    let ball = samples::sphere(500);
    let proof = |error| {
        let (_, report) = simplify(&ball, Target::Error(error), &Options::default()).unwrap();
        report.proof.map(|proof| proof.proved)
    };
    let diagonal = ball.bounds().diagonal();
    assert_eq!(proof(0.0), Some(0.0), "nothing is contracted");
    for error in [0.5e-6, 2e-6].map(|part| part * diagonal) {
        assert_eq!(proof(error), Some(error));
    }
    let plates = samples::plates(200);
    let nearly = |mesh| simplify(mesh, Target::Error(1e-300), &Options::default()).unwrap();
    let (level, report) = nearly(&plates);
    assert!(level.faces.len() == 4 && report.reached && report.proof.unwrap().proved <= 1e-300);
    // What is flat only in 32 bits, to which places are rounded on the way.
    let mut uneven = plates.clone();
    uneven.positions.iter_mut().enumerate().for_each(|(i, at)| at[1] += (i % 3) as f64 * 1e-10);
    let (level, report) = nearly(&uneven);
    assert!(level.faces.len() < uneven.faces.len() && !report.reached);
    assert!(report.proof.unwrap().proved > 0.0);
}

#[test]
fn an_error_is_kept_in_the_world() {
    let fish = samples::fish(4_000);
    let mut scene = Scene::from_mesh("fish", fish);
    let sizes = [[3.0, 0.5, 1.0], [0.1, 0.1, 0.1]];
    for (i, size) in sizes.into_iter().enumerate() {
        let mut node = scene.nodes[0].clone();
        (0..3).for_each(|axis| node.transform[axis][axis] = size[axis]);
        node.transform[3][1] = 10.0 * i as f64;
        scene.roots.push(scene.nodes.len());
        scene.nodes.push(node);
    }
    let before = scene.flatten();
    let error = 0.002 * before.bounds().diagonal();
    let target = Aim::Error(Bound::Length(error));
    let request = SimplifyRequest { target, ..SimplifyRequest::default() };
    let (scene, report) = jobs::simplify(scene, &request, &()).unwrap();
    let proof = report.run.proof.unwrap();
    assert!(report.run.reached && proof.asked == error && proof.proved == error);
    let [lower, _] = apart(&before, &scene.flatten(), error);
    assert!(lower <= 1.0 && lower > 0.3, "{lower}");
}

/// The places and the texture coordinates of the corners of a face.
fn corners(mesh: &Mesh, face: usize) -> [([f64; 3], Vec<f32>); 3] {
    let uvs = mesh.attributes.as_ref().map(|all| (all, &all.layers[0]));
    [0, 1, 2].map(|k| {
        let uv = uvs.map_or(Vec::new(), |(all, uvs)| uvs.of(all.corners[face][k]).to_vec());
        (mesh.positions[mesh.faces[face][k].index()], uv)
    })
}

#[test]
fn contractions_taken_back_change_nothing_elsewhere() {
    use meshlod::simplify::{Excess, ExcessFace};
    let face = meshlod::mesh::FaceId(100);
    let excess = Excess { face: ExcessFace::OfLevel(face), ratio: 1.05 };
    let bare = samples::knot(8_000);
    let target = Target::Error(0.003 * bare.bounds().diagonal());
    for mesh in [&bare, &fixtures::charted(&bare)] {
        let mut simplifier = Simplifier::new(mesh, &Options::default()).unwrap();
        simplifier.run(target, &mut ()).unwrap();
        let before = simplifier.level();
        assert!(simplifier.take_back(&[excess]));
        let between = simplifier.live_faces();
        assert!(between > before.faces.len());
        simplifier.run(target, &mut ()).unwrap();
        let after = simplifier.level();
        assert!(after.faces.len() <= between);
        let now: Vec<_> = (0..after.faces.len()).map(|face| corners(&after, face)).collect();
        let is_there = |&face: &usize| now.contains(&corners(&before, face));
        let same = (0..before.faces.len()).filter(is_there).count();
        assert!(same < before.faces.len() && same * 10 > before.faces.len() * 9, "{same}");
    }
    let mut estimating =
        Simplifier::new(&bare, &Options { method: Method::Spr, ..Options::default() }).unwrap();
    estimating.run(target, &mut ()).unwrap();
    assert!(!estimating.take_back(&[excess]), "the policy engine takes nothing back");
}
