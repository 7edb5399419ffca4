//! Attributes and labels of one block.

use glam::DVec2;
use meshlod_mesh::octahedral::unfold;

use super::coder::{BlockPart, Coder};
use super::directions::{BY_NEIGHBOURS, Expected, by_neighbours, code_directions};
use super::entries::{ENTRY_BITS, LayerEntries};
use super::format::LayersFormat;
use super::geometry::BlockGeometry;
use super::job::LayerJob;
use super::labels::code_labels;
use super::layer_format::{LayerContexts, LayerFormat, Predictor};
use super::normals::{FaceWeight, normal_of};
use super::source::BlockSource;
use super::tangents::TangentFrame;
use super::uv::code_uvs;
use super::values::code_values;
use super::wedges::{BlockWedges, code_wedges};

/// Attributes and labels of a block.
#[derive(Clone, Debug)]
pub(in super::super) struct BlockLayers {
    pub(in super::super) wedges: BlockWedges,
    pub(in super::super) layers: Vec<BlockLayer>,
    /// Materials and objects of the faces.
    pub(in super::super) labels: [Option<Vec<u32>>; 2],
}

/// Values of a layer in a block.
#[derive(Clone, Debug)]
pub(in super::super) struct BlockLayer {
    entries: LayerEntries,
    /// Integers, entry by entry.
    numbers: Vec<i32>,
}

impl BlockLayer {
    /// Returns the integers of a wedge.
    pub(in super::super) fn of(&self, wedge: usize, components: usize) -> &[i32] {
        &self.numbers[components * usize::from(self.entries.of_wedge[wedge])..][..components]
    }
}

/// Codes everything that follows the positions of a block. Returns `None` if the bytes are damaged:
/// a face has a label that does not exist, or there are more than `max_values` values.
pub(in super::super) fn code_block(
    geometry: &BlockGeometry,
    format: &LayersFormat,
    coder: &mut impl Coder,
    max_values: usize,
    source: Option<&BlockSource>,
) -> Option<BlockLayers> {
    let (contexts, label_contexts, _) = format.contexts();
    let mut wedges = BlockWedges::default();
    if !format.layers.is_empty() {
        coder.begin(BlockPart::Wedges);
        let corners = source.map(|source| &source.corners[..]);
        wedges = code_wedges(&geometry.faces, coder, corners);
    }
    if wedges.vertex.len() * format.width() > max_values {
        return None;
    }
    let mut layers: Vec<Option<BlockLayer>> = vec![None; format.layers.len()];
    for at in format.order() {
        coder.begin(BlockPart::Layer(at));
        let numbers = source.map(|source| &source.numbers[at][..]);
        let block = BlockCoding { geometry, wedges: &wedges, format, layers: &layers };
        layers[at] = Some(block.layer(&format.layers[at], contexts[at], coder, numbers));
    }
    coder.begin(BlockPart::Labels);
    let mut labels = [None, None];
    for kind in 0..2 {
        if let Some(names) = &format.names[kind] {
            let source = source.map(|source| &source.labels[kind][..]);
            let context = label_contexts[kind];
            labels[kind] = Some(code_labels(&geometry.faces, names.len(), context, coder, source)?);
        }
    }
    let layers = layers.into_iter().map(|layer| layer.expect("all are coded")).collect();
    Some(BlockLayers { wedges, layers, labels })
}

/// Block whose layers are being coded.
pub(super) struct BlockCoding<'a> {
    pub(super) geometry: &'a BlockGeometry<'a>,
    pub(super) wedges: &'a BlockWedges,
    pub(super) format: &'a LayersFormat,
    pub(super) layers: &'a [Option<BlockLayer>],
}

impl BlockCoding<'_> {
    /// Codes a layer; `numbers` has the integers of all wedges of the mesh.
    pub(super) fn layer(
        &self,
        layer: &LayerFormat,
        at: LayerContexts,
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
        let entries = LayerEntries::code(&self.geometry.faces, self.wedges, coder, at.bits, same);
        let source: Option<Vec<i32>> = numbers
            .map(|numbers| entries.wedge.iter().flat_map(|&wedge| of(numbers, wedge)).collect());
        let contexts = LayerContexts { bits: at.bits + ENTRY_BITS, ..at };
        let geometry = self.geometry;
        let job =
            LayerJob { geometry, entries: &entries, layer, contexts, source: source.as_deref() };
        let mut out = vec![0; components * entries.len()];
        self.values(&job, coder, &mut out);
        BlockLayer { entries, numbers: out }
    }

    /// Codes the values of entries.
    fn values(&self, job: &LayerJob, coder: &mut impl Coder, out: &mut [i32]) {
        let &LayerJob { geometry, entries, layer, .. } = job;
        let mode = layer.mode;
        match layer.predictor() {
            Predictor::Uvs => code_uvs(job, coder, out),
            Predictor::Values => code_values(job, coder, out),
            Predictor::Normals if mode == BY_NEIGHBOURS => {
                code_directions(job, &by_neighbours(), coder, out);
            }
            Predictor::Normals => {
                let weight = FaceWeight::ALL[usize::from(mode % 3)];
                let guess = |entry| normal_of(entry, entries, geometry, weight);
                let trust = f64::from(mode / 3) / 8.0;
                code_directions(job, &Expected { guess, trust }, coder, out);
            }
            Predictor::Tangents => {
                let frame = self.tangent_frame();
                if mode == BY_NEIGHBOURS {
                    code_directions(job, &by_neighbours(), coder, out);
                } else {
                    let guess = |entry| frame.tangent_of(entry, entries);
                    let trust = f64::from(mode) / 8.0;
                    code_directions(job, &Expected { guess, trust }, coder, out);
                }
                frame.code_signs(job, coder, out);
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
