use meshlod_fixtures::{
    charted, cone, cube, doubled_back_to_back, fan, hourglass, moebius, tetrahedron,
    with_merged_vertices,
};
use meshlod_measure::{CertifiedOptions, PreparedSurface, certified_distance, faces_beyond};
use meshlod_mesh::Mesh;
use meshlod_multires::{
    Focus, Forest, HeightField, HeightPrecision, QueryError, Storage, ViewCamera,
};
use meshlod_samples as samples;
use meshlod_simplify::Options;

use super::*;

/// Builds a file of estimates, which are too small, with coarse rounding.
fn file(mesh: &Mesh) -> ModelFile<Vec<u8>> {
    let mut forest = Forest::new(mesh, &Options::default()).unwrap();
    forest.smooth_errors();
    let rounding = Some(2e-4 * mesh.bounds().diagonal());
    written(&forest, &Storage { rounding, updates_per_chunk: 256, ..Storage::default() })
}

fn written(forest: &Forest, storage: &Storage) -> ModelFile<Vec<u8>> {
    ModelFile::Contractions(Archive::write(forest, storage).unwrap().0)
}

fn extract(file: &ModelFile<Vec<u8>>, query: &Query<'_>) -> (Mesh, Verification) {
    let VerifiedExtract { extract, verification } = extract_verified(file, query).unwrap();
    (extract.level.mesh(), verification)
}

/// Returns the faces of one mesh farther from the other than allowed, both ways.
fn beyond(a: &Mesh, b: &Mesh, limit: &(dyn Fn([[f64; 3]; 3]) -> f64 + Sync)) -> usize {
    let [a, b] = [a, b].map(|mesh| PreparedSurface::new(mesh).unwrap());
    let one_way = |from, to| faces_beyond(from, to, limit, &Default::default()).faces.len();
    one_way(&a, &b) + one_way(&b, &a)
}

#[test]
fn the_error_asked_for_is_kept() {
    for mesh in [samples::knot(6000), samples::gyroid(6000), samples::terrain(6000)] {
        let file = file(&mesh);
        let mut added = 0;
        for part in [1e-2, 3e-3, 1e-3] {
            let tolerance = part * mesh.bounds().diagonal();
            let query = Query::uniform(tolerance);
            let (cut, proof) = extract(&file, &query);
            let apart = certified_distance(&mesh, &cut, &CertifiedOptions::default()).unwrap();
            assert!(apart.symmetric().lower <= tolerance, "{part}: {apart:?}");
            assert!(proof.holds && cut.faces.len() < mesh.faces.len(), "{part}: {proof:?}");
            // By the stored errors alone it would be farther off.
            let stored = file.extract(&query).unwrap().level.mesh();
            let apart = certified_distance(&mesh, &stored, &CertifiedOptions::default()).unwrap();
            assert!(apart.symmetric().lower > tolerance, "{part}: {apart:?}");
            added += proof.added;
        }
        assert!(added > 100);
    }
}

#[test]
fn proven_errors_hold_where_rounding_allows_it_and_only_there() {
    let knot = samples::knot(3000);
    let mut forest = Forest::new(&knot, &Options::default()).unwrap();
    forest.measure_bounds();
    let coarse = Some(1e-3 * knot.bounds().diagonal());
    let bounds = written(&forest, &Storage { rounding: coarse, ..Storage::default() });
    let terrain = samples::terrain(3000);
    let field = HeightField::from_mesh(&terrain).unwrap();
    let field_within = |precision| ModelFile::open(field.to_file(precision).unwrap().0).unwrap();
    let rounded = field_within(HeightPrecision::Within(1e-3 * terrain.bounds().diagonal()));
    // The grid has diagonals of its own.
    let (grid, _) = extract(&field_within(HeightPrecision::Exact), &Query::uniform(0.0));
    for (mesh, file) in [(&knot, &bounds), (&grid, &rounded)] {
        let mut kept = [0; 2];
        for part in [1e-7, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2] {
            let tolerance = part * mesh.bounds().diagonal();
            let (cut, proof) = extract(file, &Query::uniform(tolerance));
            let apart = certified_distance(mesh, &cut, &CertifiedOptions::default()).unwrap();
            let most = if proof.holds { tolerance } else { proof.rounding };
            assert!(apart.symmetric().lower <= most, "{part}: {proof:?} {apart:?}");
            kept[usize::from(proof.holds)] += 1;
        }
        assert!(kept[0] > 0 && kept[1] > 0, "{kept:?}");
    }
}

