//! Attributes of a mesh as integers, for the encoder.

use std::collections::HashMap;
use std::sync::Arc;

use meshlod_mesh::{AttributeBounds, FaceId, Mesh, VertexId, WedgeId};

use super::super::walk::BlockWalk;
use super::format::{Format, LayerFormat};
use crate::attributes::LayerCoding;

/// Rounded attributes and labels of a mesh.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct MeshLayers<'m> {
    pub(in super::super) format: Format,
    /// Wedge of each corner; those of a vertex with the same integers are one.
    corners: Vec<[u32; 3]>,
    /// Integers of all wedges, for each layer.
    numbers: Arc<Vec<Vec<i32>>>,
    labels: [&'m [u32]; 2],
}

/// Attributes and labels of a block's faces.
#[derive(Clone, Debug)]
pub(in super::super) struct BlockSource {
    /// Wedge of the mesh at each corner.
    pub(super) corners: Vec<[u32; 3]>,
    /// Integers of all wedges of the mesh, for each layer.
    pub(super) numbers: Arc<Vec<Vec<i32>>>,
    pub(super) labels: [Vec<u32>; 2],
}

impl<'m> MeshLayers<'m> {
    /// Rounds the attributes of a mesh within bounds.
    pub(in super::super) fn new(mesh: &'m Mesh, bounds: &AttributeBounds) -> Self {
        let mut this = Self::default();
        for (kind, labels) in [&mesh.materials, &mesh.objects].into_iter().enumerate() {
            this.format.names[kind] = labels.as_ref().map(|labels| labels.names.clone());
            this.labels[kind] = labels.as_ref().map_or(&[], |labels| &labels.of_face);
        }
        let Some(attributes) = mesh.attributes.as_ref().filter(|of| !of.layers.is_empty()) else {
            return this;
        };
        let (wedges, corners) = used_wedges(&mesh.faces, &attributes.corners);
        let ids: Vec<_> = wedges.iter().map(|&(_, wedge)| wedge).collect();
        let mut rows = vec![Vec::new(); wedges.len()];
        for layer in &attributes.layers {
            let mut coding = LayerCoding::new(layer, &ids, bounds);
            let mut most = vec![0; coding.components()];
            let mut decoded = Vec::with_capacity(layer.width);
            for (&wedge, row) in ids.iter().zip(&mut rows) {
                let numbers = coding.numbers(layer.of(wedge));
                most.iter_mut().zip(&numbers).for_each(|(most, &x)| *most = x.max(*most));
                decoded.clear();
                coding.values(&numbers, &mut decoded);
                coding.max_error = coding.max_error.max(coding.error(layer.of(wedge), &decoded));
                row.extend(numbers.iter().map(|&x| x as i32));
            }
            if let Some(bits) = coding.direction_bits() {
                most.fill((1 << bits) - 1);
            }
            this.format.layers.push(LayerFormat { coding, mode: 0, most });
        }
        this.merge(&wedges, rows, &corners);
        this
    }

    /// Makes wedges of a vertex with the same integers one.
    fn merge(
        &mut self,
        wedges: &[(VertexId, WedgeId)],
        rows: Vec<Vec<i32>>,
        corners: &[[u32; 3]],
    ) {
        let mut kept: HashMap<(VertexId, Vec<i32>), u32> = HashMap::with_capacity(rows.len());
        let mut of_wedge = Vec::with_capacity(rows.len());
        let widths: Vec<_> = self.format.layers.iter().map(|layer| layer.most.len()).collect();
        let mut numbers = vec![Vec::new(); widths.len()];
        for (&(vertex, _), row) in wedges.iter().zip(rows) {
            let count = kept.len() as u32;
            let numbers = &mut numbers;
            let wedge = *kept.entry((vertex, row)).or_insert_with_key(|(_, row)| {
                let mut rest = &row[..];
                for (&width, numbers) in widths.iter().zip(numbers) {
                    let (own, after) = rest.split_at(width);
                    numbers.extend(own);
                    rest = after;
                }
                count
            });
            of_wedge.push(wedge);
        }
        self.numbers = Arc::new(numbers);
        self.corners =
            corners.iter().map(|face| face.map(|wedge| of_wedge[wedge as usize])).collect();
    }

    /// Gathers what belongs to the faces of a block.
    pub(in super::super) fn of_block(&self, walk: &BlockWalk) -> BlockSource {
        let labels = self.labels.map(|of_face| {
            let faces = walk.sides.iter().filter(|_| !of_face.is_empty());
            faces.map(|side| of_face[side.face().index()]).collect()
        });
        let corners = walk.sides.iter().filter(|_| !self.corners.is_empty());
        let corners = corners.map(|side| {
            let FaceId(face) = side.face();
            let mut corners = self.corners[face as usize];
            corners.rotate_left(side.corner());
            corners
        });
        BlockSource { corners: corners.collect(), numbers: Arc::clone(&self.numbers), labels }
    }
}

/// Returns the wedges that faces use, with their vertices, and their numbers at all corners.
fn used_wedges(
    faces: &[[VertexId; 3]],
    corners: &[[WedgeId; 3]],
) -> (Vec<(VertexId, WedgeId)>, Vec<[u32; 3]>) {
    let most = corners.as_flattened().iter().max().map_or(0, |wedge| wedge.index() + 1);
    let mut numbers = vec![u32::MAX; most];
    let mut wedges = Vec::new();
    let mut number = |(&vertex, wedge): (&VertexId, WedgeId)| {
        let number = &mut numbers[wedge.index()];
        if *number == u32::MAX {
            *number = wedges.len() as u32;
            wedges.push((vertex, wedge));
        }
        *number
    };
    let all = faces.iter().zip(corners);
    let corners = all.map(|(face, corners)| {
        [0, 1, 2].map(|k| number((&face[k], corners[k])))
    });
    let corners = corners.collect();
    (wedges, corners)
}
