//! The hierarchy against the naive search.

use glam::{DVec3, Vec3};
use meshlod_mesh::{FaceId, Mesh, MeshError, VertexId};
use proptest::prelude::*;

use crate::bvh::INNER;
use crate::triangle::closest_point;
use crate::{Bvh, BvhError, ClosestPoint, PartBvhBuilder, PartSearch, Within};

/// Tests every face, lowest id first.
fn naive(bvh: &Bvh, point: [f64; 3]) -> (FaceId, f64) {
    let p = bvh.frame.local(point);
    let mut best = (FaceId(0), f64::INFINITY);
    for face in 0..bvh.faces.len() {
        let triangle = &bvh.triangles[bvh.slots[face] as usize];
        let distance_squared = p.distance_squared(closest_point(p, triangle));
        if distance_squared < best.1 {
            best = (FaceId::new(face), distance_squared);
        }
    }
    (best.0, bvh.frame.model_squared(best.1))
}

fn check(bvh: &Bvh, point: [f64; 3], hint: Option<FaceId>) -> ClosestPoint {
    let found = bvh.closest(point, hint);
    assert_eq!((found.face, found.distance_squared), naive(bvh, point), "{point:?} {hint:?}");
    found
}

/// Small triangles, far-flung triangles, points, and repeated faces.
fn soup() -> impl Strategy<Value = Mesh> {
    let coordinate = || prop_oneof![4 => -1.0..1.0, 1 => (-2i32..3).prop_map(f64::from)];
    let position = [coordinate(), coordinate(), coordinate()];
    (prop::collection::vec(position, 3..60), 1usize..150, any::<u64>()).prop_map(
        |(positions, count, seed)| {
            let n = positions.len() as u64;
            let pick = |i: usize| VertexId::new((splat(seed, i) % n) as usize);
            let faces = (0..count).map(|f| [pick(3 * f), pick(3 * f + 1), pick(3 * f + 2)]);
            Mesh::new(positions, faces.collect())
        },
    )
}

