//! Simplification with attributes by meshoptimizer.

use std::collections::HashMap;

use meshlod::mesh::{Attributes, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshopt::SimplifyOptions;

/// Settings of meshoptimizer's simplification with attributes.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Weight of normals relative to positions, for a mesh scaled to size 1.
    pub normal_weight: f32,
    /// Weight of texture coordinates relative to positions, for a mesh scaled to size 1.
    pub uv_weight: f32,
    /// Option flags passed to meshoptimizer.
    pub options: SimplifyOptions,
    /// Whether the remaining vertices keep their positions and attributes.
    pub update: Update,
}

/// Treatment of the vertices that remain after simplification by meshoptimizer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Update {
    /// Vertices keep their positions and attributes, as in `simplify_with_attributes`.
    Nothing,
    /// Vertices move to the best position and their attributes change, as in
    /// `simplify_with_update`.
    All,
}

/// A mesh with one set of attributes per vertex, as a GPU needs it, in meshoptimizer's layout.
pub struct GpuMesh {
    vertices: Vec<GpuVertex>,
    /// Position of each vertex.
    positions: Vec<f32>,
    /// Attributes of each vertex that the metric uses: normal, uv.
    attributes: Vec<f32>,
    /// Indices, three per face.
    indices: Vec<u32>,
}

/// Vertex, wedge and material label of a GPU vertex.
type GpuVertex = (VertexId, Option<WedgeId>, u32);

/// Number of attributes in the metric: three of a normal, two of a uv.
const WIDTH: usize = 5;

/// Layers in the metric, and their offsets in a row of attributes.
const GUIDES: [(LayerKind, usize); 2] = [(LayerKind::Normal, 0), (LayerKind::Uv(0), 3)];

/// Simplifies a mesh with all its attributes by meshoptimizer, to `faces` faces or the nearest
/// number above that it reaches.
///
/// The whole mesh is simplified in one call, so that detail goes where it is missed least. A vertex
/// of two materials is split in two, like one with two wedges, which keeps the border between them.
pub fn simplify_with_attributes(mesh: &Mesh, faces: usize, settings: &Settings) -> Mesh {
    let mut reduced = GpuMesh::new(mesh);
    let count = reduced.simplify(3 * faces, settings);
    reduced.indices.truncate(count);
    reduced.into_mesh(mesh, settings)
}

impl GpuMesh {
    /// Converts a mesh, splitting vertices so that each has one set of attributes and one material.
    pub fn new(mesh: &Mesh) -> Self {
        let mut known = HashMap::new();
        let mut vertices = Vec::new();
        let mut indices = Vec::new();
        for (i, face) in mesh.faces.iter().enumerate() {
            let label = mesh.materials.as_ref().map_or(0, |labels| labels.of(i));
            for (corner, &v) in face.iter().enumerate() {
                let wedge = mesh.attributes.as_ref().map(|all| all.corners[i][corner]);
                let vertex = (v, wedge, label);
                indices.push(*known.entry(vertex).or_insert_with(|| {
                    vertices.push(vertex);
                    vertices.len() as u32 - 1
                }));
            }
        }
        let position = |&(v, ..): &GpuVertex| mesh.positions[v.index()].map(|x| x as f32);
        let positions = vertices.iter().flat_map(position).collect();
        let attributes = guides(mesh, &vertices);
        Self { vertices, positions, attributes, indices }
    }

    /// Returns the number of faces to which meshoptimizer simplifies a copy of the mesh.
    pub fn faces_left(&self, faces: usize, settings: &Settings) -> usize {
        let Self { positions, attributes, indices, .. } = self;
        let mut reduced = Self {
            vertices: Vec::new(),
            positions: positions.clone(),
            attributes: attributes.clone(),
            indices: indices.clone(),
        };
        reduced.simplify(3 * faces, settings) / 3
    }

    /// Calls the library and returns the number of indices left.
    fn simplify(&mut self, target: usize, settings: &Settings) -> usize {
        let Settings { normal_weight: normal, uv_weight: uv, options, update } = *settings;
        let weights = [normal, normal, normal, uv, uv];
        let row = size_of::<f32>();
        let (source, mut error) = (self.indices.clone(), 0.0);
        let (locks, bits) = (std::ptr::null(), options.bits());
        // SAFETY: every pointer is to an array of the length given with it, indices are those of
        // a valid mesh, and null stands for the absent locks as the library documents.
        unsafe {
            match update {
                Update::Nothing => meshopt::ffi::meshopt_simplifyWithAttributes(
                    self.indices.as_mut_ptr(),
                    source.as_ptr(),
                    source.len(),
                    self.positions.as_ptr(),
                    self.positions.len() / 3,
                    3 * row,
                    self.attributes.as_ptr(),
                    WIDTH * row,
                    weights.as_ptr(),
                    WIDTH,
                    locks,
                    target,
                    f32::MAX,
                    bits,
                    &mut error,
                ),
                Update::All => meshopt::ffi::meshopt_simplifyWithUpdate(
                    self.indices.as_mut_ptr(),
                    source.len(),
                    self.positions.as_mut_ptr(),
                    self.positions.len() / 3,
                    3 * row,
                    self.attributes.as_mut_ptr(),
                    WIDTH * row,
                    weights.as_ptr(),
                    WIDTH,
                    locks,
                    target,
                    f32::MAX,
                    bits,
                    &mut error,
                ),
            }
        }
    }

