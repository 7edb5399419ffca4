use meshlod_samples as samples;

use super::*;

const CONTACTS: LockOptions =
    LockOptions { contacts: Some(ContactPolicy::Tie), boundary: Lock::Free };

/// Merges two meshes as components of one.
fn both(mut a: Mesh, b: &Mesh) -> Mesh {
    let base = a.positions.len();
    a.positions.extend(&b.positions);
    a.faces.extend(b.faces.iter().map(|face| face.map(|v| VertexId::new(base + v.index()))));
    a
}

/// Builds the square from (x, 0) to (x + side, side) at a height, with two faces.
fn square(x: f64, side: f64, z: f64) -> Mesh {
    let positions = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
    let faces = [[0, 1, 2], [0, 2, 3]].map(|face| face.map(VertexId));
    Mesh::new(positions.map(|[dx, y]| [x + dx, y, z]).into(), faces.into())
}

fn moved(mut mesh: Mesh, [x, y, z]: [f64; 3]) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = [p[0] + x, p[1] + y, p[2] + z]);
    mesh
}

#[test]
fn balls_that_cross_are_protected_where_they_do() {
    let balls = both(samples::sphere(2000), &moved(samples::sphere(2000), [1.0, 0.0, 0.0]));
    let locking = locks(&balls, &CONTACTS);
    // Spheres of radius 1 cross at x = 0.5.
    let away = |v: usize| (balls.positions[v][0] - 0.5).abs();
    for (v, lock) in locking.locks.of_vertex.iter().enumerate() {
        match lock {
            Lock::Locked => panic!("{v} is locked"),
            Lock::Protected => assert!(away(v) < 0.12, "{v} {}", away(v)),
            Lock::Free => assert!(away(v) > 0.03, "{v} {}", away(v)),
        }
    }
    assert!(locking.count(LockReason::Crossing) > 50);
}

#[test]
fn balls_apart_are_free() {
    let balls = both(samples::sphere(500), &moved(samples::sphere(500), [2.1, 0.0, 0.0]));
    let locking = locks(&balls, &CONTACTS);
    assert!(locking.reasons.iter().all(Option::is_none));
    assert!(locking.locks.of_vertex.iter().all(|lock| *lock == Lock::Free));
}

#[test]
fn squares_side_by_side_are_tied() {
    let locking = locks(&both(square(0.0, 1.0, 0.0), &square(1.0, 1.0, 0.0)), &CONTACTS);
    assert_eq!(locking.locks.ties, [[1, 4], [2, 7]].map(|tie| tie.map(VertexId)));
    assert_eq!(locking.locks.of_vertex, [Lock::Free; 8]);
    assert_eq!(locking.count(LockReason::SharedPosition), 4);
}

#[test]
fn a_tie_with_a_protected_vertex_is_protected() {
    let squares = both(square(0.0, 1.0, 0.0), &square(1.0, 1.0, 0.0));
    // A third square stands in the middle of the second, across its diagonal.
    let mut third = square(1.2, 0.2, 0.0);
    third.positions = third.positions.iter().map(|&[x, y, _]| [x, 0.25, y - 0.1]).collect();
    let locking = locks(&both(squares, &third), &CONTACTS);
    let protected = |v: usize| locking.locks.of_vertex[v] == Lock::Protected;
    assert!((4..7).all(protected), "{locking:?}");
    assert!(protected(1), "tied to a protected one");
    assert!(!protected(0) && !protected(3));
    assert_eq!(locking.locks.ties.len(), 2);
}

#[test]
fn a_box_on_the_ground_holds_its_foot_and_the_ground() {
    let ground = square(0.0, 10.0, 0.0);
    // An upright face with its lower edge in the ground's first face.
    let wall = Mesh::new(
        vec![[4.0, 1.0, 0.0], [5.0, 1.0, 0.0], [4.5, 1.0, 1.0]],
        vec![[0, 1, 2].map(VertexId)],
    );
    let locking = locks(&both(ground, &wall), &CONTACTS);
    let protected: Vec<usize> =
        (0..7).filter(|&v| locking.locks.of_vertex[v] == Lock::Protected).collect();
    assert_eq!(protected, [0, 1, 2, 4, 5], "the wall's top is free, and the ground's far corner");
}

#[test]
fn one_in_the_other_and_one_on_the_other_in_one_plane() {
    let locking = locks(&both(square(0.0, 1.0, 0.0), &square(0.4, 0.2, 0.0)), &CONTACTS);
    // The small one lies in the first face of the large one.
    let free = |v: &usize| locking.locks.of_vertex[*v] == Lock::Free;
    assert_eq!((0..8).filter(free).collect::<Vec<_>>(), [3], "{locking:?}");
    assert_eq!(locking.count(LockReason::Overlap), 7);
    // Two copies of a face move as one.
    let locking = locks(&both(square(0.0, 1.0, 0.0), &square(0.0, 1.0, 0.0)), &CONTACTS);
    assert_eq!(locking.locks.ties.len(), 4);
    assert_eq!(locking.count(LockReason::SharedPosition), 8);
}

#[test]
fn boundaries_are_what_is_asked_for() {
    let mesh = samples::terrain(500);
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    for lock in [Lock::Free, Lock::Protected, Lock::Locked] {
        let locking = locks(&mesh, &LockOptions { contacts: None, boundary: lock });
        for (v, of) in locking.locks.of_vertex.iter().enumerate() {
            let at = connectivity.marks(VertexId::new(v)).boundary();
            assert_eq!(*of, if at { lock } else { Lock::Free });
        }
    }
}

#[test]
fn a_tie_at_the_boundary_is_what_the_boundary_is() {
    let squares = both(square(0.0, 1.0, 0.0), &square(1.0, 1.0, 0.0));
    let at_boundary = |boundary| LockOptions { boundary, ..CONTACTS };
    let locking = locks(&squares, &at_boundary(Lock::Locked));
    assert_eq!(locking.locks.of_vertex, [Lock::Locked; 8]);
    assert!(locking.locks.ties.is_empty());
    let locking = locks(&squares, &at_boundary(Lock::Protected));
    assert_eq!(locking.locks.of_vertex, [Lock::Protected; 8]);
    assert_eq!(locking.locks.ties.len(), 2);
}

#[test]
fn policies_hold_the_same_vertices_by_other_means() {
    let mut balls = both(samples::sphere(500), &moved(samples::sphere(500), [1.0, 0.0, 0.0]));
    // Two squares beside them share an edge.
    let base = balls.positions.len();
    let squares = both(square(9.0, 1.0, 0.0), &square(10.0, 1.0, 0.0));
    balls = both(balls, &squares);
    let by = |contacts| locks(&balls, &LockOptions { contacts: Some(contacts), ..CONTACTS });
    let tied = by(ContactPolicy::Tie);
    for (policy, lock) in
        [(ContactPolicy::Protect, Lock::Protected), (ContactPolicy::Exclude, Lock::Locked)]
    {
        let held = by(policy);
        assert_eq!(held.reasons, tied.reasons);
        assert!(held.locks.ties.is_empty());
        for (of, reason) in held.locks.of_vertex.iter().zip(&held.reasons) {
            assert_eq!(*of, if reason.is_some() { lock } else { Lock::Free });
        }
    }
    let shared = [1, 2, 4, 7].map(|v| tied.reasons[base + v]);
    assert_eq!(shared, [Some(LockReason::SharedPosition); 4]);
}
