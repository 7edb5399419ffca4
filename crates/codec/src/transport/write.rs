//! Encoding of a mesh as a transport file.

use meshlod_mesh::{Connectivity, Mesh, VertexId};

use super::encode::{Residual, residuals, symbols};
use super::encoded_layers::EncodedLayers;
use super::face_blocks::face_blocks;
use super::fit::{fit, shapes};
use super::grid::QuantizationGrid;
use super::header::{Entry, Header, least_bytes};
use super::lanes::LANES;
use super::layers::{LayersFormat, MeshLayers};
use super::models::{ModelCodes, Models};
use super::predict::CellVec;
use super::rans::encode;
use super::symbol_bits::SymbolBits;
use super::walk::{BlockWalk, Walker};
use super::weld_blocks::{WeldTable, checksum, key};
use super::{
    MAX_LAYER_VALUES, MAX_LAYERS, Transport, TransportError, TransportOptions, max_block_faces,
};
use crate::attributes::LayerCoding;

/// Greatest number of faces, for 32-bit numbers of faces and of their sides.
const MAX_MESH_FACES: usize = 1 << 30;

impl Transport {
    /// Encodes a mesh as an `.mlz` file, with positions rounded to a grid and attributes within
    /// bounds.
    ///
    /// Faces are unchanged except for the corner they start at, and so are their materials and
    /// objects. Every vertex that a face uses comes back once. Wedges of a vertex whose values are
    /// equal after rounding become one. Cost: O(n).
    /// # Errors
    /// A mesh without faces, an invalid position, attribute or vertex index, or an option out of
    /// range.
    pub fn encode(mesh: &Mesh, options: &TransportOptions) -> Result<Self, TransportError> {
        Self::encode_with_resources(mesh, &[], options)
    }

    /// Encodes a mesh, and appends bytes that [`TransportFile::resources`](super::TransportFile)
    /// gives back: they mean nothing to this crate.
    /// # Errors
    /// As [`Transport::encode`].
    pub fn encode_with_resources(
        mesh: &Mesh,
        resources: &[u8],
        options: &TransportOptions,
    ) -> Result<Self, TransportError> {
        if mesh.faces.is_empty() {
            return Err(TransportError::Empty);
        }
        if mesh.faces.len() > MAX_MESH_FACES {
            return Err(TransportError::TooMany(mesh.faces.len()));
        }
        if !(16..=max_block_faces()).contains(&options.block_faces) {
            return Err(TransportError::Block(options.block_faces));
        }
        let (grid, cells) = QuantizationGrid::of(mesh, options.quantization)?;
        check_attributes(mesh)?;
        let walks = walks(&mesh.faces, &cells, options.block_faces);
        let (format, layers) = MeshLayers::new(mesh, &options.attributes);
        let unused = mesh.used_vertices().iter().filter(|&&used| !used).count();
        let this = write((grid, &cells), &walks, (format, &layers), resources);
        Ok(Self { unused_vertices: unused, ..this })
    }
}

/// Checks that attributes and labels are valid, and within the limits of a file.
fn check_attributes(mesh: &Mesh) -> Result<(), TransportError> {
    mesh.validate_attributes()?;
    let mut width = 0;
    let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    for (count, layer) in (1..).zip(layers) {
        width += layer.width;
        if count > MAX_LAYERS || width > MAX_LAYER_VALUES || !LayerCoding::is_storable(layer) {
            return Err(TransportError::Layer(layer.name.clone()));
        }
        if let Some(at) = layer.values.iter().position(|x| !x.is_finite()) {
            let (layer, wedge) = (layer.name.clone(), at / layer.width);
            return Err(TransportError::NotFiniteValue { layer, wedge });
        }
    }
    Ok(())
}

/// Partitions faces into blocks and walks over each.
pub(super) fn walks(faces: &[[VertexId; 3]], cells: &[CellVec], size: usize) -> Vec<BlockWalk> {
    let connectivity = Connectivity::new(faces, cells.len());
    let blocks = face_blocks(faces, cells, &connectivity, size);
    let mut walker = Walker::new(faces, &connectivity, blocks.of.clone());
    blocks.members().zip(0..).map(|(members, block)| walker.walk(block, members)).collect()
}

