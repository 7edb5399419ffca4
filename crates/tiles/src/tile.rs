//! Mesh of a tile, with the curves along which it meets its neighbours.

use meshlod_mesh::{Attributes, Labels, LayerKind, Mesh, VertexId, WedgeId};
use rustc_hash::FxHashMap;

use crate::cell::Cell;
use crate::lattice::Point;
use crate::samples::Samples;

/// Greatest difference between values of two wedges that are one where tiles meet. Half a step of
/// eight bits.
pub(crate) const SAME: f32 = 0.002;

/// Mesh of a tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileMesh {
    /// Geometry, with positions in steps of the lattice.
    pub mesh: Mesh,
    /// Edges in the sides of the cell, in the direction that their faces have. Their ends have whole
    /// coordinates.
    pub border: Vec<[VertexId; 2]>,
    /// Points of the border where texture coordinates or materials change from one edge in a side
    /// to the next; sorted.
    pub seams: Vec<Point>,
    /// Points of the model that it shows.
    pub samples: Samples,
}

impl TileMesh {
    /// Returns the point of a vertex with whole coordinates.
    pub fn point(&self, v: VertexId) -> Point {
        point_of(&self.mesh, v)
    }

    /// Returns for each vertex whether it is an end of a border edge.
    pub fn border_vertices(&self) -> Vec<bool> {
        let mut is_border = vec![false; self.mesh.positions.len()];
        self.border.iter().flatten().for_each(|v| is_border[v.index()] = true);
        is_border
    }
}

/// Returns the position of a vertex with whole coordinates.
pub(crate) fn point_of(mesh: &Mesh, v: VertexId) -> Point {
    mesh.positions[v.index()].map(|x| x as i32)
}

/// Builds the mesh of a tile from corners, joining vertices at one point, and wedges with one set
/// of values.
#[derive(Debug)]
pub struct TileBuilder {
    mesh: Mesh,
    /// Vertex at each point.
    at: FxHashMap<Point, VertexId>,
    /// First wedge of each vertex, and the next one of the same vertex.
    first: Vec<Option<WedgeId>>,
    next: Vec<Option<WedgeId>>,
}

impl TileBuilder {
    /// Creates the builder of a mesh with these layers, which are empty, and names of materials.
    pub fn new(attributes: Option<Attributes>, materials: &[String]) -> Self {
        let labels = || Labels { names: materials.to_vec(), of_face: Vec::new() };
        let materials = (!materials.is_empty()).then(labels);
        let mesh = Mesh { attributes, materials, ..Mesh::default() };
        Self { mesh, at: FxHashMap::default(), first: Vec::new(), next: Vec::new() }
    }

    /// Adds a face from the points and values of its corners.
    pub fn add_face(&mut self, corners: [(Point, &[f32]); 3], material: u32) {
        let face = corners.map(|(point, _)| self.vertex(point));
        let [a, b, c] = face;
        if a == b || b == c || c == a {
            return;
        }
        if self.mesh.attributes.is_some() {
            let wedges = [0, 1, 2].map(|i| self.wedge(face[i], corners[i].1));
            self.mesh.attributes.as_mut().expect("there are layers").corners.push(wedges);
        }
        self.mesh.faces.push(face);
        if let Some(labels) = &mut self.mesh.materials {
            labels.of_face.push(material);
        }
    }

    fn vertex(&mut self, point: Point) -> VertexId {
        *self.at.entry(point).or_insert_with(|| {
            self.mesh.positions.push(point.map(f64::from));
            self.first.push(None);
            VertexId::new(self.mesh.positions.len() - 1)
        })
    }

    fn wedge(&mut self, v: VertexId, values: &[f32]) -> WedgeId {
        let attributes = self.mesh.attributes.as_mut().expect("there are layers");
        let mut found = self.first[v.index()];
        while let Some(wedge) = found {
            if has_values(attributes, wedge, values) {
                return wedge;
            }
            found = self.next[wedge.index()];
        }
        let wedge = WedgeId::new(attributes.wedge_count);
        attributes.wedge_count += 1;
        let mut rest = values;
        for layer in &mut attributes.layers {
            let (own, after) = rest.split_at(layer.width);
            layer.values.extend_from_slice(own);
            rest = after;
        }
        self.next.push(self.first[v.index()].replace(wedge));
        wedge
    }

    /// Returns the mesh.
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }

    /// Returns the mesh of a leaf. Edges with both ends on one side of its cell are its border.
    pub fn leaf(self, cell: Cell) -> TileMesh {
        let mesh = self.mesh;
        let sides: Vec<u8> =
            mesh.positions.iter().map(|at| cell.sides_of(at.map(|x| x as i32))).collect();
        let edges = mesh.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let is_border = |[a, b]: &[VertexId; 2]| sides[a.index()] & sides[b.index()] != 0;
        let border = edges.filter(is_border).collect();
        let seams = seams(&mesh, &sides);
        let samples = Samples::of_leaf(&mesh);
        TileMesh { mesh, border, seams, samples }
    }
}

/// Returns the points on one side of a cell where the edges in it have faces of several materials
/// or charts. It follows from the edges and their faces alone, which the neighbour has alike, in
/// whatever order.
fn seams(mesh: &Mesh, sides: &[u8]) -> Vec<Point> {
    let uvs = mesh.attributes.as_ref().and_then(|own| own.layer(LayerKind::Uv(0)));
    let mut at: FxHashMap<VertexId, SeenAt> = FxHashMap::default();
    for (face, corners) in mesh.faces.iter().enumerate() {
        for i in 0..3 {
            let ends = [i, (i + 1) % 3];
            let [a, b] = ends.map(|i| sides[corners[i].index()]);
            let is_on_one = |&i: &usize| sides[corners[i].index()].is_power_of_two();
            for i in ends.into_iter().filter(|_| a & b != 0).filter(is_on_one) {
                let uv = uvs.map_or(&[][..], |uvs| uvs.of(mesh.corner_wedges(face)[i]));
                let label = mesh.materials.as_ref().map_or(0, |labels| labels.of(face));
                at.entry(corners[i]).or_default().see(uv, label);
            }
        }
    }
    let seams = at.into_iter().filter(|(_, seen)| seen.is_seam());
    let mut seams: Vec<Point> = seams.map(|(v, _)| point_of(mesh, v)).collect();
    seams.sort_unstable();
    seams
}

/// Range of the texture coordinates and labels that edges of a side have at a vertex.
struct SeenAt {
    uvs: [[f32; 2]; 2],
    labels: [u32; 2],
}

impl Default for SeenAt {
    fn default() -> Self {
        let uvs = [[f32::INFINITY; 2], [f32::NEG_INFINITY; 2]];
        Self { uvs, labels: [u32::MAX, 0] }
    }
}

impl SeenAt {
    fn see(&mut self, uv: &[f32], label: u32) {
        for (axis, &x) in uv.iter().enumerate().take(2) {
            let [least, most] = self.uvs.map(|uv| uv[axis]);
            (self.uvs[0][axis], self.uvs[1][axis]) = (least.min(x), most.max(x));
        }
        let [least, most] = self.labels;
        self.labels = [least.min(label), most.max(label)];
    }

    fn is_seam(&self) -> bool {
        let [least, most] = self.uvs;
        self.labels[0] != self.labels[1] || (0..2).any(|axis| most[axis] - least[axis] > SAME)
    }
}

fn has_values(attributes: &Attributes, wedge: WedgeId, values: &[f32]) -> bool {
    let mut rest = values;
    attributes.layers.iter().all(|layer| {
        let (own, after) = rest.split_at(layer.width);
        rest = after;
        layer.of(wedge) == own
    })
}
