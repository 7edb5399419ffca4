//! Vertices for the GPU, from positions and layers of a model.

use glam::{DVec3, Vec3};
use meshlod::mesh::LayerKind;
use meshlod::multires::{Hierarchy, LayerFormat, VertexValues};
use meshlod::scene::OwnedPaint;

use super::model::CutModel;
use crate::mesh::{VertexAttributes, fractions};

/// Offsets of the values that are drawn among all values of a wedge, and the origin of positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexFields {
    origin: DVec3,
    /// Number of values of a wedge, over all layers.
    width: usize,
    normal: Option<usize>,
    uv: Option<usize>,
    color: Option<usize>,
}

/// Vertex in the buffers of the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GpuVertex {
    pub(super) position: [f32; 3],
    pub(super) attributes: VertexAttributes,
}

/// Vertex that a step has moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedVertex {
    pub(super) vertex: u32,
    pub(super) now: GpuVertex,
}

impl VertexFields {
    /// Finds the values that are drawn. Colours of vertices are white if the paint has others.
    pub(super) fn new(model: &CutModel) -> Self {
        let has_colors = matches!(model.paint(), OwnedPaint::Colors);
        let layers: Vec<LayerFormat<'_>> =
            model.contractions().map_or_else(Vec::new, |levels| levels.layers().collect());
        let find = |kind: LayerKind, least: usize| {
            let at = layers.iter().position(|l| l.kind == kind && l.width >= least)?;
            Some(layers[..at].iter().map(|layer| layer.width).sum())
        };
        Self {
            origin: model.origin(),
            width: layers.iter().map(|layer| layer.width).sum(),
            normal: find(LayerKind::Normal, 3),
            uv: find(LayerKind::Uv(0), 2),
            color: find(LayerKind::Color(0), 3).filter(|_| has_colors),
        }
    }

    /// Returns true if there are texture coordinates.
    pub(super) fn has_uv(&self) -> bool {
        self.uv.is_some()
    }

    /// Returns a vertex, given all values of its wedge.
    fn vertex(&self, position: [f64; 3], values: &[f32]) -> GpuVertex {
        let normal = self.normal.map_or(Vec3::ZERO, |at| Vec3::from_slice(&values[at..]));
        let level = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
        let [r, g, b] = self.color.map_or([255; 3], |at| [0, 1, 2].map(|k| level(values[at + k])));
        GpuVertex {
            position: (DVec3::from(position) - self.origin).as_vec3().into(),
            attributes: VertexAttributes {
                normal: fractions(normal.normalize_or_zero().into()),
                color: [r, g, b, 255],
                uv: self.uv.map_or([0.0; 2], |at| [values[at], values[at + 1]]),
            },
        }
    }

    /// Appends the vertices of a node that is on its way.
    pub(super) fn moved(&self, first: u32, state: &VertexValues, to: &mut Vec<MovedVertex>) {
        let wedges = (first..).zip(state.values.chunks_exact(self.width.max(1)));
        to.extend(wedges.map(|(vertex, values)| MovedVertex {
            vertex,
            now: self.vertex(state.position, values),
        }));
    }

    /// Returns all vertices of a model, in their order.
    pub(super) fn all(&self, model: &CutModel) -> (Vec<[f32; 3]>, Vec<VertexAttributes>) {
        let levels = model.levels();
        let nodes = 0..levels.node_count() as u32;
        match levels {
            Hierarchy::Contractions(mt) => {
                let mut values = Vec::with_capacity(self.width);
                nodes
                    .flat_map(|node| mt.wedges_of(node).map(move |wedge| (node, wedge)))
                    .map(|(node, wedge)| {
                        values.clear();
                        mt.append_values(wedge, &mut values);
                        let vertex = self.vertex(mt.position(node), &values);
                        (vertex.position, vertex.attributes)
                    })
                    .unzip()
            }
            Hierarchy::RightTriangles(field) => nodes
                .map(|node| {
                    let normal = model.field_normals[node as usize].normalize_or_zero();
                    let vertex = self.vertex(field.position(node), &[]);
                    let normal = fractions(normal.as_vec3().into());
                    (vertex.position, VertexAttributes { normal, ..vertex.attributes })
                })
                .unzip(),
        }
    }
}
