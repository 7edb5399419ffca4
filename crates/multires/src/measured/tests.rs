use meshlod_measure::{CertifiedOptions, certified_distance};
use meshlod_mesh::Mesh;
use meshlod_samples as samples;
use meshlod_simplify::Method;

use super::*;
use crate::forest::NONE;
use crate::tests::walks::{each, forest};
use crate::{Archive, Model, Query, Storage, StoredErrors};

/// Checks that cuts at falling tolerances stay near the mesh, both ways.
fn holds(mesh: &Mesh, cut: impl Fn(f64) -> Mesh) {
    for part in [1e-2, 3e-3, 1e-3] {
        let tolerance = part * mesh.bounds().diagonal();
        let level = cut(tolerance);
        let apart = certified_distance(mesh, &level, &CertifiedOptions::default()).unwrap();
        let lower = apart.symmetric().lower / tolerance;
        // Points are no proof: in between, single places are farther away.
        assert!(lower < 2.0, "{part}: {lower}");
        assert!(level.faces.len() < mesh.faces.len(), "{part}");
    }
}

#[test]
fn cuts_by_measured_errors_are_within_their_tolerance() {
    for mesh in [samples::knot(8000), samples::gyroid(8000), samples::terrain(8000)] {
        let mut forest = forest(&mesh, Method::LindstromTurk);
        forest.measure_errors();
        assert_eq!(forest.error_kind(), ErrorKind::Measured);
        let model = Model::new(&forest).unwrap();
        holds(&mesh, |tolerance| model.extractor().uniform(tolerance).unwrap().mesh());
    }
}

#[test]
fn a_file_is_measured_as_it_is_rounded() {
    let mesh = samples::knot(8000);
    let mut forest = forest(&mesh, Method::LindstromTurk);
    forest.smooth_errors();
    let rounding = 5e-4 * mesh.bounds().diagonal();
    let storage =
        Storage { rounding: Some(rounding), errors: StoredErrors::Measured, ..Storage::default() };
    let archive = Archive::open(Archive::write(&forest, &storage).unwrap().0).unwrap();
    assert_eq!(archive.error_kind(), ErrorKind::Measured);
    holds(&mesh, |tolerance| archive.extract(&Query::uniform(tolerance)).unwrap().level.mesh());
}

#[test]
fn measured_errors_never_grow_along_dependencies() {
    each(|what, _, forest| {
        let mut forest = forest.clone();
        forest.measure_errors();
        let parents = forest.parents();
        for (u, update) in forest.updates.iter().enumerate() {
            let around = forest.ring(u).iter().copied().chain([forest.node(u) as u32]);
            for need in around.map(|node| parents[node as usize]).filter(|&need| need != NONE) {
                assert!(forest.updates[need as usize].error >= update.error, "{what}: {u}");
            }
        }
    });
}
