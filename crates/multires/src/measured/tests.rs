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
    let archive = Archive::write(&forest, &storage).unwrap().0;
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

/// Poses of a flat sheet: as it is, and with a ridge across it.
#[derive(Debug)]
struct Ridge;

/// A point of the sheet where the ridge is this high.
fn raised([x, y, z]: [f64; 3], height: f64) -> [f64; 3] {
    [x, y, z + (height - (x - 0.5).abs()).max(0.0)]
}

impl Posing for Ridge {
    fn count(&self) -> usize {
        2
    }

    fn places(&self, pose: usize, wedges: &PosedWedges<'_>) -> Vec<[f64; 3]> {
        assert!(wedges.layers.is_empty() && wedges.objects.iter().all(|&object| object == 0));
        wedges.positions.iter().map(|&at| raised(at, 0.1 * pose as f64)).collect()
    }
}

/// Flat sheet of squares, 1 by 1.
fn sheet(count: u32) -> Mesh {
    let mut sheet = meshlod_fixtures::grid(count);
    let width = sheet.bounds().max[0];
    sheet.positions.iter_mut().for_each(|at| *at = [at[0] / width, at[1] / width, 0.0]);
    sheet
}

#[test]
fn errors_in_a_pose_count_where_they_are_greater() {
    let mesh = sheet(40);
    let mut flat = forest(&mesh, Method::LindstromTurk);
    let mut posed = flat.clone();
    flat.measure_errors();
    posed.pose_by(Arc::new(Ridge));
    posed.measure_errors();
    let pairs = || flat.updates.iter().zip(&posed.updates);
    assert!(pairs().all(|(flat, posed)| posed.error >= flat.error));
    let error = 0.01;
    let [bare, cut] = [&flat, &posed].map(|forest| {
        let mut level = Model::new(forest).unwrap().extractor().uniform(error).unwrap().mesh();
        level.positions.iter_mut().for_each(|at| *at = raised(*at, 0.1));
        level
    });
    let mut ridge = mesh.clone();
    ridge.positions.iter_mut().for_each(|at| *at = raised(*at, 0.1));
    let apart = |level: &Mesh| {
        let options = CertifiedOptions::default();
        certified_distance(&ridge, level, &options).unwrap().symmetric().lower / error
    };
    assert!(apart(&cut) < 1.5 && apart(&bare) > 2.0, "{} {}", apart(&cut), apart(&bare));
    assert!(cut.faces.len() < mesh.faces.len(), "{}", cut.faces.len());
}

#[test]
fn poses_are_measured_alike_by_any_number_of_threads() {
    let forest = forest(&sheet(20), Method::LindstromTurk);
    let errors = |threads: usize| {
        let mut forest = forest.clone();
        forest.pose_by(Arc::new(Ridge));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| forest.measure_errors());
        forest.updates.iter().map(|update| update.error).collect::<Vec<_>>()
    };
    assert_eq!(errors(1), errors(4));
}
