//! Attributes and labels of a mesh, on their way into blocks.

use super::layers::{
    BlockGeometry, BlockSource, LayerTables, LayersFormat, MeshLayers, SymbolWriter, TableCodes,
    code_block, fit,
};
use super::predict::CellVec;
use super::rans::Symbol;
use super::symbol_bits::SymbolBits;
use super::walk::BlockWalk;

/// Attributes and labels of all blocks, ready to be coded.
pub(super) struct EncodedLayers<'a> {
    blocks: Vec<(BlockGeometry<'a>, BlockSource<'a>)>,
    pub(super) codes: TableCodes,
    tables: LayerTables,
}

impl<'a> EncodedLayers<'a> {
    pub(super) fn new(
        format: &mut LayersFormat,
        layers: &'a MeshLayers,
        walks: &'a [BlockWalk],
        cells: &[CellVec],
    ) -> Self {
        let mut blocks = Vec::new();
        if !format.is_empty() {
            blocks.extend(walks.iter().map(|walk| {
                let point = |&v: &u32| cells[v as usize].as_dvec3();
                let points = walk.vertices.iter().map(point).collect();
                (BlockGeometry::new(&walk.faces, points), layers.of_block(walk))
            }));
        }
        let codes = fit(format, &blocks);
        let tables = LayerTables::new(&codes);
        Self { blocks, codes, tables }
    }

    /// Appends the symbols of a block. Returns its number of values.
    pub(super) fn push(
        &self,
        block: usize,
        format: &LayersFormat,
        symbols: &mut Vec<Symbol>,
        bits: &mut SymbolBits,
    ) -> usize {
        let Some((geometry, source)) = self.blocks.get(block) else { return 0 };
        let mut writer = SymbolWriter::new(&self.tables, symbols);
        let coded = code_block(geometry, format, &mut writer, usize::MAX, Some(source));
        let wedges = coded.map_or(0, |coded| coded.wedges.vertex.len());
        let parts = std::mem::take(&mut writer.parts);
        bits.add_layers(symbols, &parts);
        wedges * format.width()
    }
}
