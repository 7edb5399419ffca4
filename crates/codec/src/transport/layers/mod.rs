//! Attributes of wedges, and materials and objects of faces, block by block.
//!
//! They follow the positions of a block, so that all of its geometry is known by then. Encoder,
//! decoder and the fitting of tables go through the same code, [`code_block`], with another
//! [`Coder`] each.

mod adjacency;
mod coder;
mod directions;
mod energy;
mod entries;
mod fit;
mod format;
mod geometry;
mod labels;
mod models;
mod normals;
mod octahedron;
mod source;
mod tangents;
mod uv;
mod values;
mod wedges;

use glam::DVec2;
use meshlod_mesh::octahedral::unfold;

use self::coder::Coder;
pub(super) use self::coder::{Reader, Writer};
use self::directions::{DirectionCoding, code_directions};
use self::entries::{ENTRY_BITS, Entries};
pub(super) use self::fit::fit;
pub(super) use self::format::Format;
use self::format::{Contexts, LayerFormat, Predictor};
pub(super) use self::geometry::BlockGeometry;
use self::labels::code_labels;
pub(super) use self::models::{Shape, TableCodes, Tables};
use self::normals::{Weight, normal_of};
pub(super) use self::source::{BlockSource, MeshLayers};
use self::tangents::TangentFrame;
use self::uv::code_uvs;
use self::values::code_values;
pub(super) use self::wedges::BlockWedges;
use self::wedges::code_wedges;

/// Attributes and labels of a block.
#[derive(Clone, Debug)]
pub(super) struct BlockLayers {
    pub(super) wedges: BlockWedges,
    pub(super) layers: Vec<BlockLayer>,
    /// Materials and objects of the faces.
    pub(super) labels: [Option<Vec<u32>>; 2],
}

/// Values of a layer in a block.
#[derive(Clone, Debug)]
pub(super) struct BlockLayer {
    entries: Entries,
    /// Integers, entry by entry.
    numbers: Vec<i32>,
}

impl BlockLayer {
    /// Returns the integers of a wedge.
    pub(super) fn of(&self, wedge: usize, components: usize) -> &[i32] {
        &self.numbers[components * usize::from(self.entries.of_wedge[wedge])..][..components]
    }
}

/// What part of a block is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// Wedges of corners.
    Wedges,
    /// Attribute layer with this number.
    Layer(usize),
    /// Materials and objects.
    Labels,
}

/// Codes everything that follows the positions of a block. Returns `None` if the bytes are damaged:
/// a face has a label that does not exist, or there are more than `max_values` values.
pub(super) fn code_block(
    geometry: &BlockGeometry,
    format: &Format,
    coder: &mut impl Coder,
    max_values: usize,
    source: Option<&BlockSource>,
) -> Option<BlockLayers> {
    let (contexts, label_contexts, _) = format.contexts();
    let mut wedges = BlockWedges::default();
    if !format.layers.is_empty() {
        coder.begin(Part::Wedges);
        let corners = source.map(|source| &source.corners[..]);
        wedges = code_wedges(&geometry.faces, coder, corners);
    }
    if wedges.vertex.len() * format.width() > max_values {
        return None;
    }
    let mut layers: Vec<Option<BlockLayer>> = vec![None; format.layers.len()];
    for at in format.order() {
        coder.begin(Part::Layer(at));
        let numbers = source.map(|source| &source.numbers[at][..]);
        let block = Block { geometry, wedges: &wedges, format, layers: &layers };
        layers[at] = Some(block.layer(&format.layers[at], contexts[at], coder, numbers));
    }
    coder.begin(Part::Labels);
    let mut labels = [None, None];
    for kind in 0..2 {
        if let Some(names) = &format.names[kind] {
            let source = source.map(|source| &source.labels[kind][..]);
            let context = label_contexts[kind];
            labels[kind] =
                Some(code_labels(&geometry.faces, names.len(), context, coder, source)?);
        }
    }
    let layers = layers.into_iter().map(|layer| layer.expect("all are coded")).collect();
    Some(BlockLayers { wedges, layers, labels })
}

