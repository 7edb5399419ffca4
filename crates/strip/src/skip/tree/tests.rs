//! Levels of merge trees, and the histories that they refuse.

use meshlod_fixtures::{grid, tetrahedron};
use meshlod_mesh::Locks;
use meshlod_samples as samples;
use meshlod_simplify::{History, Method, Options, Simplifier, Target};

use super::*;
use crate::skip::HistoryError;
use crate::strips::Strips;
use crate::verify::{Difference, difference};

/// Makes every triangle a strip of its own.
fn apart(faces: &[[VertexId; 3]]) -> Strips {
    let mut strips = Strips::default();
    faces.iter().for_each(|&face| strips.push(face));
    strips
}

#[test]
fn levels_are_those_of_the_simplification() {
    let mesh = samples::knot(1000);
    let tree = MergeTree::record(&mesh, Target::Faces(0)).unwrap();
    let options = Options { method: Method::QemEndpoint, ..Options::default() };
    let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
    for ratio in [1.0, 0.7, 0.31, 0.1] {
        let report = simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
        let surface = simplifier.surface();
        let alive = (0..surface.face_count()).map(meshlod_mesh::FaceId::new);
        let alive = alive.filter(|&face| surface.is_alive(face));
        let engine: Vec<_> = alive.map(|face| surface.face(face)).collect();
        let made = tree.contractions_to(Target::Ratio(ratio).faces_of(mesh.faces.len()));
        assert_eq!(tree.faces_left(made), report.output_faces);
        assert_eq!(difference(&apart(&engine), &tree.level(made)), Difference::default());
    }
}

#[test]
fn the_least_contractions_are_found() {
    let tree = MergeTree::record(&grid(6), Target::Faces(0)).unwrap();
    for faces in 0..=72 {
        let made = tree.contractions_to(faces);
        let is_enough = |made| tree.faces_left(made) <= faces;
        assert!(is_enough(made) || made == tree.contractions(), "{faces}");
        assert!(made == 0 || !is_enough(made - 1), "{faces}");
    }
}

#[test]
fn tied_tiles_fit_together_at_every_level() {
    // Two terrains side by side: the second is the mirror image of the first.
    let mut mesh = samples::terrain(800);
    let (vertices, right) = (mesh.positions.len(), mesh.bounds().max[0]);
    let mirrored = mesh.positions.clone();
    mesh.positions.extend(mirrored.iter().map(|&[x, y, z]| [2.0 * right - x, y, z]));
    let other = |face: &[VertexId; 3]| face.map(|v| VertexId::new(vertices + v.index()));
    let faces: Vec<_> = mesh.faces.iter().map(other).map(|[a, b, c]| [a, c, b]).collect();
    mesh.faces.extend(faces);
    let border = (0..vertices).filter(|&v| mesh.positions[v][0] == right);
    let ties: Vec<_> = border.map(|v| [v, vertices + v].map(VertexId::new).to_vec()).collect();
    let locks = Locks { of_vertex: Vec::new(), ties: ties.clone() };
    let options = Options { locks, ..Options::default() };
    let tree = MergeTree::record_with(&mesh, Target::Ratio(0.1), &options).unwrap();
    let is_whole = |made: usize| {
        let shown = |v: VertexId| {
            let mut v = v;
            while tree.turns[v.index()] < made as u32 {
                v = tree.parents[v.index()];
            }
            mesh.positions[v.index()]
        };
        ties.iter().all(|tie| shown(tie[0]) == shown(tie[1]))
    };
    assert!((0..=mesh.faces.len()).all(|faces| is_whole(tree.contractions_to(faces))));
    assert!(!(0..tree.contractions()).all(is_whole), "ties are contracted");
    assert!(tree.faces_left(tree.contractions()) <= mesh.faces.len() / 10);
}

#[test]
fn an_error_bounds_contractions_with_and_without_ties() {
    let mut mesh = samples::terrain(800);
    mesh.positions.push(mesh.positions[0]);
    let ties = vec![[0, mesh.positions.len() - 1].map(VertexId::new).to_vec()];
    for ties in [Vec::new(), ties] {
        let options =
            Options { locks: Locks { of_vertex: Vec::new(), ties }, ..Options::default() };
        let faces_at = |error| {
            let target = Target::Error(error);
            let tree = MergeTree::record_with(&mesh, target, &options).unwrap();
            tree.faces_left(tree.contractions())
        };
        let [fine, coarse] = [faces_at(1e-3), faces_at(1e-2)];
        assert!(mesh.faces.len() > fine && fine > coarse && coarse > 20, "{fine} {coarse}");
    }
}

#[test]
fn a_history_that_moves_points_is_refused() {
    let mesh = samples::sphere(200);
    let mut history = History::default();
    let mut simplifier = Simplifier::new(&mesh, &Options::default()).unwrap();
    simplifier.run(Target::Ratio(0.5), &mut history).unwrap();
    assert_eq!(MergeTree::from_history(&mesh, &history).err(), Some(HistoryError::Moves(0)));
}

#[test]
fn a_history_of_another_mesh_is_refused() {
    let options = Options { method: Method::QemEndpoint, ..Options::default() };
    let mut history = History::default();
    let mesh = samples::sphere(200);
    let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
    simplifier.run(Target::Ratio(0.5), &mut history).unwrap();
    for other in [samples::torus(200), tetrahedron()] {
        let error = MergeTree::from_history(&other, &history).err();
        assert!(matches!(error, Some(HistoryError::Foreign(_))), "{error:?}");
    }
}

#[test]
fn faces_without_three_corners_and_repeated_ones_are_left_out() {
    let faces = [[0, 1, 2], [1, 2, 0], [3, 3, 1], [2, 1, 0]].map(|f: [u32; 3]| f.map(VertexId));
    let mesh = Mesh::new(vec![[0.0; 3]; 4], faces.to_vec());
    let whole = MergeTree::new(&mesh);
    let whole: Vec<_> = whole.faces().iter().map(|f| f.map(|v| v.0)).collect();
    assert_eq!(whole, [[0, 1, 2], [2, 1, 0]]);
}
