//! Recognition of height fields.

use meshlod_fixtures as fixtures;
use meshlod_mesh::{FaceId, Mesh, VertexId};
use meshlod_samples as samples;

use super::{SIZES, Sample};
use crate::rtin::{HeightField, HeightFieldError};
use crate::tests::walks::Dice;

/// Shuffles the vertices of a mesh and adds one that no face uses.
fn shuffled(mesh: &Mesh, dice: &mut Dice) -> Mesh {
    let mut order: Vec<usize> = (0..mesh.positions.len()).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, (dice.roll() * (i + 1) as f64) as usize);
    }
    let mut new = vec![VertexId(0); order.len()];
    order.iter().enumerate().for_each(|(i, &v)| new[v] = VertexId::new(i));
    let mut positions: Vec<_> = order.iter().map(|&v| mesh.positions[v]).collect();
    positions.push([1e9, -1e9, 7.0]);
    Mesh::new(positions, mesh.faces.iter().map(|face| face.map(|v| new[v.index()])).collect())
}

#[test]
fn fields_are_found_along_each_axis_in_any_order() {
    for size in SIZES {
        for (up, looks_down) in [(0, false), (1, true), (2, false), (2, true)] {
            let mesh = Sample { up, looks_down, ..Sample::new(size) }.mesh();
            let field = HeightField::from_mesh(&shuffled(&mesh, &mut Dice(5))).unwrap();
            // Two by two vertices may look like a grid along several axes.
            if size != [2, 2] {
                assert_eq!((field.size(), field.axis()), (size, up));
                assert_eq!(field.placement.looks_down, looks_down);
                let all = (0..size[1]).flat_map(|r| (0..size[0]).map(move |c| (c, r)));
                let points: Vec<_> = all.map(|(c, r)| field.point(c, r)).collect();
                assert_eq!(points, mesh.positions);
                assert_eq!(field.fit().moved, 0.0);
            }
        }
    }
    let terrain = HeightField::from_mesh(&samples::terrain(800)).unwrap();
    assert_eq!(
        (terrain.size(), terrain.axis(), terrain.placement.looks_down),
        ([21, 21], 1, false)
    );
}

#[test]
fn rounded_coordinates_fit_a_grid() {
    let mut mesh = Sample::new([12, 17]).mesh();
    for p in &mut mesh.positions {
        *p = p.map(|x| f64::from((x / 3.0 + 4e3) as f32));
    }
    let field = HeightField::from_mesh(&mesh).unwrap();
    let moved = field.fit().moved;
    assert!(moved > 0.0 && moved < 0.0005, "{moved}");
}

#[test]
fn flipped_diagonals_are_measured() {
    // With three corners at 0 and one at 1, the middle is at 0 or at one half.
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
    let turned = |faces: [[u32; 3]; 2]| {
        HeightField::from_mesh(&fixtures::mesh(&corners, &faces)).unwrap().fit().turned
    };
    assert_eq!(turned([[0, 1, 3], [0, 3, 2]]), 0.0);
    assert_eq!(turned([[0, 1, 2], [1, 3, 2]]), 0.5);
}

#[test]
fn errors_name_the_place() {
    use HeightFieldError as E;
    let fails = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = Sample::new([6, 5]).mesh();
        change(&mut mesh);
        HeightField::from_mesh(&mesh).unwrap_err()
    };
    // Vertex 8 is at column 2, row 1.
    let hole = fails(&|mesh| mesh.faces.retain(|face| !face.contains(&VertexId(8))));
    assert!(matches!(hole, E::Hole { column: 2, row: 1, .. }), "{hole}");
    let cell = fails(&|mesh| mesh.faces.truncate(21));
    assert!(matches!(cell, E::Hole { .. }), "{cell}");
    let cell = fails(&|mesh| _ = mesh.faces.remove(3));
    assert!(matches!(cell, E::Cell { column: 1, row: 0, faces: 1 }), "{cell}");
    let cell = fails(&|mesh| mesh.faces.push(mesh.faces[7]));
    assert!(matches!(cell, E::Cell { column: 3, row: 0, faces: 3 }), "{cell}");
    let turned = fails(&|mesh| mesh.faces[4].swap(0, 1));
    assert_eq!(turned, E::FlippedFace(FaceId(4)));
    let wide = fails(&|mesh| mesh.faces[4] = [0, 2, 8].map(VertexId));
    assert_eq!(wide, E::NotHalfCell(FaceId(4)));
    let thin = fails(&|mesh| mesh.faces[4] = [2, 3, 3].map(VertexId));
    assert_eq!(thin, E::NotHalfCell(FaceId(4)));
    let beside = fails(&|mesh| mesh.positions[8][0] += 0.02);
    assert!(
        matches!(beside, E::OffGrid { vertex: VertexId(8), column: 2, row: 1, .. }),
        "{beside}"
    );
    let twice = fails(&|mesh| {
        mesh.positions.push(mesh.positions[8]);
        mesh.faces.push([30, 9, 14].map(VertexId));
    });
    assert!(matches!(twice, E::SamePoint { column: 2, row: 1, .. }), "{twice}");
    let bad = fails(&|mesh| mesh.positions[3][2] = f64::NAN);
    assert!(matches!(bad, E::Mesh(_)), "{bad}");
    for mesh in
        [samples::sphere(500), samples::torus(300), fixtures::tetrahedron(), Mesh::default()]
    {
        let error = HeightField::from_mesh(&mesh).unwrap_err();
        assert!(!error.to_string().is_empty());
    }
}
