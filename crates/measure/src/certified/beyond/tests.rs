use super::*;
use crate::certified::{CertifiedOptions, certified_one_way, certified_surface_distance};
use crate::fixtures::{cube, moved, plane, sphere, tetrahedron};

fn beyond(
    from: &Mesh,
    to: &Mesh,
    limit: impl Fn([[f64; 3]; 3]) -> f64 + Sync,
    options: &BeyondOptions<'_>,
) -> FacesBeyond {
    let [from, to] = [from, to].map(|mesh| PreparedSurface::new(mesh).unwrap());
    faces_beyond(&from, &to, &limit, options)
}

/// Returns the faces beyond a limit, in ascending order.
fn listed(from: &Mesh, to: &Mesh, limit: impl Fn([[f64; 3]; 3]) -> f64 + Sync) -> Vec<usize> {
    let beyond = beyond(from, to, limit, &BeyondOptions::default());
    assert!(beyond.faces.iter().all(|face| face.decided), "{beyond:?}");
    let mut faces: Vec<usize> = beyond.faces.iter().map(|face| face.face.index()).collect();
    faces.sort_unstable();
    faces
}

fn least_x(corners: [[f64; 3]; 3]) -> f64 {
    corners.map(|[x, ..]| x).into_iter().fold(f64::INFINITY, f64::min)
}

/// Returns the faces of a mesh with a point to the left of `x`.
fn left_of(mesh: &Mesh, x: f64) -> Vec<usize> {
    let is_left = |face: &[VertexId; 3]| least_x(face.map(|v| mesh.positions[v.index()])) < x;
    (0..mesh.faces.len()).filter(|&face| is_left(&mesh.faces[face])).collect()
}

#[test]
fn a_point_inside_a_face_decides() {
    // The point of the great triangle farthest from its three corner pieces is its circumcenter.
    let corners = [[-6.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 8.0, 0.0]];
    let great = Mesh::new(corners.to_vec(), vec![[0, 1, 2].map(VertexId)]);
    let mut pieces = Mesh::default();
    for (i, [x, y, z]) in corners.into_iter().enumerate() {
        pieces.positions.extend([[x, y, z], [x, y, 1e-9], [x, y + 1e-9, z]]);
        pieces.faces.push([0, 1, 2].map(|k| VertexId::new(3 * i + k)));
    }
    let options = BeyondOptions { slack: 1e-3, ..Default::default() };
    assert_eq!(beyond(&great, &pieces, |_| 6.25, &options).faces, []);
    let found = beyond(&great, &pieces, |_| 6.24, &options);
    let [face] = found.faces[..] else { panic!("{found:?}") };
    assert!(face.decided && (6.24..=6.25).contains(&face.distance), "{face:?}");
    let [x, y, _] = face.place.from;
    assert!(x.hypot(y - 1.75) < 0.4, "{face:?}");
    assert_eq!(listed(&pieces, &great, |_| 1e-8), Vec::<usize>::new());
}

#[test]
fn only_faces_that_reach_into_the_limited_part_are_listed() {
    let (upper, lower) = (plane(8, 0.5), plane(3, 0.0));
    let limit = |corners| if least_x(corners) < 0.375 { 0.45 } else { f64::INFINITY };
    assert_eq!(listed(&upper, &lower, limit), left_of(&upper, 0.375));
    assert_eq!(left_of(&upper, 0.375).len(), 3 * 8 * 2);
    let limit = |corners| if least_x(corners) < 0.375 { 0.55 } else { f64::INFINITY };
    assert_eq!(listed(&upper, &lower, limit), Vec::<usize>::new());
}

#[test]
fn a_limit_that_grows_with_distance_holds_at_each_point() {
    // Half a unit is allowed from x = 0.7 on: inside the sixth column of eight.
    let (upper, lower) = (plane(8, 0.5), plane(3, 0.0));
    let limit = |corners| least_x(corners) / 1.4;
    assert_eq!(listed(&upper, &lower, limit), left_of(&upper, 0.7));
    assert_eq!(left_of(&upper, 0.7).len(), 6 * 8 * 2);
}

