//! Members and obstacles of a frame, put together as one mesh.

use glam::{Mat3, Vec3};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId};

use crate::draw::paint::{OwnedPaint, STONE};
use crate::levels::LevelTable;

/// Level with only the vertices that it uses.
pub(super) struct LevelShape {
    vertices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl LevelShape {
    pub(super) fn new(table: &LevelTable, level: usize) -> Self {
        let mut local = vec![u32::MAX; table.positions.len()];
        let mut vertices = Vec::new();
        let mut index = |v: u32| {
            let slot = &mut local[v as usize];
            if *slot == u32::MAX {
                *slot = vertices.len() as u32;
                vertices.push(v);
            }
            *slot
        };
        let triangles = table.triangles[table.levels[level].triangles.clone()].iter();
        let triangles = triangles.map(|t| t.map(&mut index)).collect();
        Self { vertices, triangles }
    }
}

/// Mesh of a frame while it is put together.
pub(super) struct Merged {
    positions: Vec<[f64; 3]>,
    pub(super) faces: Vec<[VertexId; 3]>,
    layers: Vec<Layer>,
    labels: Vec<u32>,
    /// True if the model has the materials that its faces name.
    has_materials: bool,
}

impl Merged {
    pub(super) fn new(layers: &[&Layer], has_materials: bool) -> Self {
        let empty = |layer: &&Layer| Layer { values: Vec::new(), ..(*layer).clone() };
        Self {
            positions: Vec::new(),
            faces: Vec::new(),
            layers: layers.iter().map(empty).collect(),
            labels: Vec::new(),
            has_materials,
        }
    }

    pub(super) fn add_member(
        &mut self,
        table: &LevelTable,
        layers: &[&Layer],
        shape: &LevelShape,
        level: usize,
        (frame, position): (Mat3, Vec3),
    ) {
        let first = self.positions.len() as u32;
        let place = |&v: &u32| {
            let p = frame * Vec3::from(table.positions[v as usize]) + position;
            p.as_dvec3().to_array()
        };
        self.positions.extend(shape.vertices.iter().map(place));
        for (merged, layer) in self.layers.iter_mut().zip(layers) {
            for &v in &shape.vertices {
                let value = layer.of(WedgeId(v));
                if layer.kind == LayerKind::Normal {
                    merged.values.extend((frame * Vec3::from_slice(value)).to_array());
                } else {
                    merged.values.extend_from_slice(value);
                }
            }
        }
        self.faces.extend(shape.triangles.iter().map(|t| t.map(|v| VertexId(first + v))));
        let range = table.levels[level].triangles.clone();
        // Without materials of the model, all its faces look alike.
        match table.materials.as_ref().filter(|_| self.has_materials) {
            Some(materials) => self.labels.extend_from_slice(&materials.of_face[range]),
            None => self.labels.resize(self.faces.len(), 0),
        }
    }

    /// Adds an obstacle with smooth normals.
    pub(super) fn add_obstacle(&mut self, obstacle: &Mesh, material: u32) {
        let first = self.positions.len() as u32;
        let mut normals = vec![Vec3::ZERO; obstacle.positions.len()];
        for &face in &obstacle.faces {
            let [a, b, c] = obstacle.triangle(face);
            let normal = (b - a).cross(c - a).as_vec3();
            face.iter().for_each(|v| normals[v.index()] += normal);
        }
        self.positions.extend(&obstacle.positions);
        for layer in &mut self.layers {
            for normal in &normals {
                match layer.kind {
                    LayerKind::Normal => {
                        layer.values.extend(normal.normalize_or(Vec3::Y).to_array())
                    }
                    LayerKind::Color(_) => {
                        layer.values.extend(STONE.into_iter().chain([1.0]).take(layer.width))
                    }
                    _ => layer.values.extend(std::iter::repeat_n(0.0, layer.width)),
                }
            }
        }
        self.faces.extend(obstacle.faces.iter().map(|t| t.map(|v| VertexId(first + v.0))));
        self.labels.resize(self.faces.len(), material);
    }

    pub(super) fn into_mesh(self, paint: &OwnedPaint) -> Mesh {
        let Self { positions, faces, layers, labels, .. } = self;
        let corners = faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        let attributes = Attributes { corners, wedge_count: positions.len(), layers };
        let materials = match paint {
            OwnedPaint::Colors => None,
            OwnedPaint::Materials(all) => {
                let names = (0..all.materials.len()).map(|i| i.to_string()).collect();
                Some(Labels { names, of_face: labels })
            }
        };
        Mesh { attributes: Some(attributes), materials, ..Mesh::new(positions, faces) }
    }
}
