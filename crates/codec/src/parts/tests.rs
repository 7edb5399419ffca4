//! Properties of parts that hold for any mesh.

use meshlod_fixtures::{grid, mesh};
use meshlod_samples as samples;

use super::*;
use crate::test_meshes::meshes;

fn partitioner(mesh: &Mesh) -> Partitioner<'_> {
    Partitioner::new(mesh).unwrap()
}

/// Faces in terms of mesh vertices, sorted.
fn drawn(parts: &Parts) -> Vec<[VertexId; 3]> {
    let of_part = |part: &'_ Part| {
        let face = |face: &[u32; 3]| face.map(|local| part.vertices[local as usize]);
        part.faces.iter().map(face).collect::<Vec<_>>()
    };
    let mut faces: Vec<_> = parts.parts().iter().flat_map(of_part).collect();
    faces.sort_unstable();
    faces
}

#[test]
fn every_face_is_in_one_part_as_it_was() {
    for mesh in meshes() {
        let partitioner = partitioner(&mesh);
        for count in [1, 5, 40] {
            let parts = partitioner.with_count(count, Reconstruction::Centred);
            let mut faces = mesh.faces.clone();
            faces.sort_unstable();
            assert_eq!(drawn(&parts), faces);
            assert_eq!(parts.decode().faces.len(), faces.len());
        }
    }
}

#[test]
fn a_vertex_is_in_the_same_cell_of_all_its_parts() {
    for mesh in meshes() {
        let parts = partitioner(&mesh).with_count(24, Reconstruction::Centred);
        let mut cells = vec![None; mesh.positions.len()];
        let mut again = 0;
        for part in parts.parts() {
            for (&vertex, &position) in part.vertices.iter().zip(&part.positions) {
                let cell = [0, 1, 2].map(|k| part.offset[k] + i32::from(position[k]));
                again += usize::from(cells[vertex.index()].is_some());
                assert_eq!(*cells[vertex.index()].get_or_insert(cell), cell);
            }
        }
        assert!(again > 0);
    }
}

