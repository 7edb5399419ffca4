use meshlod_mesh::{Mesh, VertexId};

use super::*;
use crate::distance::{DistanceOptions, distance};
use crate::fixtures::{cube, moved, plane, scaled, sphere, tetrahedron};

fn certified(a: &Mesh, b: &Mesh, tolerance: f64) -> CertifiedDistance {
    let options = CertifiedOptions { tolerance, ..Default::default() };
    certified_distance(a, b, &options).unwrap()
}

fn encloses(bracket: &Bracket, exact: f64, tolerance: f64) {
    let Bracket { lower, upper, reached, .. } = *bracket;
    assert!(reached && lower <= exact && exact <= upper, "{lower} {exact} {upper}");
    assert!(upper <= lower * (1.0 + tolerance) + 1e-12, "{lower} {upper}");
}

/// Builds one triangle over the plane z = 0.
fn triangle(corners: [[f64; 2]; 3]) -> Mesh {
    Mesh::new(corners.map(|[x, y]| [x, y, 0.0]).to_vec(), vec![[0, 1, 2].map(VertexId)])
}

#[test]
fn a_maximum_inside_a_face_is_enclosed() {
    // The point of the great triangle farthest from its three corner pieces is its circumcenter.
    let great = triangle([[-6.0, 0.0], [6.0, 0.0], [0.0, 8.0]]);
    let mut corners = Mesh::default();
    for (i, &[x, y, _]) in great.positions.iter().enumerate() {
        corners.positions.extend([[x, y, 0.0], [x, y, 1e-9], [x, y + 1e-9, 0.0]]);
        corners.faces.push([0, 1, 2].map(|k| VertexId::new(3 * i + k)));
    }
    let apart = certified(&great, &corners, 1e-4);
    encloses(&apart.forward, 6.25, 1e-4);
    let [x, y, _] = apart.forward.place.from;
    assert!(x.hypot(y - 1.75) < 0.01, "{x} {y}");
    assert!(apart.backward.lower < 1e-8);
    // Samples of vertices alone see nothing of it.
    let samples = DistanceOptions { samples: 10, ..Default::default() };
    assert!(distance(&great, &corners, &samples).unwrap().forward.max < 6.25);
}

#[test]
fn concentric_spheres_are_enclosed_within_any_tolerance() {
    let (inner, outer) = (sphere(20, 1.0), sphere(16, 1.25));
    let samples = DistanceOptions { samples: 200_000, ..Default::default() };
    let sampled = distance(&inner, &outer, &samples).unwrap();
    for tolerance in [0.1, 0.01, 0.001] {
        let apart = certified(&inner, &outer, tolerance);
        for (way, sampled) in [(apart.forward, sampled.forward), (apart.backward, sampled.backward)]
        {
            encloses(&way, way.lower, tolerance);
            assert!(sampled.max <= way.upper && way.lower <= sampled.max * (1.0 + 1e-3));
        }
        assert_eq!(apart.symmetric().upper, apart.forward.upper.max(apart.backward.upper));
    }
}

#[test]
fn the_bounds_hold_where_a_dense_search_looks() {
    // Every fine grid point of every face, against every face.
    let (a, b) = (moved(&scaled(&tetrahedron(), 1.3), -0.1), cube());
    let apart = certified(&a, &b, 0.01);
    let steps = 120;
    for (from, to, bracket) in [(&a, &b, apart.forward), (&b, &a, apart.backward)] {
        let bvh = meshlod_spatial::Bvh::new(to).unwrap();
        let mut farthest = 0f64;
        for face in &from.faces {
            let [p, q, r] = face.map(|v| glam::DVec3::from(from.positions[v.index()]));
            for (i, j) in (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| (i, j))) {
                let [s, t] = [i, j].map(|k| f64::from(k) / f64::from(steps));
                let at = p + (q - p) * s + (r - p) * t;
                let squared = (0..to.faces.len())
                    .map(|f| bvh.distance_squared_to(at.into(), meshlod_mesh::FaceId::new(f)));
                farthest = farthest.max(squared.fold(f64::INFINITY, f64::min).sqrt());
            }
        }
        assert!(farthest <= bracket.upper, "{farthest} {bracket:?}");
        assert!(bracket.lower <= farthest + 2.0 / f64::from(steps), "{farthest} {bracket:?}");
        encloses(&bracket, bracket.lower, 0.01);
    }
}

#[test]
fn equal_surfaces_are_apart_by_rounding_at_most() {
    let mesh = moved(&sphere(20, 1.0), 1e3);
    let apart = certified(&mesh, &mesh, 0.01).symmetric();
    assert!(apart.reached && apart.lower == 0.0 && apart.upper < 1e-9, "{apart:?}");
    // One plane, triangulated twice.
    let options = CertifiedOptions { floor: 1e-4, ..Default::default() };
    let apart = certified_distance(&plane(7, 0.0), &plane(3, 0.0), &options).unwrap().symmetric();
    assert!(apart.reached && apart.lower == 0.0 && apart.upper < 2e-4, "{apart:?}");
}

#[test]
fn faces_without_area_and_unused_vertices_do_no_harm() {
    let mut odd = plane(2, 0.5);
    odd.positions.push([50.0; 3]);
    odd.faces.extend([[0, 0, 0], [0, 4, 8], [1, 1, 2]].map(|face| face.map(VertexId)));
    let apart = certified(&odd, &plane(3, 0.0), 0.01);
    encloses(&apart.forward, 0.5, 0.01);
    encloses(&apart.backward, 0.5, 0.01);
}

#[test]
fn a_search_cut_short_keeps_its_bounds_and_says_so() {
    let (a, b) = (sphere(12, 1.0), sphere(9, 1.0));
    let fine = certified(&a, &b, 1e-3).symmetric();
    let options = CertifiedOptions { tolerance: 1e-3, most_splits: 10, ..Default::default() };
    let short = certified_distance(&a, &b, &options).unwrap().symmetric();
    assert!(fine.reached && !short.reached);
    assert!(short.lower <= fine.upper && fine.lower <= short.upper);
    assert!(short.upper > fine.upper);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (a, b) = (sphere(40, 1.0), sphere(23, 1.1));
    let measure = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| certified(&a, &b, 1e-3))
    };
    assert_eq!(measure(1), measure(3));
}

#[test]
fn errors_say_which_mesh() {
    let options = CertifiedOptions::default();
    let error = certified_distance(&cube(), &Mesh::default(), &options).unwrap_err();
    assert_eq!(error.to_string(), "the second mesh: the mesh has no faces");
}