#[test]
fn a_focus_is_within_the_error_and_the_rest_coarse() {
    let mesh = samples::knot(6000);
    let file = file(&mesh);
    let tolerance = 2e-3 * mesh.bounds().diagonal();
    let focus = Focus::Box([[0.2, -1.0, -1.0], [2.0, 1.0, 1.0]]);
    let query = Query { focus, tolerance: Tolerance::Uniform(tolerance) };
    let (cut, _) = extract(&file, &query);
    // Points to the right of the box's side, whatever face they are on.
    let inside = |corners: [[f64; 3]; 3]| {
        let is_in = corners.iter().any(|corner| corner[0] >= 0.2);
        if is_in { tolerance } else { f64::INFINITY }
    };
    assert_eq!(beyond(&mesh, &cut, &inside), 0);
    let all = |_| tolerance;
    assert!(beyond(&mesh, &cut, &all) > 0);
    let (everywhere, _) = extract(&file, &Query::uniform(tolerance));
    assert!(cut.faces.len() < everywhere.faces.len());
}

#[test]
fn pixels_are_kept_at_every_distance() {
    let mesh = samples::knot(6000);
    let file = file(&mesh);
    for eye in [[0.0, 0.5, 4.0], [0.3, 0.0, 0.0]] {
        let (look, up) = ([0.1, 0.0, -0.2], [0.0, 1.0, 0.0]);
        let camera = ViewCamera { eye, look, up, fov_rad: 0.8, viewport: [640, 480] };
        let (cut, proof) = extract(&file, &Query::pixels(camera, 2.0));
        let pixel = 2.0 * camera.pixel();
        let limit = |corners: [[f64; 3]; 3]| {
            let at = meshlod_spatial::closest_point(eye.into(), &corners.map(Into::into));
            pixel * at.distance(eye.into())
        };
        // Near the eye rounding may be more than two pixels.
        let beyond = beyond(&mesh, &cut, &limit);
        assert!(!proof.holds || beyond == 0, "{eye:?}: {beyond}");
        assert!(cut.faces.len() < mesh.faces.len());
    }
}

#[test]
fn less_than_the_rounding_gives_the_finest_mesh_and_says_so() {
    let mesh = samples::knot(2000);
    let file = file(&mesh);
    let rounding = rounding(&file);
    for tolerance in [0.0, 0.9 * rounding] {
        let (cut, proof) = extract(&file, &Query::uniform(tolerance));
        assert_eq!((cut.faces.len(), proof.holds), (mesh.faces.len(), false));
        let apart = certified_distance(&mesh, &cut, &CertifiedOptions::default()).unwrap();
        assert!(apart.symmetric().lower <= proof.rounding);
    }
    let lossless = Forest::lossless(&mesh, &Options::default()).unwrap();
    let exact = written(&lossless, &Storage::default());
    let (cut, proof) = extract(&exact, &Query::uniform(0.0));
    assert!(proof.holds && cut.faces.len() == mesh.faces.len());
    let tolerance = 1e-9 * mesh.bounds().diagonal();
    let (cut, proof) = extract(&exact, &Query::uniform(tolerance));
    let apart = certified_distance(&mesh, &cut, &CertifiedOptions::default()).unwrap();
    assert!(proof.holds && apart.symmetric().lower <= tolerance);
}