#[test]
fn no_vertex_is_further_off_than_half_a_cell() {
    for mesh in meshes() {
        for (cells, most) in [(Reconstruction::Centred, 0.5), (Reconstruction::Truncated, 1.0)] {
            let parts = partitioner(&mesh).with_count(12, cells);
            let sides = parts.cell().map(f64::from);
            for part in parts.parts() {
                let matrix = parts.matrix(part);
                for (&vertex, &position) in part.vertices.iter().zip(&part.positions) {
                    let [x, y, z] = position.map(f32::from);
                    for axis in 0..3 {
                        let [a, b, c, d] = matrix[axis];
                        let decoded = f64::from(a * x + b * y + c * z + d);
                        let off = (decoded - mesh.positions[vertex.index()][axis]).abs();
                        assert!(off <= most * sides[axis] * 1.001, "{off} of {sides:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn parts_meet_bit_for_bit_by_their_matrices_in_f32() {
    for mut mesh in meshes() {
        for shift in [0.0, 0.3, -77.7, 1000.1] {
            mesh.positions.as_flattened_mut().iter_mut().for_each(|x| *x += shift);
            let parts = partitioner(&mesh).with_count(24, Reconstruction::Centred);
            for part in parts.parts() {
                let matrix = parts.matrix(part);
                for &position in &part.positions {
                    let is = parts.grid.place(part.offset, position);
                    for k in 0..3 {
                        let x = f32::from(position[k]);
                        let [cell, from] = [matrix[k][k], matrix[k][3]];
                        assert_eq!(f64::from(cell * x + from), is[k]);
                        assert_eq!(f64::from(cell.mul_add(x, from)), is[k]);
                    }
                }
            }
        }
    }
}

#[test]
fn more_parts_have_smaller_cells_and_relaxation_helps() {
    let mesh = samples::gyroid(6000);
    let partitioner = partitioner(&mesh);
    let size = |count| partitioner.with_count(count, Reconstruction::Centred).cell().map(f64::from);
    let [few, many] = [size(4), size(64)].map(|cell| cell.iter().sum::<f64>());
    assert!(many < 0.5 * few, "{few} {many}");
    let merged = partitioner.merges.clusters(64);
    let [before, after] = [merged.clone(), lloyd::relax(&partitioner.graph, merged, 64)]
        .map(|parts| lloyd::cost(&lloyd::boxes(&partitioner.graph, &parts, 64)));
    assert!(after < before, "{before} {after}");
}

#[test]
fn a_reduction_is_kept_with_as_many_parts_as_possible() {
    let mesh = samples::sphere(6000);
    let partitioner = partitioner(&mesh);
    let parts = partitioner.within_reduction(0.68, Reconstruction::Centred).unwrap();
    assert!((0.68..0.69).contains(&parts.reduction()), "{}", parts.reduction());
    assert!(parts.parts().len() > 3 && parts.overhead() > 0.0);
}

#[test]
fn a_cell_size_is_kept_where_it_saves_space() {
    let mesh = samples::sphere(6000);
    let partitioner = partitioner(&mesh);
    let parts = partitioner.within_cell(0.002, Reconstruction::Centred);
    assert!((0.0017..=0.002).contains(&parts.mean_side()), "{}", parts.mean_side());
    let finest = partitioner.within_cell(1e-9, Reconstruction::Centred);
    assert!(finest.mean_side() < 0.001 && finest.reduction() > 0.0);
    // Parts of two faces would have the finest cells, but more positions than uncompressed.
    let squares = grid(8);
    let finest = self::partitioner(&squares).within_cell(1e-9, Reconstruction::Centred);
    assert!(finest.parts().len() > 1 && finest.reduction() > 0.0, "{}", finest.reduction());
    let small = mesh_of_one();
    assert_eq!(
        Partitioner::new(&small).unwrap().within_cell(1e-9, Reconstruction::Centred).parts().len(),
        1
    );
}

#[test]
fn no_parts_are_wasted_on_cells_that_the_largest_face_forbids() {
    // One face is as long as a side of the mesh, all others are small.
    let mut mesh = samples::gyroid(6000);
    let longest = mesh.bounds();
    let first = mesh.positions.len();
    mesh.positions.extend([longest.min, longest.max, longest.center()]);
    mesh.faces.push([0, 1, 2].map(|k| VertexId::new(first + k)));
    let partitioner = partitioner(&mesh);
    let parts = partitioner.within_cell(1e-3, Reconstruction::Centred);
    assert!(parts.mean_side() >= 0.999 * sides_over(&longest));
    assert!(parts.parts().len() < 4, "{}", parts.parts().len());
    // With one of half that length, the finest cells that are left need several parts.
    let half = [0, 1, 2].map(|k| longest.min[k].midpoint(longest.max[k]));
    mesh.positions[first + 1] = half;
    mesh.positions[first + 2] = [half[0], longest.min[1], longest.min[2]];
    let parts = self::partitioner(&mesh).within_cell(1e-3, Reconstruction::Centred);
    let ratio = parts.mean_side() / (sides_over(&longest) / 2.0);
    assert!((0.999..1.001).contains(&ratio) && parts.parts().len() > 4, "{ratio}");
}

/// Returns the mean side of the cells of one box.
fn sides_over(bounds: &Bounds) -> f64 {
    (0..3).map(|k| (bounds.max[k] - bounds.min[k]) / 255.0).sum::<f64>() / 3.0
}

#[test]
fn parts_of_a_plate_have_both_its_sides() {
    let mesh = samples::plate(60_000);
    let parts = partitioner(&mesh).with_count(16, Reconstruction::Centred);
    // A part with one side only has a border around each of its holes.
    assert!(parts.overhead() < 0.1, "{}", parts.overhead());
}

fn mesh_of_one() -> Mesh {
    mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])
}

#[test]
fn impossible_requests_are_refused() {
    let small = mesh_of_one();
    let too_small = partitioner(&small).within_reduction(0.7, Reconstruction::Centred);
    assert!(matches!(too_small, Err(PartsError::TooSmall { .. })));
    let none = |part| partitioner(&small).within_reduction(part, Reconstruction::Centred).err();
    assert_eq!(none(1.0), Some(PartsError::Reduction(1.0)));
    assert!(none(f64::NAN).is_some());
    assert_eq!(Partitioner::new(&Mesh::default()).err(), Some(PartsError::Empty));
    let far = mesh(&[[0.0; 3], [1e300, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    assert_eq!(Partitioner::new(&far).err(), Some(PartsError::NotFinite(VertexId(1))));
}

#[test]
fn flat_tiny_and_far_meshes_stay_where_they_are() {
    for (scale, from) in [(1.0, 0.0), (1e30, 0.0), (1e-30, 0.0), (1.0, 4e6), (0.0, 5.0)] {
        let place = |x: f64, y: f64| [from + scale * x, from + scale * y, from];
        let corners = [place(0.0, 0.0), place(1.0, 0.0), place(0.0, 1.0)];
        let mesh = mesh(&corners, &[[0, 1, 2]]);
        let decoded = partitioner(&mesh).with_count(1, Reconstruction::Centred).decode();
        for (was, is) in corners.iter().zip(&decoded.positions) {
            for axis in 0..3 {
                let most = (scale / 256.0).max(from / 4e6);
                assert!((was[axis] - is[axis]).abs() <= most, "{was:?} {is:?}");
            }
        }
    }
}
