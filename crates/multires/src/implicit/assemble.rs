//! Updates one by one, and a model of such: how it goes into a file and comes back.

use std::collections::BTreeMap;

use glam::Vec3;

use super::places::Places;
use super::splits::{Local, Split, Splits};
use super::{FLAG, Implicit, LAST_WING, NO_WING, OPEN, Order};
use crate::bounds::ErrorKind;
use crate::exact::Exact;
use crate::forest::{MOST_LEVELS, NONE, Odd};
use crate::frame::{Frame, Length16};
use crate::record::MOST_RANKED;

/// An update on its own, in some numbering of nodes: roots first, then the children of each update.
#[derive(Clone, Debug)]
pub(crate) struct Loose {
    /// The node that it splits; [`NONE`] if that is unknown.
    pub(crate) parent: u32,
    pub(crate) level: u16,
    /// As they are stored.
    pub(crate) wings: [u8; 2],
    pub(crate) radius: Length16,
    pub(crate) error: Length16,
    pub(crate) is_open: bool,
    /// The first child is split in the same go.
    pub(crate) glued: bool,
    pub(crate) odd: Option<Box<Odd>>,
    /// Where its children are, in stored units.
    pub(crate) children: [Vec3; 2],
}

/// What holds for all of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct About {
    pub(crate) frame: Frame,
    pub(crate) error_kind: ErrorKind,
}

/// The coarsest mesh of a model.
#[derive(Clone, Debug, Default)]
pub(crate) struct Base {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Implicit {
    /// An update by the numbers of this model.
    pub(crate) fn loose(&self, update: u32) -> Loose {
        let (parent, local) = (self.splits.parent(update), self.splits.local(update));
        let Local { radius, error, level, wings } = local;
        Loose {
            parent: parent & !FLAG,
            level: level & !OPEN,
            wings,
            radius,
            error,
            is_open: level & OPEN != 0,
            glued: parent & FLAG != 0,
            odd: self.odd(update).cloned().map(Box::new),
            children: self.children(update).map(|child| self.place(child).into()),
        }
    }

    /// The coarsest mesh.
    pub(crate) fn loose_base(&self) -> Base {
        let roots = (0..self.roots).map(|root| self.place(root).into());
        Base { positions: roots.collect(), faces: self.base.clone() }
    }

    /// A model of loose updates, without those whose node nobody makes; with the positions of some nodes
    /// to the bit. Each node may be split once.
    ///
    /// Wings stay what they are: in every set of updates with all above them, nodes are in the same
    /// order.
    pub(crate) fn assemble(about: About, base: Base, updates: &[Loose], exact: &Exact) -> Self {
        let roots = base.positions.len();
        let nodes = roots + 2 * updates.len();
        let mut update_of = vec![NONE; nodes];
        for (u, update) in updates.iter().enumerate().filter(|(_, u)| u.parent != NONE) {
            update_of[update.parent as usize] = u as u32;
        }
        let family = |update: u32| [0, 1].map(|child| roots as u32 + 2 * update + child);
        let children = |node: u32| {
            let update = update_of[node as usize];
            (update != NONE).then(|| (update, family(update)))
        };
        let order = Order::of((0..roots as u32).collect(), nodes, updates.len(), children);
        let (mut splits, mut odds) = (Vec::with_capacity(order.updates.len()), BTreeMap::new());
        let mut full_faces = base.faces.len();
        let mut places: Vec<_> = base.positions.iter().map(|p| p.to_array()).collect();
        places.reserve_exact(2 * order.updates.len());
        for (at, &u) in order.updates.iter().enumerate() {
            let update = &updates[u as usize];
            places.extend(update.children.map(|child| child.to_array()));
            let below = family(u).map(|child| {
                children(child).map(|(update, _)| order.place_of_update[update as usize])
            });
            // Only what is split can go in the same go.
            let glued = update.glued && below[0].is_some();
            splits.push(Split {
                parent: order.place[update.parent as usize] | if glued { FLAG } else { 0 },
                second: order.second(at, below),
                local: Local {
                    radius: update.radius,
                    error: update.error,
                    level: update.level | if update.is_open { OPEN } else { 0 },
                    wings: update.wings,
                },
            });
            full_faces += update.brought();
            if let Some(odd) = &update.odd {
                // What is unknown stays unknown.
                let place = |node: u32| order.place.get(node as usize).copied().unwrap_or(NONE);
                let mut odd = odd.renumbered(place);
                odd.brought.retain(|face| !face.contains(&NONE));
                odds.insert(at as u32, odd);
            }
        }
        Self {
            frame: about.frame,
            error_kind: about.error_kind,
            roots: roots as u32,
            exact: exact.picked(order.nodes.iter().copied()),
            trees: order.trees,
            places: Places::Free(places),
            splits: Splits::Wide(splits),
            base: base.faces,
            odd: odds,
            full_faces,
        }
    }
}

impl Loose {
    /// How many faces it brings.
    pub(crate) fn brought(&self) -> usize {
        let wings = self.wings.iter().filter(|&&wing| wing != NO_WING).count();
        self.odd.as_ref().map_or(wings, |odd| odd.brought.len())
    }

    /// Why it cannot be below an update, or whatever is around.
    pub(crate) fn trouble(&self, above: Option<&Self>) -> Option<&'static str> {
        let most = above.map_or(MOST_LEVELS, |above| above.level);
        let is_rank = |wing: u8| usize::from(wing) < MOST_RANKED || wing >= LAST_WING;
        if self.level == 0 || self.level >= most {
            Some("its level is not between 0 and that of the update above")
        } else if above.is_some_and(|above| above.error < self.error) {
            Some("its error is more than that of the update above")
        } else if !self.wings.iter().all(|&wing| is_rank(wing)) {
            Some("a wing has no rank that there is")
        } else {
            None
        }
    }
}

impl Odd {
    /// The same with other numbers for nodes.
    pub(crate) fn renumbered(&self, number: impl Fn(u32) -> u32) -> Self {
        Self {
            second: self.second.iter().map(|pair| pair.map(&number)).collect(),
            brought: self.brought.iter().map(|face| face.map(&number)).collect(),
        }
    }
}

/// Whether no two corners of a face are one node.
pub(crate) fn has_three_corners(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}
