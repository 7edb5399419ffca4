//! Shading normals for models that bring none.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, WedgeId};

/// Cosine of the angle between two faces above which the edge between them looks sharp: 45°.
const CREASE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Upper limit of the faces compared around a vertex; a hub gets the normals of its
/// faces.
const MOST_AROUND: usize = 64;

/// Adds normals to a mesh without any: smooth, except at edges that bend by more than 45°.
///
/// Levels are shaded by the normals of the model, so that a coarse one looks as round as a fine
/// one. Cost: linear in the faces.
pub(crate) fn add_normals(mesh: &mut Mesh) {
    if mesh.attributes.as_ref().is_some_and(|all| all.layer(LayerKind::Normal).is_some()) {
        return;
    }
    let weighted: Vec<DVec3> = mesh.faces.iter().map(|&face| area_normal(mesh, face)).collect();
    let unit: Vec<DVec3> = weighted.iter().map(|n| n.normalize_or_zero()).collect();
    let mut around = vec![Vec::new(); mesh.positions.len()];
    for (face, vertices) in mesh.faces.iter().enumerate() {
        vertices.iter().for_each(|v| around[v.index()].push(face));
    }
    let normal_at = |face: usize, v: usize| {
        let faces = &around[v];
        let smooth = |other: &&usize| unit[face].dot(unit[**other]) > CREASE;
        let near = faces.iter().filter(smooth).map(|&other| weighted[other]);
        let sum = if faces.len() > MOST_AROUND { weighted[face] } else { near.sum() };
        sum.try_normalize().unwrap_or(unit[face]).as_vec3()
    };
    let old = mesh.attributes.take().unwrap_or_default();
    let old_corner = |face: usize, corner: usize| {
        old.corners.get(face).map_or(mesh.faces[face][corner].0, |corners| corners[corner].0)
    };
    let mut pool: Vec<(u32, [u32; 3])> = Vec::new();
    let mut wedges_of = vec![Vec::new(); mesh.positions.len()];
    let mut corners = Vec::with_capacity(mesh.faces.len());
    for (face, vertices) in mesh.faces.iter().enumerate() {
        corners.push([0, 1, 2].map(|corner| {
            let v = vertices[corner].index();
            let normal: Vec3 = normal_at(face, v);
            let key = (old_corner(face, corner), normal.to_array().map(f32::to_bits));
            let known = wedges_of[v].iter().find(|&&wedge: &&u32| pool[wedge as usize] == key);
            WedgeId(known.copied().unwrap_or_else(|| {
                pool.push(key);
                wedges_of[v].push(pool.len() as u32 - 1);
                pool.len() as u32 - 1
            }))
        }));
    }
    let copied = |layer: &Layer| Layer {
        values: pool.iter().flat_map(|&(old, _)| layer.of(WedgeId(old)).to_vec()).collect(),
        ..layer.clone()
    };
    let values = pool.iter().flat_map(|(_, normal)| normal.map(f32::from_bits)).collect();
    let normals = Layer { kind: LayerKind::Normal, name: "normal".into(), width: 3, values };
    let layers = old.layers.iter().map(copied).chain([normals]).collect();
    mesh.attributes = Some(Attributes { corners, wedge_count: pool.len(), layers });
}

/// Returns the normal of a face, twice its area long.
fn area_normal(mesh: &Mesh, face: [meshlod_mesh::VertexId; 3]) -> DVec3 {
    let [a, b, c] = mesh.triangle(face);
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bare(mut mesh: Mesh) -> Mesh {
        mesh.attributes = None;
        mesh
    }

    #[test]
    fn a_ball_becomes_smooth() {
        let mut ball = bare(meshlod_samples::sphere(2_000));
        add_normals(&mut ball);
        ball.validate().unwrap();
        let attributes = ball.attributes.as_ref().unwrap();
        assert_eq!(attributes.wedge_count, ball.positions.len());
        let layer = attributes.layer(LayerKind::Normal).unwrap();
        for (face, wedges) in ball.faces.iter().zip(&attributes.corners) {
            let p = DVec3::from(ball.positions[face[0].index()]).normalize().as_vec3();
            assert!(p.dot(Vec3::from_slice(layer.of(wedges[0]))) > 0.99);
        }
    }

    #[test]
    fn a_sharp_edge_stays_sharp_and_other_layers_stay() {
        let v = meshlod_mesh::VertexId;
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut roof = Mesh::new(positions, vec![[v(0), v(1), v(2)], [v(1), v(0), v(3)]]);
        let uv = Layer {
            kind: LayerKind::Uv(0),
            name: String::new(),
            width: 2,
            values: (0..8).map(|i| i as f32).collect(),
        };
        let corners = vec![[0, 1, 2].map(WedgeId), [1, 0, 3].map(WedgeId)];
        roof.attributes = Some(Attributes { corners, wedge_count: 4, layers: vec![uv] });
        add_normals(&mut roof);
        roof.validate().unwrap();
        let attributes = roof.attributes.unwrap();
        assert_eq!(attributes.wedge_count, 6, "two more where the roof bends");
        let uv = attributes.layer(LayerKind::Uv(0)).unwrap();
        assert_eq!(uv.of(attributes.corners[1][2]), [6.0, 7.0]);
    }
}
