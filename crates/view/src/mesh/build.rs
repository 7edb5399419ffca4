//! Vertices as a GPU fetches them: one for every wedge, and for every normal that it is shaded with.

use std::ops::Range;

use glam::{DVec3, Vec3};
use meshlod::Mesh;
use meshlod::mesh::LayerKind;
use meshlod::picture::{Normals, corner_normals};

use super::VertexAttributes;
use super::colors::{Surface, VertexColors};

/// Vertices of a mesh, and the three of each face.
pub(super) struct CornerVertices {
    pub positions: Vec<[f32; 3]>,
    pub attributes: Vec<VertexAttributes>,
    pub triangles: Vec<[u32; 3]>,
}

/// End of a list.
const NONE: u32 = u32::MAX;

impl CornerVertices {
    /// Makes a vertex for each different corner of a mesh.
    pub(super) fn new(
        mesh: &Mesh,
        surface: &Surface<'_>,
        normals: Normals,
        origin: [f64; 3],
    ) -> Self {
        let is_smooth = matches!(normals, Normals::Smooth | Normals::FromMesh);
        if mesh.attributes.is_none() && (is_smooth || normals == Normals::Flat) {
            return Self::shared(mesh, surface, is_smooth, origin);
        }
        let normals = (normals != Normals::Flat).then(|| corner_normals(mesh, normals));
        let layer = |kind| mesh.attributes.as_ref().and_then(|all| all.layer(kind));
        let uvs = layer(LayerKind::Uv(0));
        let colors = match surface.vertex_colors {
            VertexColors::Wedges => layer(LayerKind::Color(0)),
            _ => None,
        };
        let wedges = mesh.attributes.as_ref().map(|all| &all.corners);
        let origin = DVec3::from(origin);
        let mut this = Self {
            positions: Vec::with_capacity(mesh.positions.len()),
            attributes: Vec::with_capacity(mesh.positions.len()),
            triangles: Vec::with_capacity(mesh.faces.len()),
        };
        // The vertices made for each vertex of the mesh, as lists.
        let mut first = vec![NONE; mesh.positions.len()];
        let mut next = Vec::with_capacity(mesh.positions.len());
        for (face, corners) in mesh.faces.iter().enumerate() {
            let triangle = [0, 1, 2].map(|k| {
                let v = corners[k].index();
                let normal = normals.as_ref().map_or([0.0; 3], |all| all[face][k]);
                let wedge = wedges.map(|all| all[face][k]);
                let uv = match (uvs, wedge) {
                    (Some(layer), Some(wedge)) => [layer.of(wedge)[0], layer.of(wedge)[1]],
                    _ => [0.0; 2],
                };
                let color = match &surface.vertex_colors {
                    VertexColors::White => [255; 3],
                    VertexColors::Vertices(colors) => colors[v],
                    VertexColors::Wedges => match (colors, wedge) {
                        (Some(layer), Some(wedge)) => color(layer.of(wedge)),
                        _ => [255; 3],
                    },
                };
                let [r, g, b] = color;
                let wanted =
                    VertexAttributes { normal: fractions(normal), color: [r, g, b, 255], uv };
                let mut at = first[v];
                while at != NONE && !same(&this.attributes[at as usize], &wanted) {
                    at = next[at as usize];
                }
                if at == NONE {
                    at = this.positions.len() as u32;
                    let place = DVec3::from(mesh.positions[v]) - origin;
                    this.positions.push(place.as_vec3().into());
                    this.attributes.push(wanted);
                    next.push(std::mem::replace(&mut first[v], at));
                }
                at
            });
            this.triangles.push(triangle);
        }
        this
    }
}

