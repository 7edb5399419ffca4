//! Encoding of a mesh by each of the three storage schemes.

use meshlod_mesh::{AttributeBounds, Mesh, VertexId, WedgeId};

use super::face_labels::FaceLabels;
use super::faces::Faces;
use super::nodes::Nodes;
use super::weld_parts::WeldExceptions;
use super::{
    BLOCKS_PER_PATCH, CompressError, Compressed, Compression, MAX_FACES, MAX_VALUES, Positions,
    WedgeVertices,
};
use crate::attributes::{LayerCoding, PackedLayer};
use crate::blocks::{Accuracy, VertexBlocks};
use crate::kd::blocks_of;
use crate::lattice::{Lattice, LatticeBlocks};
use crate::parts::{PackedParts, Parts};
use crate::patch::{Patches, Rows};

impl Compressed {
    /// Compresses a mesh with its vertices rounded to a lattice, which other meshes can share.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// An invalid or empty mesh, or values that the lattice or the file cannot hold.
    pub fn on_lattice(
        mesh: &Mesh,
        lattice: Lattice,
        bounds: &AttributeBounds,
    ) -> Result<Compression, CompressError> {
        Self::from_blocks(mesh, bounds, |ordered| {
            Ok(Positions::Lattice(LatticeBlocks::from_blocks(&mesh.positions, ordered, lattice)?))
        })
    }

    /// Compresses a mesh with its vertices in blocks of 32 whose cells are aligned with the
    /// surface.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// As [`Compressed::on_lattice`].
    pub fn in_blocks(
        mesh: &Mesh,
        accuracy: Accuracy,
        bounds: &AttributeBounds,
    ) -> Result<Compression, CompressError> {
        Self::from_blocks(mesh, bounds, |ordered| {
            Ok(Positions::Blocks(VertexBlocks::from_blocks(mesh, ordered, accuracy)?))
        })
    }

    /// Compresses a mesh that has been partitioned, with its positions in 8 bits per axis.
    ///
    /// Faces that repeat a vertex are left out.
    ///
    /// # Errors
    /// An invalid or empty mesh, or values that the file cannot hold.
    ///
    /// # Panics
    /// If the parts are those of another mesh.
    pub fn in_parts(
        mesh: &Mesh,
        parts: &Parts,
        bounds: &AttributeBounds,
    ) -> Result<Compression, CompressError> {
        check(mesh)?;
        let nodes = Nodes::of_parts(mesh, parts);
        let (patches, order, made) = Patches::new(&nodes.faces, &nodes.row_of, nodes.rows, 1);
        let labels = FaceLabels::of_mesh(mesh, &nodes, &patches, &made);
        let vertices: Vec<_> = order.iter().map(|&node| nodes.vertex_of[node as usize]).collect();
        let positions = PackedParts::new(parts, patches.rows().clone(), &vertices);
        let mut number = vec![0; order.len()];
        order.iter().zip(0..).for_each(|(&node, at)| number[node as usize] = at);
        let faces: Vec<_> =
            nodes.faces.iter().map(|face| face.map(|node| number[node as usize])).collect();
        let exceptions = WeldExceptions::new(&faces, &positions.cells(), &vertices);
        let wedge_vertices = WedgeVertices::Parts(exceptions);
        let layers = pack_layers(mesh, &nodes, &order, patches.rows(), bounds);
        let mut seen = vec![false; mesh.positions.len()];
        let mut is_first = |v: &VertexId| !std::mem::replace(&mut seen[v.index()], true);
        let vertices = vertices.into_iter().filter(&mut is_first).collect();
        let positions = Positions::Parts(positions);
        let faces = Faces::Patches(patches);
        let resources = Vec::new();
        let compressed = Self { positions, faces, wedge_vertices, layers, labels, resources };
        Ok(Compression { compressed, vertices, reached: true })
    }

    /// Compresses a mesh with each vertex in one block. `positions` encodes the vertices in their
    /// final order, which is only known once the patches are made.
    fn from_blocks(
        mesh: &Mesh,
        bounds: &AttributeBounds,
        positions: impl FnOnce(&[VertexId]) -> Result<Positions, CompressError>,
    ) -> Result<Compression, CompressError> {
        check(mesh)?;
        let blocks = blocks_of(mesh);
        let nodes = Nodes::of_blocks(mesh, &blocks);
        let has_extra = nodes.vertex_of.len() > blocks.len();
        let rows_per_patch = BLOCKS_PER_PATCH * if has_extra { 2 } else { 1 };
        let (patches, order, made) =
            Patches::new(&nodes.faces, &nodes.row_of, nodes.rows, rows_per_patch);
        let labels = FaceLabels::of_mesh(mesh, &nodes, &patches, &made);
        let vertex = |&node: &u32| nodes.vertex_of[node as usize];
        let is_first = |node: &&u32| !has_extra || nodes.row_of[**node as usize].is_multiple_of(2);
        let vertices: Vec<_> = order.iter().filter(is_first).map(vertex).collect();
        let wedge_vertices = match has_extra {
            false => WedgeVertices::Identity,
            true => WedgeVertices::extra(&order, &nodes, &vertices, patches.rows()),
        };
        let layers = pack_layers(mesh, &nodes, &order, patches.rows(), bounds);
        let positions = positions(&vertices)?;
        let faces = Faces::Patches(patches);
        let resources = Vec::new();
        let compressed = Self { positions, faces, wedge_vertices, layers, labels, resources };
        Ok(Compression { compressed, vertices, reached: true })
    }
}

/// Checks that the mesh is valid and within the limits of a file.
pub(super) fn check(mesh: &Mesh) -> Result<(), CompressError> {
    mesh.validate()?;
    match mesh.faces.len() {
        0 => return Err(CompressError::Empty),
        1..=MAX_FACES => {}
        count => return Err(CompressError::TooManyFaces(count)),
    }
    let mut values = 0;
    for layer in mesh.attributes.iter().flat_map(|attributes| &attributes.layers) {
        values += layer.width;
        if values > MAX_VALUES || !LayerCoding::is_storable(layer) {
            return Err(CompressError::Layer(layer.name.clone()));
        }
        if let Some(at) = layer.values.iter().position(|x| !x.is_finite()) {
            let wedge = at / layer.width;
            return Err(CompressError::NotFinite { layer: layer.name.clone(), wedge });
        }
    }
    Ok(())
}

/// Packs the attribute layers of a mesh, with nodes in their final order.
fn pack_layers(
    mesh: &Mesh,
    nodes: &Nodes,
    order: &[u32],
    rows: &Rows,
    bounds: &AttributeBounds,
) -> Vec<PackedLayer> {
    let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    let wedges: Vec<_> =
        order.iter().map(|&node| WedgeId(nodes.corner_of[node as usize])).collect();
    layers.map(|layer| PackedLayer::new(layer, &wedges, rows.clone(), bounds)).collect()
}
