//! A whole mesh that stays compressed: positions by one of the schemes, faces in patches, attributes by the same rows.

mod file;
mod homes;
mod nodes;
mod positions;
mod target;
#[cfg(test)]
mod tests;
mod unite;

use meshlod_mesh::{Attributes, Mesh, MeshError, VertexId, WedgeId, merge_equal_wedges};
use thiserror::Error;

use self::homes::Homes;
use self::nodes::Nodes;
use self::positions::Positions;
pub use self::target::{Compression, Scheme, Target, compress, parts_for};
use self::unite::Exceptions;
use crate::attributes::{AttributeBounds, LayerReport, PackedLayer};
use crate::blocks::{BlocksError, Closeness, VertexBlocks};
use crate::bytes::Malformed;
use crate::kd::{BLOCK, blocks_of};
use crate::lattice::{Lattice, LatticeBlocks, LatticeError};
use crate::parts::{PackedParts, Parts, PartsError};
use crate::patch::{Patches, Rows};

/// A mesh in few bytes, of which any block of vertices and any patch of faces is decoded alone.
///
/// It has what faces use, in an order of its own, and not its materials and objects.
#[derive(Clone, Debug, PartialEq)]
pub struct Compressed {
    positions: Positions,
    patches: Patches,
    /// Where a wedge that is not its vertex's first has its position.
    homes: Homes,
    layers: Vec<PackedLayer>,
}

/// What a compressed mesh takes, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Positions, with all that decoding them needs.
    pub positions: usize,
    /// Faces, and which vertex each corner is.
    pub connectivity: usize,
    /// All layers.
    pub attributes: usize,
    /// All that, and what says where it is.
    pub total: usize,
}

/// Why a mesh is not compressed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CompressError {
    /// A mesh that is none.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// No face has three corners.
    #[error("the mesh has no faces to compress")]
    Empty,
    /// An attribute that is no number.
    #[error("layer \"{layer}\" has a value that is not finite at wedge {wedge}")]
    NotFinite {
        /// Its name.
        layer: String,
        /// Whose.
        wedge: usize,
    },
    /// More than places in files tell.
    #[error(
        "{0} faces are more than {MOST_FACES}, which is what one file holds: cut the mesh in tiles"
    )]
    TooManyFaces(usize),
    /// Attributes of more values, or with longer names, than files tell.
    #[error(
        "up to layer \"{0}\" wedges have more than {MOST_VALUES} values, or its name has more than 65535 bytes"
    )]
    Layer(String),
    /// Not a number of bits.
    #[error("{0} bits are none for coordinates: take 2 to 24")]
    Bits(u32),
    /// Not a distance.
    #[error("a mean error of {0} is none: take a distance above 0")]
    Error(f64),
    /// Not a part.
    #[error("a reduction of {0} is none: take a part between 0 and 1")]
    Reduction(f64),
    /// What parts refuse.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// What a lattice refuses.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// What blocks refuse.
    #[error(transparent)]
    Blocks(#[from] BlocksError),
}

/// So many values may wedges have in all layers: else a file of values that are all the same would be a small one of a
/// mesh without end.
const MOST_VALUES: usize = 255;
/// So many faces have less than 4 GB of bits, whatever they are.
const MOST_FACES: usize = 1 << 27;
/// So many blocks of vertices share a patch of about 256 faces. With twice as many a face takes half a bit less.
const BLOCKS_PER_PATCH: usize = 4;

impl Compressed {
    /// A mesh with its vertices on a lattice.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// No mesh, no faces, or nothing that a lattice or a file can have.
    pub fn on_lattice(
        mesh: &Mesh,
        lattice: Lattice,
        bounds: &AttributeBounds,
    ) -> Result<Compression, CompressError> {
        Self::of_blocks(mesh, bounds, |ordered| {
            let blocks = LatticeBlocks::of_blocks(&mesh.positions, ordered, lattice)?;
            Ok(Positions::Lattice(blocks.forgetful()))
        })
    }