impl CornerVertices {
    /// Takes the vertices of a mesh as they are, where corners differ by nothing else.
    fn shared(mesh: &Mesh, surface: &Surface<'_>, is_smooth: bool, origin: [f64; 3]) -> Self {
        let origin = DVec3::from(origin);
        let place = |p: &[f64; 3]| (DVec3::from(*p) - origin).as_vec3().into();
        let mut attributes = match is_smooth {
            true => smooth_attributes(mesh),
            false => vec![WHITE; mesh.positions.len()],
        };
        if let VertexColors::Vertices(colors) = &surface.vertex_colors {
            for (attributes, &[r, g, b]) in attributes.iter_mut().zip(colors) {
                attributes.color = [r, g, b, 255];
            }
        }
        Self {
            positions: mesh.positions.iter().map(place).collect(),
            attributes,
            triangles: mesh.faces.iter().map(|face| face.map(|v| v.0)).collect(),
        }
    }
}

const WHITE: VertexAttributes = VertexAttributes { normal: [0; 4], color: [255; 4], uv: [0.0; 2] };

/// Returns white attributes with the smooth normal of each vertex.
pub(crate) fn smooth_attributes(mesh: &Mesh) -> Vec<VertexAttributes> {
    let mut all = vec![WHITE; mesh.positions.len()];
    for (face, normals) in mesh.faces.iter().zip(corner_normals(mesh, Normals::Smooth)) {
        for (v, normal) in face.iter().zip(normals) {
            all[v.index()].normal = fractions(normal);
        }
    }
    all
}

fn same(a: &VertexAttributes, b: &VertexAttributes) -> bool {
    bytemuck::bytes_of(a) == bytemuck::bytes_of(b)
}

fn color(values: &[f32]) -> [u8; 3] {
    [0, 1, 2].map(|k| (values[k].clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// Packs a unit vector in 16-bit fractions.
pub(crate) fn fractions(normal: [f32; 3]) -> [i16; 4] {
    let [x, y, z] = Vec3::from(normal).to_array().map(|x| (x * 32767.0).round() as i16);
    [x, y, z, 0]
}

/// Sorts faces by material: returns their order, and the range of each material that has some.
pub(super) fn face_order(mesh: &Mesh, materials: usize) -> (Vec<u32>, Vec<(Range<u32>, usize)>) {
    let count = mesh.faces.len() as u32;
    let all = || (0..count).collect();
    let Some(labels) = mesh.materials.as_ref().filter(|_| materials > 1) else {
        return (all(), vec![(0..count, 0)]);
    };
    let mut order: Vec<u32> = all();
    order.sort_by_key(|&face| labels.of_face[face as usize]);
    let ranges = order.chunk_by(|&a, &b| labels.of_face[a as usize] == labels.of_face[b as usize]);
    let mut start = 0;
    let range = |faces: &[u32]| {
        let range = start..start + faces.len() as u32;
        start = range.end;
        (range, labels.of_face[faces[0] as usize] as usize)
    };
    let ranges = ranges.map(range).collect();
    (order, ranges)
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::WedgeId;
    use meshlod::picture::Paint;
    use meshlod::samples;

    use super::*;

    #[test]
    fn smooth_vertices_are_shared_and_flat_ones_too() {
        let mesh = samples::sphere(500);
        let surface = Surface::new(&mesh, &Paint::default()).unwrap();
        for normals in [Normals::Flat, Normals::Smooth] {
            let made = CornerVertices::new(&mesh, &surface, normals, [0.0; 3]);
            assert_eq!(made.positions.len(), mesh.positions.len());
        }
    }

    #[test]
    fn seams_part_vertices() {
        let mesh = samples::fish(500);
        let surface = Surface::new(&mesh, &Paint::Checker { squares: 8 }).unwrap();
        let made = CornerVertices::new(&mesh, &surface, Normals::FromMesh, [0.0; 3]);
        let corners = &mesh.attributes.as_ref().unwrap().corners;
        assert!(made.positions.len() > mesh.positions.len());
        for (triangle, (face, wedges)) in made.triangles.iter().zip(mesh.faces.iter().zip(corners))
        {
            for k in 0..3 {
                let at = triangle[k] as usize;
                let place = mesh.positions[face[k].index()].map(|x| x as f32);
                assert_eq!(made.positions[at], place);
                let uv = mesh.attributes.as_ref().unwrap().layer(LayerKind::Uv(0)).unwrap();
                assert_eq!(made.attributes[at].uv[..], uv.of(WedgeId(wedges[k].0))[..2]);
            }
        }
    }
}