#[test]
fn every_face_agrees_with_its_certified_distance() {
    let meshes = [sphere(10, 1.0), sphere(7, 1.02), cube(), moved(&tetrahedron(), 0.1)];
    for (from, to) in meshes.iter().zip(meshes.iter().cycle().skip(1)) {
        let surface = PreparedSurface::new(to).unwrap();
        let options = CertifiedOptions { tolerance: 1e-4, ..Default::default() };
        let distance = |face: &[VertexId; 3]| {
            let alone = Mesh::new(from.positions.clone(), vec![*face]);
            certified_one_way(&PreparedSurface::new(&alone).unwrap(), &surface, &options)
        };
        let distances: Vec<_> = from.faces.iter().map(distance).collect();
        let most = distances.iter().fold(0.0, |most: f64, face| most.max(face.upper));
        for part in [0.1, 0.5, 0.9, 0.999, 1.001] {
            let limit = part * most;
            let found = listed(from, to, |_| limit);
            for (face, distance) in distances.iter().enumerate() {
                let is_listed = found.binary_search(&face).is_ok();
                assert!(is_listed || distance.lower <= 1.01 * limit, "{face} {distance:?}");
                assert!(!is_listed || distance.upper > limit, "{face} {distance:?}");
            }
        }
    }
}

#[test]
fn chosen_faces_are_decided_like_all() {
    let (from, to) = (sphere(10, 1.0), sphere(7, 1.02));
    let [a, b] = [&from, &to].map(|mesh| PreparedSurface::new(mesh).unwrap());
    let limit =
        0.8 * certified_surface_distance(&a, &b, &CertifiedOptions::default()).forward.lower;
    let all = listed(&from, &to, |_| limit);
    let chosen: Vec<FaceId> = (0..from.faces.len()).step_by(3).map(FaceId::new).collect();
    let options = BeyondOptions { faces: Some(&chosen), ..Default::default() };
    let found = beyond(&from, &to, |_| limit, &options).faces;
    let found: Vec<usize> = found.iter().map(|face| face.face.index()).collect();
    let expected: Vec<usize> = all.iter().copied().filter(|face| face % 3 == 0).collect();
    assert_eq!(found, expected);
    assert!(!expected.is_empty() && all.len() < from.faces.len());
}

#[test]
fn what_is_not_proven_is_listed() {
    // Without divisions, or within less than rounding, nothing can be shown.
    let (from, to) = (sphere(10, 1.0), sphere(7, 1.02));
    let short = BeyondOptions { most_splits: 0, ..Default::default() };
    let found = beyond(&from, &to, |_| 0.04, &short);
    assert!(found.faces.iter().any(|face| !face.decided) && found.splits == 0);
    assert!(listed(&from, &to, |_| 0.04).len() < found.faces.len());
    for limit in [0.0, 1e-16, -1.0, f64::NAN] {
        let found = beyond(&from, &from, |_| limit, &BeyondOptions::default());
        assert_eq!(found.faces.len(), from.faces.len(), "{limit}");
    }
    assert_eq!(listed(&from, &from, |_| 1e-13), Vec::<usize>::new());
}

#[test]
fn equal_planes_need_no_division() {
    let found = beyond(&plane(7, 0.0), &plane(3, 0.0), |_| 0.2, &BeyondOptions::default());
    assert_eq!(found, FacesBeyond::default());
}

#[test]
fn any_number_of_threads_gives_the_same_list() {
    let (a, b) = (sphere(9, 1.0), sphere(13, 1.0));
    let [from, to] = [&a, &b].map(|mesh| PreparedSurface::new(mesh).unwrap());
    let most = certified_surface_distance(&from, &to, &CertifiedOptions::default()).forward.lower;
    let list = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = BeyondOptions { slack: 1e-4, most_splits: 3000, faces: None };
        pool.install(|| beyond(&a, &b, |_| 0.999 * most, &options))
    };
    let one = list(1);
    assert!(!one.faces.is_empty() && one.splits > 0 && one == list(3), "{}", one.splits);
}
