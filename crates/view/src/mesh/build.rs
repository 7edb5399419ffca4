//! Vertices as a GPU fetches them: one for every wedge, and for every normal that it is shaded
//! with.

use std::ops::Range;

use glam::DVec3;
use meshlod::Mesh;
use meshlod::mesh::{Bounds, Layer, LayerKind};
use meshlod::picture::{Normals, corner_normals};

use super::colors::{Surface, VertexColors};
use super::vertex::{VertexAttributes, fractions};

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
        let corners = CornerAttributes::new(mesh, surface, normals);
        let mut lists = VertexLists::new(mesh, origin);
        let triangle = |face: usize| {
            [0, 1, 2].map(|k| lists.vertex(mesh.faces[face][k].index(), corners.of(face, k)))
        };
        let triangles = (0..mesh.faces.len()).map(triangle).collect();
        Self { positions: lists.positions, attributes: lists.attributes, triangles }
    }

    /// Takes over the vertices of a mesh whose corners at a vertex are all alike.
    fn shared(mesh: &Mesh, surface: &Surface<'_>, is_smooth: bool, origin: [f64; 3]) -> Self {
        let origin = DVec3::from(origin);
        let place = |p: &[f64; 3]| (DVec3::from(*p) - origin).as_vec3().into();
        let mut attributes = match is_smooth {
            true => smooth_attributes(mesh),
            false => vec![VertexAttributes::WHITE; mesh.positions.len()],
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

/// Source of the attributes of corners.
struct CornerAttributes<'a> {
    mesh: &'a Mesh,
    /// Normals of the corners of each face; `None` for none.
    normals: Option<Vec<[[f32; 3]; 3]>>,
    uvs: Option<&'a Layer>,
    colors: Option<&'a Layer>,
    /// sRGB colours of vertices.
    vertex_colors: Option<&'a [[u8; 3]]>,
}

impl<'a> CornerAttributes<'a> {
    fn new(mesh: &'a Mesh, surface: &'a Surface<'_>, normals: Normals) -> Self {
        let layer = |kind| mesh.attributes.as_ref().and_then(|all| all.layer(kind));
        let (colors, vertex_colors) = match &surface.vertex_colors {
            VertexColors::White => (None, None),
            VertexColors::Wedges => (layer(LayerKind::Color(0)), None),
            VertexColors::Vertices(colors) => (None, Some(&colors[..])),
        };
        Self {
            mesh,
            normals: (normals != Normals::Flat).then(|| corner_normals(mesh, normals)),
            uvs: layer(LayerKind::Uv(0)),
            colors,
            vertex_colors,
        }
    }

    /// Returns the attributes of the `k`-th corner of a face.
    fn of(&self, face: usize, k: usize) -> VertexAttributes {
        let wedge = self.mesh.attributes.as_ref().map(|all| all.corners[face][k]);
        let values = |layer: Option<&'a Layer>| Some(Layer::of(layer?, wedge?));
        let vertex = self.mesh.faces[face][k].index();
        let of_vertex = self.vertex_colors.map(|colors| colors[vertex]);
        let [r, g, b] = of_vertex.or(values(self.colors).map(color)).unwrap_or([255; 3]);
        VertexAttributes {
            normal: fractions(self.normals.as_ref().map_or([0.0; 3], |all| all[face][k])),
            color: [r, g, b, 255],
            uv: values(self.uvs).map_or([0.0; 2], |uv| [uv[0], uv[1]]),
        }
    }
}

/// Vertices made so far, in a list for each vertex of the mesh.
struct VertexLists<'a> {
    mesh: &'a Mesh,
    origin: DVec3,
    positions: Vec<[f32; 3]>,
    attributes: Vec<VertexAttributes>,
    first: Vec<u32>,
    next: Vec<u32>,
}

impl<'a> VertexLists<'a> {
    fn new(mesh: &'a Mesh, origin: [f64; 3]) -> Self {
        let count = mesh.positions.len();
        Self {
            mesh,
            origin: origin.into(),
            positions: Vec::with_capacity(count),
            attributes: Vec::with_capacity(count),
            first: vec![NONE; count],
            next: Vec::with_capacity(count),
        }
    }

    /// Returns the vertex with these attributes at vertex `v` of the mesh, made if it is new.
    fn vertex(&mut self, v: usize, wanted: VertexAttributes) -> u32 {
        let mut at = self.first[v];
        while at != NONE && !same(&self.attributes[at as usize], &wanted) {
            at = self.next[at as usize];
        }
        if at == NONE {
            at = self.positions.len() as u32;
            let place = DVec3::from(self.mesh.positions[v]) - self.origin;
            self.positions.push(place.as_vec3().into());
            self.attributes.push(wanted);
            self.next.push(std::mem::replace(&mut self.first[v], at));
        }
        at
    }
}

/// Returns the middle of the box of all positions that faces use.
pub(crate) fn middle(mesh: &Mesh) -> [f64; 3] {
    let used = mesh.faces.iter().flatten().map(|v| &mesh.positions[v.index()]);
    let bounds = Bounds::of(used);
    if bounds.is_empty() {
        return [0.0; 3];
    }
    [0, 1, 2].map(|axis| bounds.min[axis] / 2.0 + bounds.max[axis] / 2.0)
}

/// Returns white attributes with the smooth normal of each vertex.
pub(crate) fn smooth_attributes(mesh: &Mesh) -> Vec<VertexAttributes> {
    let mut all = vec![VertexAttributes::WHITE; mesh.positions.len()];
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

/// Sorts faces by material: returns their order, and the range of each material in use.
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
