//! Choice of how each layer is predicted, and fitting of the tables.

use super::block::{BlockCoding, BlockLayer, code_block};
use super::format::LayersFormat;
use super::geometry::BlockGeometry;
use super::layer_format::LayerContexts;
use super::models::TableCodes;
use super::source::BlockSource;
use super::statistics::Statistics;
use super::wedges::{BlockWedges, WEDGE_BITS, code_wedges};

/// Chooses the predictions of all layers and fits tables, given the blocks of a mesh.
pub(in super::super) fn fit(
    format: &mut LayersFormat,
    blocks: &[(BlockGeometry, BlockSource)],
) -> TableCodes {
    if !format.layers.is_empty() {
        choose_modes(format, blocks);
    }
    let (_, _, all) = format.contexts();
    let mut counted = Statistics::new(all.bits, all.residuals);
    for (geometry, source) in blocks {
        code_block(geometry, format, &mut counted, usize::MAX, Some(source));
    }
    counted.codes()
}

/// Approximate number of blocks by which predictions are chosen.
const SAMPLES: usize = 32;

/// Block by which predictions are chosen, with the layers that are coded already.
struct SampleBlock<'a> {
    geometry: &'a BlockGeometry<'a>,
    source: &'a BlockSource<'a>,
    wedges: BlockWedges,
    layers: Vec<Option<BlockLayer>>,
}

fn choose_modes(format: &mut LayersFormat, blocks: &[(BlockGeometry, BlockSource)]) {
    let stride = blocks.len().div_ceil(SAMPLES).max(1);
    let mut samples: Vec<_> = blocks
        .iter()
        .step_by(stride)
        .map(|(geometry, source)| {
            let mut counted = Statistics::new(WEDGE_BITS, 0);
            let wedges = code_wedges(&geometry.faces, &mut counted, Some(&source.corners));
            SampleBlock { geometry, source, wedges, layers: vec![None; format.layers.len()] }
        })
        .collect();
    for at in format.order() {
        let mut best = f64::INFINITY;
        let modes = format.layers[at].modes();
        let mut best_mode = modes[0];
        for &mode in &modes {
            format.layers[at].mode = mode;
            let bits = code_layer(format, at, &mut samples).cost();
            if bits < best {
                (best, best_mode) = (bits, mode);
            }
        }
        format.layers[at].mode = best_mode;
        code_layer(format, at, &mut samples);
    }
}

/// Codes a layer of all samples, and counts.
fn code_layer(format: &LayersFormat, at: usize, samples: &mut [SampleBlock]) -> Statistics {
    let layer = &format.layers[at];
    let LayerContexts { bits, residuals } = layer.contexts();
    let mut counted = Statistics::new(bits, residuals);
    for sample in samples {
        let SampleBlock { geometry, source, ref wedges, ref layers } = *sample;
        let block = BlockCoding { geometry, wedges, format, layers };
        let contexts = LayerContexts { bits: 0, residuals: 0 };
        let coded = block.layer(layer, contexts, &mut counted, Some(&source.numbers[at]));
        sample.layers[at] = Some(coded);
    }
    counted
}