    /// Builds the level, with the mesh's own positions and values except where the library changed
    /// them.
    fn into_mesh(self, mesh: &Mesh, settings: &Settings) -> Mesh {
        let (triples, _) = self.indices.as_chunks::<3>();
        let corners: Vec<_> = triples.iter().map(|t| t.map(WedgeId)).collect();
        let of = |w: WedgeId| self.vertices[w.index()];
        let faces = corners.iter().map(|face| face.map(|w| of(w).0)).collect();
        let mut level = Mesh::new(mesh.positions.clone(), faces);
        if settings.update == Update::All {
            for &w in corners.iter().flatten() {
                let moved = [0, 1, 2].map(|axis| self.positions[3 * w.index() + axis].into());
                level.positions[of(w).0.index()] = moved;
            }
        }
        level.materials = mesh.materials.as_ref().map(|labels| Labels {
            names: labels.names.clone(),
            of_face: corners.iter().map(|face| of(face[0]).2).collect(),
        });
        let layers = mesh.attributes.iter().flat_map(|all| &all.layers);
        let layers = layers.map(|layer| self.layer(layer, settings.update)).collect();
        level.attributes = mesh.attributes.as_ref().map(|_| Attributes {
            corners,
            wedge_count: self.vertices.len(),
            layers,
        });
        level.compact();
        level
    }

    /// Copies a layer to the GPU vertices.
    fn layer(&self, layer: &Layer, update: Update) -> Layer {
        let guide = GUIDES.into_iter().find(|(kind, _)| *kind == layer.kind);
        let values = self.vertices.iter().enumerate().flat_map(|(i, &(_, wedge, _))| {
            match (update, guide) {
                (Update::All, Some((_, at))) => &self.attributes[i * WIDTH + at..][..layer.width],
                _ => wedge.map_or(&[][..], |wedge| layer.of(wedge)),
            }
        });
        Layer { values: values.copied().collect(), ..layer.clone() }
    }
}

/// Collects normal and uv of each vertex. A mesh without normals gets those its pictures are shaded
/// with, because the library does better with them (docs/notes/image-error.md).
fn guides(mesh: &Mesh, vertices: &[GpuVertex]) -> Vec<f32> {
    let layer = |kind| mesh.attributes.as_ref().and_then(|all| all.layer(kind));
    let smooth = if layer(LayerKind::Normal).is_none() { smooth_normals(mesh) } else { vec![] };
    let mut rows = vec![0.0; WIDTH * vertices.len()];
    for (row, &(v, wedge, _)) in rows.chunks_exact_mut(WIDTH).zip(vertices) {
        if let Some(normal) = smooth.get(v.index()) {
            row[..3].copy_from_slice(normal);
        }
        for (kind, at) in GUIDES {
            if let Some((layer, wedge)) = layer(kind).zip(wedge) {
                row[at..at + layer.width].copy_from_slice(layer.of(wedge));
            }
        }
    }
    rows
}

/// Computes vertex normals as the area-weighted mean of face normals.
fn smooth_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0; 3]; mesh.positions.len()];
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        let normal = (b - a).cross(c - a).to_array();
        for v in face {
            let sum = &mut sums[v.index()];
            *sum = [0, 1, 2].map(|axis| sum[axis] + normal[axis]);
        }
    }
    let unit = |sum: [f64; 3]| {
        let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        sum.map(|x| (x / length) as f32)
    };
    sums.into_iter().map(unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: Settings = Settings {
        normal_weight: 0.5,
        uv_weight: 0.5,
        options: SimplifyOptions::None,
        update: Update::Nothing,
    };

    #[test]
    fn levels_keep_layers_and_have_the_size_asked_for() {
        let mesh = meshlod::samples::fish(4_000);
        for update in [Update::Nothing, Update::All] {
            let settings = Settings { update, ..SETTINGS };
            let level = simplify_with_attributes(&mesh, 1_000, &settings);
            level.validate().unwrap();
            assert!((900..=1_000).contains(&level.faces.len()), "{}", level.faces.len());
            let layers = |mesh: &Mesh| mesh.attributes.as_ref().unwrap().layers.len();
            assert_eq!(layers(&mesh), layers(&level));
        }
    }

    #[test]
    fn nothing_to_do_leaves_positions_and_values_as_they_are() {
        let mesh = meshlod::samples::fish(500);
        let level = simplify_with_attributes(&mesh, mesh.faces.len(), &SETTINGS);
        let corners = |mesh: &Mesh| -> Vec<_> {
            let uv =
                mesh.attributes.as_ref().and_then(|all| Some((all, all.layer(LayerKind::Uv(0))?)));
            let (all, uv) = uv.unwrap();
            let values = |&(f, c): &(usize, usize)| {
                (mesh.positions[mesh.faces[f][c].index()], uv.of(all.corners[f][c]).to_vec())
            };
            let corners = (0..mesh.faces.len()).flat_map(|f| (0..3).map(move |c| (f, c)));
            corners.map(|at| values(&at)).collect()
        };
        assert_eq!(corners(&mesh), corners(&level));
    }
}