#[test]
fn any_surface_can_be_asked_for() {
    let mut soups = vec![tetrahedron(), cube(), fan(), hourglass(), moebius(9), cone(40)];
    soups.extend((0..8).map(|seed| with_merged_vertices(&samples::knot(400), 20, seed)));
    soups.push(doubled_back_to_back(&samples::knot(300)));
    for mesh in &soups {
        let forest = Forest::new(mesh, &Options::default()).unwrap();
        let file = written(&forest, &Storage::default());
        let diagonal = mesh.bounds().diagonal();
        for part in [0.0, 1e-3, 0.1, 10.0] {
            let query = Query::uniform(part * diagonal);
            let (cut, proof) = extract(&file, &query);
            assert_eq!(proof.holds, part > 1e-4, "{part}: {proof:?}");
            if proof.holds {
                assert_eq!(beyond(mesh, &cut, &|_| part * diagonal), 0, "{part}");
            }
        }
        let nowhere = Focus::Sphere { center: [1e6; 3], radius: 1.0 };
        let query = Query { focus: nowhere, ..Query::uniform(0.0) };
        assert!(extract(&file, &query).0.faces.len() <= mesh.faces.len());
    }
}

#[test]
fn a_truncated_file_is_compared_with_what_is_there() {
    let mesh = samples::knot(6000);
    let ModelFile::Contractions(archive) = file(&mesh) else { unreachable!("contractions") };
    let end = archive.chunk_ends().nth(archive.chunk_count() / 2).unwrap();
    let bytes = archive.into_source()[..end as usize].to_vec();
    let file = ModelFile::open(bytes).unwrap();
    let (finest, _) = extract(&file, &Query::uniform(0.0));
    let tolerance = 5e-3 * mesh.bounds().diagonal();
    let (cut, _) = extract(&file, &Query::uniform(tolerance));
    assert!(cut.faces.len() < finest.faces.len() && finest.faces.len() < mesh.faces.len());
    assert_eq!(beyond(&finest, &cut, &|_| tolerance), 0);
}

#[test]
fn a_measured_extract_is_within_what_is_reported() {
    let mesh = samples::knot(3000);
    let file = file(&mesh);
    let cut = file.extract_at_most(600, &Query::uniform(1.0)).unwrap().level.mesh();
    let error = measure_extract(&file, &cut).unwrap().unwrap();
    let apart = certified_distance(&mesh, &cut, &CertifiedOptions::default()).unwrap();
    let lower = apart.symmetric().lower;
    assert!(lower <= error && error < 1.02 * lower + 2.0 * rounding(&file), "{lower} {error}");
}

#[test]
fn fields_are_refused() {
    let file = file(&samples::knot(500));
    let field = |_: [f64; 3], _: f64| 0.1;
    let query = Query { focus: Focus::Everything, tolerance: Tolerance::Field(&field) };
    let refused = extract_verified(&file, &query).unwrap_err();
    assert!(matches!(refused, FileError::Query(QueryError::FieldUnchecked)), "{refused}");
}

#[test]
fn wedges_survive_the_refinement() {
    let mesh = charted(&samples::knot(4000));
    let file = file(&mesh);
    let query = Query::uniform(1e-3 * mesh.bounds().diagonal());
    let (cut, proof) = extract(&file, &query);
    assert!(proof.added > 50, "{proof:?}");
    cut.validate().unwrap();
    // A chart is a projection along an axis, so texture coordinates follow the position.
    let (bounds, attributes) = (mesh.bounds(), cut.attributes.as_ref().unwrap());
    let unit = bounds.diagonal().recip();
    for (face, corners) in cut.faces.iter().zip(&attributes.corners) {
        let uvs = corners.map(|wedge| attributes.layers[0].of(wedge));
        let chart = uvs[0][0].floor();
        let axis = chart as usize / 2;
        for (v, uv) in face.iter().zip(uvs) {
            let local = |k: usize| (cut.positions[v.index()][k] - bounds.min[k]) * unit;
            let [u, v] = [1, 2].map(|k| local((axis + k) % 3) as f32);
            assert!((uv[0] - chart - u).hypot(uv[1] - v) < 0.02, "{uv:?}: {chart} + {u}, {v}");
        }
    }
    assert!(attributes.wedge_count > cut.positions.len(), "seams stay");
}