    /// A mesh with its vertices in blocks that lie as the surface does.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// As [`Compressed::on_lattice`].
    pub fn in_blocks(
        mesh: &Mesh,
        closeness: Closeness,
        bounds: &AttributeBounds,
    ) -> Result<Compression, CompressError> {
        Self::of_blocks(mesh, bounds, |ordered| {
            let (blocks, _) = VertexBlocks::of_blocks(mesh, ordered, closeness)?;
            Ok(Positions::Blocks(blocks.forgetful()))
        })
    }

    /// A mesh in parts of its own. Faces that repeat a vertex are left out.
    /// # Errors
    /// No mesh, no faces, or nothing that a file can have.
    ///
    /// # Panics
    /// Parts of another mesh.
    pub fn in_parts(
        mesh: &Mesh,
        parts: &Parts,
        bounds: &AttributeBounds,
    ) -> Result<Compression, CompressError> {
        check(mesh)?;
        let nodes = Nodes::of_parts(mesh, parts);
        let (patches, order) = Patches::new(&nodes.faces, &nodes.row_of, nodes.rows, 1);
        let vertices: Vec<_> = order.iter().map(|&node| nodes.vertex_of[node as usize]).collect();
        let positions = PackedParts::new(parts, patches.rows().clone(), &vertices);
        let mut number = vec![0; order.len()];
        order.iter().zip(0..).for_each(|(&node, at)| number[node as usize] = at);
        let faces: Vec<_> =
            nodes.faces.iter().map(|face| face.map(|node| number[node as usize])).collect();
        let homes = Homes::Parts(Exceptions::new(&faces, &positions.cells(), &vertices));
        let layers = layers(mesh, &nodes, &order, patches.rows(), bounds);
        let mut seen = vec![false; mesh.positions.len()];
        let mut is_first = |v: &VertexId| !std::mem::replace(&mut seen[v.index()], true);
        let vertices = vertices.into_iter().filter(&mut is_first).collect();
        let compressed = Self { positions: Positions::Parts(positions), patches, homes, layers };
        Ok(Compression { compressed, vertices, reached: true })
    }

    /// A mesh with each vertex in one block, whose positions are made when their order is known.
    fn of_blocks(
        mesh: &Mesh,
        bounds: &AttributeBounds,
        positions: impl FnOnce(Vec<VertexId>) -> Result<Positions, CompressError>,
    ) -> Result<Compression, CompressError> {
        check(mesh)?;
        let blocks = blocks_of(mesh);
        let nodes = Nodes::of_blocks(mesh, &blocks);
        let has_doubles = nodes.vertex_of.len() > blocks.len();
        let rows_per_patch = BLOCKS_PER_PATCH * if has_doubles { 2 } else { 1 };
        let (patches, order) =
            Patches::new(&nodes.faces, &nodes.row_of, nodes.rows, rows_per_patch);
        let vertex = |&node: &u32| nodes.vertex_of[node as usize];
        let is_first =
            |node: &&u32| !has_doubles || nodes.row_of[**node as usize].is_multiple_of(2);
        let ordered: Vec<_> = order.iter().filter(is_first).map(vertex).collect();
        let homes = match has_doubles {
            false => Homes::Own,
            true => Homes::doubles(&order, &nodes, &ordered, patches.rows()),
        };
        let layers = layers(mesh, &nodes, &order, patches.rows(), bounds);
        let positions = positions(ordered.clone())?;
        let compressed = Self { positions, patches, homes, layers };
        Ok(Compression { compressed, vertices: ordered, reached: true })
    }

    /// The mesh, each vertex once: faces patch by patch, a wedge for each that there was.
    ///
    /// # Errors
    /// Bytes that were spoilt and not told by their sums.
    pub fn decode(&self) -> Result<Mesh, Malformed> {
        let faces = (0..self.patches.len()).map(|patch| self.patches.faces(patch));
        let faces = faces.collect::<Result<Vec<_>, _>>()?.concat();
        let (home, positions) = self.homes.all(&faces, &self.positions, self.patches.rows())?;
        let vertex = |node: u32| VertexId(home[node as usize]);
        let mut mesh = Mesh::new(positions, faces.iter().map(|face| face.map(vertex)).collect());
        if !self.layers.is_empty() {
            mesh.attributes = Some(Attributes {
                corners: faces.iter().map(|face| face.map(WedgeId)).collect(),
                wedge_count: home.len(),
                layers: self.layers.iter().map(PackedLayer::decode).collect(),
            });
            if let Homes::Parts(_) = self.homes {
                merge_equal_wedges(&mut mesh);
            }
        }
        Ok(mesh)
    }

