//! Attributes of a mesh as integers, for the encoder.

use std::collections::HashMap;

use meshlod_mesh::{AttributeBounds, FaceId, Layer, Mesh, VertexId, WedgeId};

use super::super::walk::BlockWalk;
use super::format::LayersFormat;
use super::layer_format::LayerFormat;
use crate::attributes::LayerCoding;

/// Rounded attributes and labels of a mesh.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct MeshLayers<'m> {
    /// Wedge of each corner; those of a vertex with the same integers are one.
    corners: Vec<[u32; 3]>,
    /// Integers of all wedges, for each layer.
    numbers: Vec<Vec<i32>>,
    labels: [&'m [u32]; 2],
}

/// Attributes and labels of a block's faces.
#[derive(Clone, Debug)]
pub(in super::super) struct BlockSource<'a> {
    /// Wedge of the mesh at each corner.
    pub(super) corners: Vec<[u32; 3]>,
    /// Integers of all wedges of the mesh, for each layer.
    pub(super) numbers: &'a [Vec<i32>],
    pub(super) labels: [Vec<u32>; 2],
}

impl<'m> MeshLayers<'m> {
    /// Rounds the attributes of a mesh within bounds.
    pub(in super::super) fn new(mesh: &'m Mesh, bounds: &AttributeBounds) -> (LayersFormat, Self) {
        let (mut format, mut this) = (LayersFormat::default(), Self::default());
        for (kind, labels) in [&mesh.materials, &mesh.objects].into_iter().enumerate() {
            format.names[kind] = labels.as_ref().map(|labels| labels.names.clone());
            this.labels[kind] = labels.as_ref().map_or(&[], |labels| &labels.of_face);
        }
        if let Some(attributes) = mesh.attributes.as_ref().filter(|of| !of.layers.is_empty()) {
            let (wedges, corners) = used_wedges(&mesh.faces, &attributes.corners);
            let ids: Vec<_> = wedges.iter().map(|&(_, wedge)| wedge).collect();
            let mut rows = vec![Vec::new(); wedges.len()];
            let round = |layer| round(layer, &ids, bounds, &mut rows);
            format.layers.extend(attributes.layers.iter().map(round));
            this.merge(&format, &wedges, rows, &corners);
        }
        (format, this)
    }

    /// Makes wedges of a vertex with the same integers one.
    fn merge(
        &mut self,
        format: &LayersFormat,
        wedges: &[(VertexId, WedgeId)],
        rows: Vec<Vec<i32>>,
        corners: &[[u32; 3]],
    ) {
        let mut kept: HashMap<(VertexId, Vec<i32>), u32> = HashMap::with_capacity(rows.len());
        let mut of_wedge = Vec::with_capacity(rows.len());
        let widths: Vec<_> = format.layers.iter().map(|layer| layer.most.len()).collect();
        self.numbers = vec![Vec::new(); widths.len()];
        for (&(vertex, _), row) in wedges.iter().zip(rows) {
            let count = kept.len() as u32;
            let numbers = &mut self.numbers;
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
        self.corners =
            corners.iter().map(|face| face.map(|wedge| of_wedge[wedge as usize])).collect();
    }

    /// Gathers what belongs to the faces of a block.
    pub(in super::super) fn of_block(&self, walk: &BlockWalk) -> BlockSource<'_> {
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
        BlockSource { corners: corners.collect(), numbers: &self.numbers, labels }
    }
}

/// Rounds a layer, and appends the integers of these wedges to their rows.
fn round(
    layer: &Layer,
    wedges: &[WedgeId],
    bounds: &AttributeBounds,
    rows: &mut [Vec<i32>],
) -> LayerFormat {
    let mut coding = LayerCoding::new(layer, wedges, bounds);
    let mut most = vec![0; coding.components()];
    let mut decoded = Vec::with_capacity(layer.width);
    for (&wedge, row) in wedges.iter().zip(rows) {
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
    LayerFormat { coding, mode: 0, most }
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
    let corners = all.map(|(face, corners)| [0, 1, 2].map(|k| number((&face[k], corners[k]))));
    let corners = corners.collect();
    (wedges, corners)
}