fn write(
    (grid, cells): (QuantizationGrid, &[CellVec]),
    walks: &[BlockWalk],
    (mut format, layers): (LayersFormat, &MeshLayers),
    resources: &[u8],
) -> Transport {
    let (codes, residuals) = fit_models(walks, cells);
    let models = Models::new(&codes);
    let first_bits = first_bits(walks, cells);
    let attributes = EncodedLayers::new(&mut format, layers, walks, cells);
    let (tags, vertices) = tags(walks, cells);
    let mut payload = Vec::new();
    let mut entries = Vec::with_capacity(walks.len());
    let mut row = Vec::new();
    let mut bits = SymbolBits::new(format.layers.len());
    for (at, ((walk, residuals), tags)) in walks.iter().zip(&residuals).zip(&tags).enumerate() {
        row.clear();
        let first = cells[walk.vertices[0] as usize];
        let parts = symbols(walk, (first, first_bits), tags, residuals, &models, &mut row);
        bits.add(&row, parts);
        let values = attributes.push(at, &format, &mut row, &mut bits);
        let start = payload.len();
        let sum = checksum(walk.vertices.iter().map(|&v| cells[v as usize]));
        encode(&row, sum, &mut payload);
        let least = least_bytes(walk.faces.len(), values);
        payload.resize(payload.len().max(start + least), 0);
        entries.push(Entry { faces: walk.faces.len(), bytes: payload.len() - start });
    }
    payload.extend(resources);
    let reports = bits.reports(&format);
    let is_bare = format.is_empty() && resources.is_empty();
    let layers = (!is_bare).then_some((format, attributes.codes));
    let faces: usize = walks.iter().map(|walk| walk.faces.len()).sum();
    let resources = resources.len();
    let header = Header { grid, first_bits, faces, vertices, codes, layers, resources, entries };
    let mut bytes = header.store(&payload);
    bytes.extend(payload);
    let sizes = bits.sizes(bytes.len(), resources);
    let blocks = walks.len();
    Transport { bytes, vertices, faces, blocks, sizes, layers: reports, unused_vertices: 0 }
}

/// Fits the models of positions and faces, and returns the residuals of each block, too.
fn fit_models(walks: &[BlockWalk], cells: &[CellVec]) -> (ModelCodes, Vec<Vec<Residual>>) {
    let mut codes = fit(walks, cells);
    let models = Models::new(&codes);
    let residuals = walks.chunks(LANES).flat_map(|walks| residuals(walks, cells, &models));
    let residuals: Vec<_> = residuals.take(walks.len()).collect();
    codes.shapes = shapes(residuals.iter().flatten());
    (codes, residuals)
}

/// Returns how many bits the first vertices of all blocks take along each axis.
fn first_bits(walks: &[BlockWalk], cells: &[CellVec]) -> [u8; 3] {
    [0, 1, 2].map(|k| {
        let most = walks.iter().map(|walk| cells[walk.vertices[0] as usize][k] as u32).max();
        (u32::BITS - most.unwrap_or(0).leading_zeros()) as u8
    })
}

/// Returns the vertices of each block that need a tag, and the number of vertices of the mesh.
fn tags(walks: &[BlockWalk], cells: &[CellVec]) -> (Vec<Vec<(u16, u32)>>, usize) {
    let mut uses = vec![0u8; cells.len()];
    for &v in walks.iter().flat_map(|walk| &walk.vertices) {
        uses[v as usize] = uses[v as usize].saturating_add(1);
    }
    // Number of tags used in each cell so far.
    let mut welds = WeldTable::new(1 << 10);
    let mut tag_of = vec![u32::MAX; cells.len()];
    let tags = walks.iter().map(|walk| {
        let mut tags = Vec::new();
        for (local, (&v, &is_border)) in walk.vertices.iter().zip(&walk.borders).enumerate() {
            let v = v as usize;
            if !is_border && uses[v] == 1 {
                continue;
            }
            if tag_of[v] == u32::MAX {
                let next = welds.find_or_insert(key(cells[v]), 0, 0);
                tag_of[v] = *next;
                *next += 1;
            }
            if tag_of[v] > 0 || !is_border {
                tags.push((local as u16, tag_of[v]));
            }
        }
        tags
    });
    let tags = tags.collect();
    (tags, uses.iter().filter(|&&uses| uses > 0).count())
}