fn splat(seed: u64, i: usize) -> u64 {
    (seed ^ (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_mul(0xD6E8_FEB8_6659_FD93)
        >> 32
}

fn moved(mut mesh: Mesh, scale: f64, offset: f64) -> Mesh {
    for x in mesh.positions.iter_mut().flatten() {
        *x = *x * scale + offset;
    }
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_answer_is_the_naive_one(
        mesh in soup(),
        queries in prop::collection::vec(prop::array::uniform3(-3.0..3.0f64), 20),
        hint in any::<u8>(),
    ) {
        let bvh = Bvh::new(&mesh).unwrap();
        for point in queries.into_iter().chain(mesh.positions.iter().copied()) {
            check(&bvh, point, None);
            check(&bvh, point, Some(FaceId(u32::from(hint))));
        }
    }

    #[test]
    fn what_is_near_is_found_and_nothing_else(
        mesh in soup(),
        point in prop::array::uniform3(-1.5f64..1.5),
        [enough, more] in prop::array::uniform2(0.0f64..0.5),
    ) {
        let bvh = Bvh::new(&mesh).unwrap();
        let (_, least) = naive(&bvh, point);
        let most = enough + more;
        match bvh.near(point, None, [enough, most]) {
            Some(found) => {
                let apart = found.distance_squared.sqrt();
                prop_assert!(apart <= most * (1.0 + 1e-12));
                prop_assert!(apart <= enough || (apart - least.sqrt()).abs() < 1e-12);
            }
            None => prop_assert!(least.sqrt() > most * (1.0 - 1e-12)),
        }
    }

    #[test]
    fn what_is_left_without_a_part_is_as_far_as_the_naive_search_says(
        mesh in soup(),
        lengths in prop::collection::vec(1usize..20, 150),
        removed in prop::collection::vec(any::<u8>(), 60),
        queries in prop::collection::vec(prop::array::uniform3(-3.0..3.0f32), 6),
    ) {
        let corner = |v: VertexId| Vec3::from_array(mesh.positions[v.index()].map(|x| x as f32));
        let triangles: Vec<[Vec3; 3]> = mesh.faces.iter().map(|face| face.map(corner)).collect();
        let (mut rest, mut parts) = (&triangles[..], Vec::new());
        let mut builder = PartBvhBuilder::default();
        for len in lengths.into_iter().take_while(|_| !rest.is_empty()) {
            let (part, others) = rest.split_at(len.min(rest.len()));
            builder.add(part.iter().copied());
            parts.push(part);
            rest = others;
        }
        let mut bvh = builder.build();
        let mut is_left = vec![true; parts.len()];
        let corners: Vec<Vec3> = triangles.iter().flatten().copied().collect();
        for removed in removed.chunks(12) {
            let mut search = PartSearch::default();
            let points = queries.iter().map(|&p| p.into()).chain(corners.clone());
            for (point, first) in points.zip((0..5).cycle()) {
                let except = [first, first / 2];
                let p = DVec3::from(point);
                let squared = |triangle: &[Vec3; 3]| {
                    p.distance_squared(closest_point(p, &triangle.map(DVec3::from)))
                };
                let others = (0..parts.len()).filter(|&i| is_left[i] && !except.contains(&(i as u32)));
                let of_part = |i: usize| parts[i].iter().map(squared).fold(f64::INFINITY, f64::min);
                let least = others.map(of_part).fold(f64::INFINITY, f64::min);
                let found = bvh.nearest(point, except, Within::ANY, &mut search);
                prop_assert_eq!(found.part == u32::MAX, least == f64::INFINITY);
                if found.part != u32::MAX {
                    let [found_at, least] = [f64::from(found.distance_squared), least].map(f64::sqrt);
                    prop_assert!((found_at - least).abs() < 2e-6, "{found_at:e} instead of {least:e}");
                    let own = of_part(found.part as usize).sqrt();
                    prop_assert!((own - least).abs() < 2e-6, "part {} is {own:e} away", found.part);
                    prop_assert!(is_left[found.part as usize] && !except.contains(&found.part));
                }
            }
            for part in removed.iter().map(|&part| usize::from(part) % parts.len()) {
                bvh.remove(part as u32);
                is_left[part] = false;
            }
        }
    }

    #[test]
    fn neither_place_nor_size_matters(
        mesh in soup(),
        scale in prop_oneof![Just(1e-30), Just(1e-3), Just(1e30)],
        query in prop::array::uniform3(-3.0..3.0f64),
    ) {
        let bvh = Bvh::new(&moved(mesh, scale, 1e6 * scale)).unwrap();
        check(&bvh, query.map(|x| x * scale + 1e6 * scale), None);
    }
}

/// A square grid of `n` by `n` squares over the unit square, in two triangles each.
fn grid(n: usize) -> Mesh {
    let at = |i: usize| i as f64 / n as f64;
    let vertex = |x: usize, y: usize| VertexId::new(y * (n + 1) + x);
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| [at(x), at(y), 0.0])).collect();
    let faces = (0..n).flat_map(|y| (0..n).map(move |x| (x, y))).flat_map(|(x, y)| {
        let [a, b, c, d] = [vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(positions, faces.collect())
}

#[test]
fn equally_close_faces_answer_by_lowest_id() {
    let mesh = grid(4);
    let bvh = Bvh::new(&mesh).unwrap();
    for (v, &corner) in mesh.positions.iter().enumerate() {
        let lowest = mesh.faces.iter().position(|face| face.contains(&VertexId::new(v))).unwrap();
        let above = [corner[0], corner[1], 0.5];
        for hint in (0..32).map(|f| Some(FaceId(f))) {
            assert_eq!(bvh.closest(above, hint).face, FaceId::new(lowest), "{hint:?}");
        }
    }
}

#[test]
fn a_point_of_the_surface_is_its_own_answer() {
    let mesh = moved(grid(8), 1.0, 1e6);
    let bvh = Bvh::new(&mesh).unwrap();
    for &point in &mesh.positions {
        let found = bvh.closest(point, None);
        assert_eq!((found.point, found.distance_squared), (point, 0.0));
    }
}

#[test]
fn far_away_points_find_the_nearest_corner() {
    let bvh = Bvh::new(&grid(64)).unwrap();
    for far in [1e3, 1e10] {
        assert_eq!(bvh.closest([far, far, 0.0], None).point, [1.0, 1.0, 0.0]);
    }
    check(&bvh, [-1e300, 1e300, 1e300], None);
}

#[test]
fn a_million_times_the_same_triangle_is_no_trouble() {
    let mut mesh = grid(1);
    mesh.faces = vec![mesh.faces[1]; 20_000];
    let bvh = Bvh::new(&mesh).unwrap();
    assert_eq!(bvh.closest([0.0, 0.5, 1.0], Some(FaceId(9_000))).face, FaceId(0));
}

/// Returns the number of levels of the subtree at `node`.
fn depth(bvh: &Bvh, node: u32) -> usize {
    let node = &bvh.nodes[node as usize];
    let inner = (0..4).filter(|&child| node.count[child] == INNER);
    1 + inner.map(|child| depth(bvh, node.first[child])).max().unwrap_or(0)
}

#[test]
fn shrinking_steps_do_not_make_the_tree_deep() {
    // Points approach the origin along the axes: split off one by one, they would make 400 levels.
    let position = |i: usize| {
        let mut position = [0.0; 3];
        position[i % 3] = 1.2f64.powi(-(i as i32 / 3));
        position
    };
    let faces = (0..1200).map(|i| [VertexId::new(i); 3]).collect();
    let bvh = Bvh::new(&Mesh::new((0..1200).map(position).collect(), faces)).unwrap();
    let depth = depth(&bvh, 0);
    assert!((6..30).contains(&depth), "{depth} levels");
    check(&bvh, [1e-20, 1.0, 1e-30], None);
}

#[test]
fn the_order_holds_every_face_once_and_follows_the_surface() {
    let mesh = grid(64);
    let bvh = Bvh::new(&mesh).unwrap();
    let mut seen = bvh.faces_in_leaf_order().to_vec();
    seen.sort();
    assert!(seen.iter().enumerate().all(|(i, face)| face.index() == i));
    let first_corner = |face: &FaceId| mesh.triangle(mesh.faces[face.index()])[0];
    let steps = bvh.faces_in_leaf_order().windows(2);
    let walked: f64 = steps.map(|w| first_corner(&w[0]).distance(first_corner(&w[1]))).sum();
    assert!(walked / mesh.faces.len() as f64 <= 3.0 / 64.0, "{walked}");
}

#[test]
fn any_number_of_threads_builds_the_same() {
    let mesh = grid(100);
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Bvh::new(&mesh)).unwrap()
    };
    let (one, three) = (build(1), build(3));
    assert_eq!(format!("{one:?}"), format!("{three:?}"));
}

#[test]
fn what_is_no_surface_is_refused() {
    assert_eq!(Bvh::new(&Mesh::default()).unwrap_err(), BvhError::Empty);
    let mut mesh = grid(1);
    mesh.positions[2][1] = f64::NAN;
    let error = Bvh::new(&mesh).unwrap_err();
    assert!(matches!(error, BvhError::Mesh(MeshError::NotFinite { .. })), "{error}");
    let point = DVec3::ZERO.into();
    mesh = Mesh::new(vec![point], vec![[VertexId(0); 3]]);
    assert_eq!(Bvh::new(&mesh).unwrap().closest([0.0, 3.0, 4.0], None).distance_squared, 25.0);
}
