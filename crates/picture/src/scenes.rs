//! Small meshes for tests.

use glam::DVec3;
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};

use crate::Camera;

/// The square [-1, 1]² at z = 0, facing +z, as n × n squares of two faces.
pub(crate) fn sheet(n: u32) -> Mesh {
    let at = |i: u32| f64::from(i) / f64::from(n) * 2.0 - 1.0;
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j), 0.0])).collect();
    let v = |i: u32, j: u32| VertexId(j * (n + 1) + i);
    let cells = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let faces = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh::new(positions, faces)
}

/// A [`sheet`] with uvs from (0, 0) at the lower left to (1, 1).
pub(crate) fn sheet_with_uv(n: u32) -> Mesh {
    let mut mesh = sheet(n);
    let values = mesh.positions.iter().flat_map(|p| [p[0], p[1]].map(|x| (x * 0.5 + 0.5) as f32));
    let layer =
        Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values: values.collect() };
    let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let wedge_count = mesh.positions.len();
    mesh.attributes = Some(Attributes { corners, wedge_count, layers: vec![layer] });
    mesh
}

/// Triangles around the z axis, facing +z, one for each height.
pub(crate) fn stack(heights: &[f64]) -> Mesh {
    let corners = |&z: &f64| [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]];
    let positions = heights.iter().flat_map(corners).collect();
    let face = |i: u32| [VertexId(3 * i), VertexId(3 * i + 1), VertexId(3 * i + 2)];
    Mesh::new(positions, (0..heights.len() as u32).map(face).collect())
}

/// Two squares that meet at a right angle in the edge v0 v1 along z, which points up.
pub(crate) fn roof() -> Mesh {
    let positions = vec![
        [0.0, 0.0, -1.0],
        [0.0, 0.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, -1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let face = |a, b, c| [VertexId(a), VertexId(b), VertexId(c)];
    let faces = vec![face(0, 1, 2), face(0, 2, 3), face(1, 0, 4), face(1, 4, 5)];
    Mesh::new(positions, faces)
}

/// Looks down the z axis at the origin.
pub(crate) fn from_front(distance: f64) -> Camera {
    let fov_rad = 2.0 * std::f64::consts::FRAC_PI_8;
    Camera::look_at([0.0, 0.0, distance], [0.0; 3], [0.0, 1.0, 0.0], fov_rad)
}

/// An octahedron with every face cut in four, `rounds` times, blown up to the unit sphere.
pub(crate) fn ball(rounds: u32) -> Mesh {
    let mut faces: Vec<[DVec3; 3]> = Vec::new();
    for octant in 0..8 {
        let [x, y, z] = [1, 2, 4].map(|bit| if octant & bit == 0 { -1.0 } else { 1.0 });
        let face = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z];
        faces.push(if x * y * z > 0.0 { face } else { [face[1], face[0], face[2]] });
    }
    for _ in 0..rounds {
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let mut vertex = |p: DVec3| {
        let known = positions.iter().position(|&known| known == p.to_array());
        VertexId::new(known.unwrap_or_else(|| {
            positions.push(p.to_array());
            positions.len() - 1
        }))
    };
    let faces = faces.iter().map(|face| face.map(&mut vertex)).collect();
    Mesh::new(positions, faces)
}
