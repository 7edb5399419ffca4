//! Position and attributes of a vertex while it moves, and how children come by those of the node
//! that they replace.

use meshlod_mesh::WedgeId;

use crate::cut::split_wedges::SplitWedges;
use crate::implicit::Implicit;

/// Position of a vertex and values of its wedges.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexValues {
    /// Position in model units.
    pub position: [f64; 3],
    /// Values of the vertex's wedges in the order of [`Implicit::wedges_of`], each with the values
    /// of all [`Implicit::layers`] one after another.
    pub values: Vec<f32>,
}

impl VertexValues {
    /// Returns the state that a node has in every cut.
    pub(super) fn of(mt: &Implicit, node: u32) -> Self {
        let of_wedge = |wedge: u32| {
            mt.layers().iter().flat_map(move |layer| layer.of(WedgeId(wedge))).copied()
        };
        let values = if mt.layers().is_empty() {
            Vec::new()
        } else {
            mt.wedges_of(node).flat_map(of_wedge).collect()
        };
        Self { position: mt.position(node), values }
    }

    /// Returns the state in which a child shows what the node of `update` shows in this state.
    ///
    /// Where a seam opens, the wedges on both sides have the values of the one wedge before. A wedge
    /// without one before is only at faces without area, and has its own values.
    pub(super) fn of_child(&self, mt: &Implicit, update: u32, child: u32) -> Self {
        let mut state = Self { position: self.position, values: Self::of(mt, child).values };
        let node = mt.parent(update);
        for (wedge, above) in wedge_pairs(mt, update, child) {
            let (to, from) = (values_at(mt, child, wedge), values_at(mt, node, above));
            state.values[to].copy_from_slice(&self.values[from]);
        }
        state
    }

    /// Returns the state in which the node of `update` shows what its two children show at one
    /// place.
    pub(super) fn of_parent(mt: &Implicit, update: u32, children: [(u32, Self); 2]) -> Self {
        let node = mt.parent(update);
        let mut state = Self { position: children[0].1.position, ..Self::of(mt, node) };
        for (child, shown) in &children {
            for (wedge, above) in wedge_pairs(mt, update, *child) {
                let (to, from) = (values_at(mt, node, above), values_at(mt, *child, wedge));
                state.values[to].copy_from_slice(&shown.values[from]);
            }
        }
        state
    }

    /// Returns the state at a weight from 0, `from`, to 1, `to`.
    ///
    /// Numbers of joints and labels cannot be blended: these, and weights of joints, change at 1.
    pub(super) fn between(mt: &Implicit, [from, to]: [&Self; 2], weight: f64) -> Self {
        if weight <= 0.0 || weight >= 1.0 {
            return if weight <= 0.0 { from } else { to }.clone();
        }
        // Unlike `from + weight * (to - from)`, this cannot overflow.
        let blend = |from: f64, to: f64| from * (1.0 - weight) + to * weight;
        let mut values = Vec::with_capacity(from.values.len());
        let mut layers = mt.layers().iter().cycle();
        while let Some(layer) = layers.next().filter(|_| values.len() < from.values.len()) {
            let of_layer = values.len()..values.len() + layer.width;
            let (old, new) = (&from.values[of_layer.clone()], &to.values[of_layer]);
            match layer.kind.is_blended() {
                false => values.extend_from_slice(old),
                true => values.extend(
                    old.iter().zip(new).map(|(&old, &new)| blend(old.into(), new.into()) as f32),
                ),
            }
        }
        let position = std::array::from_fn(|k| blend(from.position[k], to.position[k]));
        Self { position, values }
    }

    /// Returns the values of one wedge, given its vertex.
    pub(super) fn values_of(&self, mt: &Implicit, node: u32, wedge: u32) -> &[f32] {
        &self.values[values_at(mt, node, wedge)]
    }
}

/// Iterates over the wedges of a child, each with the one that it becomes at the update's node.
fn wedge_pairs(mt: &Implicit, update: u32, child: u32) -> impl Iterator<Item = (u32, u32)> {
    let wedges = mt.wedges().filter(|all| !all.layers.is_empty()).into_iter();
    wedges.flat_map(move |all| {
        let split = SplitWedges::new(all, mt, update);
        all.of(child).filter_map(move |wedge| Some((wedge, split.continued(child, wedge)?)))
    })
}

/// Returns where the values of a vertex's wedge are among those of all its wedges.
fn values_at(mt: &Implicit, node: u32, wedge: u32) -> std::ops::Range<usize> {
    let width: usize = mt.layers().iter().map(|layer| layer.width).sum();
    let start = (wedge - mt.wedges_of(node).start) as usize * width;
    start..start + width
}
