//! Position and attributes of a vertex while it moves, and how children come by those of the node
//! that they replace.

use crate::cut::split_wedges::SplitWedges;
use crate::implicit::Implicit;
use crate::wedges::LayerFormat;

/// Position of a vertex and values of its wedges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexValues {
    /// Position in model units.
    pub position: [f64; 3],
    /// Values of the vertex's wedges in the order of [`Implicit::wedges_of`], each with the values
    /// of all [`Implicit::layers`] one after another.
    pub values: Vec<f32>,
}

impl VertexValues {
    /// Takes the state that a node has in every cut.
    pub(super) fn set_to(&mut self, mt: &Implicit, node: u32) {
        self.position = mt.position(node);
        self.set_values_to(mt, node);
    }

    fn set_values_to(&mut self, mt: &Implicit, node: u32) {
        self.values.clear();
        if let Some(all) = mt.wedges().filter(|all| !all.values.is_empty()) {
            all.of(node).for_each(|wedge| all.values.append(wedge, &mut self.values));
        }
    }

    /// Takes the state in which a child shows what the node of `update` shows in the state `above`.
    ///
    /// Where a seam opens, the wedges on both sides have the values of the one wedge before. A wedge
    /// without one before is only at faces without area, and has its own values.
    pub(super) fn set_to_child(&mut self, mt: &Implicit, above: &Self, update: u32, child: u32) {
        let node = mt.parent(update);
        self.position = above.position;
        if is_continued(mt, update, node, child) {
            // Most have one wedge each.
            self.values.clone_from(&above.values);
            return;
        }
        self.set_values_to(mt, child);
        for (wedge, from) in wedge_pairs(mt, update, child) {
            let (to, from) = (values_at(mt, child, wedge), values_at(mt, node, from));
            self.values[to].copy_from_slice(&above.values[from]);
        }
    }

    /// Takes the state in which the node of `update` shows what its two children show at one place.
    pub(super) fn set_to_parent(
        &mut self,
        mt: &Implicit,
        update: u32,
        children: [(u32, &Self); 2],
    ) {
        let node = mt.parent(update);
        self.position = children[0].1.position;
        let (last, shown) = children[1];
        if is_continued(mt, update, node, last) {
            self.values.clone_from(&shown.values);
            return;
        }
        self.set_values_to(mt, node);
        for (child, shown) in children {
            for (wedge, above) in wedge_pairs(mt, update, child) {
                let (to, from) = (values_at(mt, node, above), values_at(mt, child, wedge));
                self.values[to].copy_from_slice(&shown.values[from]);
            }
        }
    }

    /// Returns the values of one wedge, given its vertex.
    pub(super) fn values_of(&self, mt: &Implicit, node: u32, wedge: u32) -> &[f32] {
        &self.values[values_at(mt, node, wedge)]
    }
}

/// Selection of the values of a wedge that are blended while its vertex moves.
///
/// Numbers of joints and labels cannot be blended: these, and weights of joints, change at the end.
#[derive(Clone, Debug)]
pub(super) struct Blend {
    /// True for each value of a wedge that changes at the end; empty if none does.
    is_held: Vec<bool>,
}

impl Blend {
    pub(super) fn new<'m>(layers: impl Iterator<Item = LayerFormat<'m>>) -> Self {
        let of_layer = |layer: LayerFormat<'_>| vec![!layer.kind.is_blended(); layer.width];
        let all: Vec<bool> = layers.flat_map(of_layer).collect();
        Self { is_held: if all.contains(&true) { all } else { Vec::new() } }
    }

    /// Writes the state at a weight from 0, the first one, to 1, the second.
    pub(super) fn write(
        &self,
        places: [[f64; 3]; 2],
        [from, to]: [&[f32]; 2],
        weight: f64,
        state: &mut VertexValues,
    ) {
        state.values.clear();
        if weight <= 0.0 || weight >= 1.0 {
            state.position = places[usize::from(weight >= 1.0)];
            state.values.extend_from_slice(if weight <= 0.0 { from } else { to });
            return;
        }
        // Unlike `from + weight * (to - from)`, this cannot overflow.
        let blend = |from: f64, to: f64| from * (1.0 - weight) + to * weight;
        state.position = std::array::from_fn(|k| blend(places[0][k], places[1][k]));
        let between = from.iter().zip(to).map(|(&old, &new)| blend(old.into(), new.into()) as f32);
        state.values.extend(between);
        let held = self.is_held.iter().cycle();
        for ((value, &old), _) in state.values.iter_mut().zip(from).zip(held).filter(|at| *at.1) {
            *value = old;
        }
    }
}

/// Returns true if a child and the node of an update have one wedge each, and one becomes the
/// other.
fn is_continued(mt: &Implicit, update: u32, node: u32, child: u32) -> bool {
    mt.wedges().is_some_and(|all| all.count(child) == 1 && all.count(node) == 1)
        && wedge_pairs(mt, update, child).next().is_some()
}

/// Iterates over the wedges of a child, each with the one that it becomes at the update's node.
fn wedge_pairs(mt: &Implicit, update: u32, child: u32) -> impl Iterator<Item = (u32, u32)> {
    let wedges = mt.wedges().filter(|all| !all.values.is_empty()).into_iter();
    wedges.flat_map(move |all| {
        let split = SplitWedges::new(all, mt, update);
        all.of(child).filter_map(move |wedge| Some((wedge, split.continued(child, wedge)?)))
    })
}

/// Returns where the values of a vertex's wedge are among those of all its wedges.
fn values_at(mt: &Implicit, node: u32, wedge: u32) -> std::ops::Range<usize> {
    let width = mt.values_per_wedge();
    let start = (wedge - mt.wedges_of(node).start) as usize * width;
    start..start + width
}