/// Block whose layers are being coded.
struct Block<'a> {
    geometry: &'a BlockGeometry<'a>,
    wedges: &'a BlockWedges,
    format: &'a Format,
    layers: &'a [Option<BlockLayer>],
}

impl Block<'_> {
    /// Codes a layer; `numbers` has the integers of all wedges of the mesh.
    fn layer(
        &self,
        layer: &LayerFormat,
        at: Contexts,
        coder: &mut impl Coder,
        numbers: Option<&[i32]>,
    ) -> BlockLayer {
        let components = layer.most.len();
        let sources = &self.wedges.sources;
        let of = |numbers: &'_ [i32], wedge: u16| {
            let wedge = sources[usize::from(wedge)] as usize;
            numbers[components * wedge..][..components].to_vec()
        };
        let same = numbers.map(|numbers| move |a, b| of(numbers, a) == of(numbers, b));
        let entries = Entries::code(&self.geometry.faces, self.wedges, coder, at.bits, same);
        let source: Option<Vec<i32>> = numbers
            .map(|numbers| entries.wedge.iter().flat_map(|&wedge| of(numbers, wedge)).collect());
        let mut out = vec![0; components * entries.len()];
        self.values(layer, &entries, at, coder, &mut out, source.as_deref());
        BlockLayer { entries, numbers: out }
    }

    /// Codes the values of entries.
    fn values(
        &self,
        layer: &LayerFormat,
        entries: &Entries,
        at: Contexts,
        coder: &mut impl Coder,
        out: &mut [i32],
        source: Option<&[i32]>,
    ) {
        let (geometry, mode) = (self.geometry, layer.mode);
        let directions = |trust| DirectionCoding {
            context: at.residuals,
            bits: layer.coding.direction_bits().unwrap_or(3),
            stride: layer.most.len(),
            trust: f64::from(trust) / 8.0,
        };
        let bits = at.bits + ENTRY_BITS;
        match layer.predictor() {
            Predictor::Uvs => {
                code_uvs(geometry, entries, (at.residuals, mode), coder, out, &layer.most, source);
            }
            Predictor::Normals => {
                let weight = Weight::ALL[usize::from(mode % 3)];
                let guess = |entry| normal_of(entry, entries, geometry, weight);
                code_directions(entries, directions(mode / 3), guess, coder, out, source);
            }
            Predictor::Tangents => {
                let frame = self.tangent_frame();
                let guess = |entry| frame.tangent_of(entry, entries);
                code_directions(entries, directions(mode), guess, coder, out, source);
                frame.code_signs(entries, bits, coder, out, source);
            }
            Predictor::Values => {
                let contexts = (at.residuals, bits, mode);
                code_values(geometry, entries, contexts, coder, out, &layer.most, source);
            }
        }
    }

    /// Returns the first texture coordinates and normals of all corners.
    fn tangent_frame(&self) -> TangentFrame<'_> {
        let find = |predictor| {
            let at = self.format.layers.iter().position(|of| of.predictor() == predictor)?;
            Some((&self.format.layers[at], self.layers[at].as_ref()?))
        };
        let of_corners = |layer: &'_ BlockLayer| -> Vec<[i32; 2]> {
            let corners = self.wedges.of_corner.iter();
            let numbers = corners.map(|&wedge| layer.of(wedge.into(), 2));
            numbers.map(|numbers| [numbers[0], numbers[1]]).collect()
        };
        let uv = find(Predictor::Uvs).map(|(_, layer)| {
            of_corners(layer).into_iter().map(|uv| DVec2::from(uv.map(f64::from))).collect()
        });
        let normal = find(Predictor::Normals).map(|(format, layer)| {
            let bits = format.coding.direction_bits().unwrap_or(3);
            let of = |code: [i32; 2]| unfold(code.map(|x| x as u32), bits);
            of_corners(layer).into_iter().map(of).collect()
        });
        TangentFrame { geometry: self.geometry, uv, normal }
    }
}

/// Returns the integer nearest to a prediction, from 0 to `most`.
fn nearest(x: f64, most: u32) -> i32 {
    ((x + 0.5).floor().clamp(0.0, most.into())) as i32
}
