//! Strips of the bunny against known results of other programs.

use meshlod_fixtures::shared_mesh;
use meshlod_mesh::Mesh;
use meshlod_strip::{
    CacheAware, StripOptions, StripQuality, StripStatistics, difference, stripify,
};

fn bunny() -> Option<Mesh> {
    let path = shared_mesh("bunny.ply")?;
    Some(meshlod_io::read(&path, &Default::default()).expect("it is whole").flatten())
}

/// Vertices and indices per face, and cache misses per face with 16 entries.
fn figures(mesh: &Mesh, options: &StripOptions) -> [f64; 3] {
    let strips = stripify(&mesh.faces, options);
    assert_eq!(difference(&strips, &mesh.faces), Default::default());
    let s = StripStatistics::new(&strips);
    let by_face = |count: usize| count as f64 / s.triangles as f64;
    [by_face(s.vertices_sent), by_face(s.indices_with_restart), s.acmr16]
}

#[test]
fn fast_strips_are_shorter_than_meshopts() {
    let Some(mesh) = bunny() else { return };
    let options = StripOptions { quality: StripQuality::Fast, ..StripOptions::default() };
    let [vertices, indices, _] = figures(&mesh, &options);
    assert!(vertices < 1.274 && indices < 1.334, "{vertices} {indices}");
}

#[test]
fn quick_strips_take_a_tenth_more_vertices_than_faces() {
    let Some(mesh) = bunny() else { return };
    let [vertices, indices, _] = figures(&mesh, &StripOptions::default());
    assert!(vertices <= 1.10 && indices <= 1.125, "{vertices} {indices}");
}

#[test]
fn strips_for_a_cache_find_most_of_it_and_are_long_all_the_same() {
    let Some(mesh) = bunny() else { return };
    let options = StripOptions { cache: Some(CacheAware::default()), ..StripOptions::default() };
    let [_, indices, misses] = figures(&mesh, &options);
    assert!(indices <= 1.30 && misses <= 0.77, "{indices} {misses}");
}