    /// How many patches there are.
    pub fn patches(&self) -> usize {
        self.patches.len()
    }

    /// The faces of one patch with their vertices and wedges: nothing else is decoded.
    ///
    /// Of parts a vertex is one for each wedge.
    /// # Errors
    /// As [`Compressed::decode`].
    ///
    /// # Panics
    /// A patch that there is not.
    pub fn patch(&self, at: usize) -> Result<Mesh, Malformed> {
        let faces = self.patches.faces(at)?;
        let mut nodes: Vec<u32> = faces.as_flattened().to_vec();
        nodes.sort_unstable();
        nodes.dedup();
        let rows = self.patches.rows();
        let places: Vec<_> = nodes.iter().map(|&node| rows.place(node)).collect();
        let home = |(&node, &at)| self.homes.of(node, at, rows);
        let homes: Vec<_> = nodes.iter().zip(&places).map(home).collect();
        let mut vertices = homes.clone();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |list: &[u32], of: u32| list.binary_search(&of).expect("it is in the list");
        let wedges = |face: &[u32; 3]| face.map(|node| WedgeId::new(number(&nodes, node)));
        let corners: Vec<_> = faces.iter().map(wedges).collect();
        let vertex = |wedge: WedgeId| VertexId::new(number(&vertices, homes[wedge.index()]));
        let mut mesh = Mesh::new(
            vertices.iter().map(|&vertex| self.positions.at(vertex as usize)).collect(),
            corners.iter().map(|face| face.map(vertex)).collect(),
        );
        if !self.layers.is_empty() {
            let layers = self.layers.iter().map(|layer| layer.decode_some(&places)).collect();
            mesh.attributes = Some(Attributes { corners, wedge_count: nodes.len(), layers });
        }
        Ok(mesh)
    }

    /// What it takes.
    pub fn sizes(&self) -> Sizes {
        let positions = self.positions.bytes();
        let connectivity = self.patches.bytes() + self.homes.bytes();
        let attributes = self.layers.iter().map(PackedLayer::bytes).sum();
        let total = file::HEADER + positions + connectivity + attributes;
        Sizes { positions, connectivity, attributes, total }
    }

    /// How many vertices there are.
    pub fn vertices(&self) -> usize {
        self.positions.vertices()
    }

    /// How many faces there are.
    pub fn faces(&self) -> usize {
        self.patches.face_count()
    }

    /// How much less positions take than three `f32` for each vertex, as a part of that.
    pub fn reduction(&self) -> f64 {
        1.0 - self.positions.bytes() as f64 / (12 * self.vertices()) as f64
    }

    /// How many blocks of vertices there are, or parts.
    pub fn blocks(&self) -> usize {
        match &self.positions {
            Positions::Parts(parts) => parts.rows().len(),
            _ => self.positions.len().div_ceil(BLOCK),
        }
    }

    /// What each layer takes and has lost.
    pub fn layers(&self) -> Vec<LayerReport> {
        self.layers.iter().map(PackedLayer::report).collect()
    }
}

/// That there is a mesh that files can have.
fn check(mesh: &Mesh) -> Result<(), CompressError> {
    mesh.validate()?;
    match mesh.faces.len() {
        0 => return Err(CompressError::Empty),
        1..=MOST_FACES => {}
        many => return Err(CompressError::TooManyFaces(many)),
    }
    let mut values = 0;
    for layer in mesh.attributes.iter().flat_map(|attributes| &attributes.layers) {
        values += layer.width;
        if values > MOST_VALUES || !PackedLayer::is_told(layer) {
            return Err(CompressError::Layer(layer.name.clone()));
        }
        if let Some(at) = layer.values.iter().position(|x| !x.is_finite()) {
            let wedge = at / layer.width;
            return Err(CompressError::NotFinite { layer: layer.name.clone(), wedge });
        }
    }
    Ok(())
}

/// The layers of a mesh by the nodes of the rows.
fn layers(
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
