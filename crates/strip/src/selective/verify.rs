//! Checks that the strips of a cut draw its triangles with their attributes and materials.

use meshlod_mesh::VertexId;
use meshlod_multires::{Cut, Implicit, SlotMesh};
use rustc_hash::FxHashMap;

use super::CutStrips;
use crate::strips::Strips;
use crate::verify::{Difference, difference};

impl CutStrips {
    /// Compares what the strips draw, material by material, with the triangles of the cut of the
    /// model `mt`: positions and all attribute values to the bit.
    ///
    /// Cost: O(n log n), n = triangles.
    pub fn difference(&self, mt: &Implicit, cut: &Cut<'_>) -> Difference {
        let has_wedges = self.has_wedges;
        let mut names = CornerNames { mt, has_wedges, ids: FxHashMap::default() };
        let mut drawn = Strips::default();
        for (material, strips) in (0..).zip(self.strips_by_material(mt)) {
            for strip in strips.iter() {
                drawn.push(strip.iter().map(|v| names.of(v.0, material)));
            }
        }
        let faces = cut.triangles().map(|(slot, nodes)| {
            let corners = super::corners(has_wedges, cut, slot, nodes);
            corners.map(|corner| names.of(corner, mt.material_of(corner).unwrap_or(0)))
        });
        difference(&drawn, &faces.collect::<Vec<_>>())
    }
}

/// Numbers of corners: one for all that look the same.
struct CornerNames<'m> {
    mt: &'m Implicit,
    has_wedges: bool,
    ids: FxHashMap<Vec<u64>, VertexId>,
}

impl CornerNames<'_> {
    /// Returns the number of a node, or wedge if there are any, that is drawn in a material.
    fn of(&mut self, corner: u32, material: u32) -> VertexId {
        let Self { mt, has_wedges, ids } = self;
        let node = if *has_wedges { mt.node_of(corner) } else { corner };
        let mut bits = vec![u64::from(material)];
        bits.extend(mt.position(node).map(f64::to_bits));
        let mut values = Vec::new();
        if *has_wedges {
            mt.append_values(corner, &mut values);
        }
        bits.extend(values.iter().map(|value| u64::from(value.to_bits())));
        let next = VertexId::new(ids.len());
        *ids.entry(bits).or_insert(next)
    }
}
