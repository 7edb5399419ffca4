//! The wedges of a packed model for callers: whose they are, what they merge into, their material.

use std::ops::Range;

use super::Implicit;
use crate::wedges::LayerFormat;

impl Implicit {
    /// Iterates over the attribute layers, without their values, which
    /// [`append_values`](Self::append_values) has.
    pub fn layers(&self) -> impl Iterator<Item = LayerFormat<'_>> + Clone {
        self.wedges.iter().flat_map(|all| all.values.formats())
    }

    /// Returns the number of values of a wedge: the widths of all [`layers`](Self::layers) together.
    pub fn values_per_wedge(&self) -> usize {
        self.wedges.as_ref().map_or(0, |all| all.values.width())
    }

    /// Appends the values of a wedge in all [`layers`](Self::layers), one layer after another.
    ///
    /// A model keeps the integers that a file has for them, and decodes them here.
    /// [`SlotMesh::wedges`](crate::SlotMesh::wedges) has the wedges of a cut's triangles. Nothing is appended if
    /// the model has no layers.
    ///
    /// # Panics
    /// `wedge` is not below [`wedge_count`](Self::wedge_count).
    pub fn append_values(&self, wedge: u32, to: &mut Vec<f32>) {
        assert!((wedge as usize) < self.wedge_count(), "wedge {wedge} is not in the model");
        self.wedges.iter().for_each(|all| all.values.append(wedge, to));
    }

    /// Returns the number of wedges of all nodes; 0 if the mesh has neither attributes, materials
    /// nor objects.
    pub fn wedge_count(&self) -> usize {
        self.wedges.as_ref().map_or(0, |all| all.first(self.node_count() as u32) as usize)
    }

    /// Returns the wedges of a node, in the numbers of [`layers`](Self::layers); none if the model
    /// has no wedges.
    ///
    /// # Panics
    /// `node` is not below [`node_count`](Self::node_count).
    pub fn wedges_of(&self, node: u32) -> Range<u32> {
        assert!((node as usize) < self.node_count(), "node {node} is not in the model");
        self.wedges.as_ref().map_or(0..0, |all| all.of(node))
    }

    /// Returns the node that a wedge belongs to.
    ///
    /// Cost: O(log n), n = nodes.
    /// # Panics
    /// `wedge` is not below [`wedge_count`](Self::wedge_count).
    pub fn node_of(&self, wedge: u32) -> u32 {
        assert!((wedge as usize) < self.wedge_count(), "wedge {wedge} is not in the model");
        let (mut node, mut end) = (0, self.node_count() as u32);
        while end - node > 1 {
            let middle = node + (end - node) / 2;
            if self.wedges_of(middle).start <= wedge { node = middle } else { end = middle }
        }
        node
    }

    /// Iterates over the wedges of a node's two children, each with the wedge of the node that it
    /// becomes when they are merged.
    ///
    /// A wedge whose faces have all vanished by then becomes none, and is left out where the node or
    /// a child has several.
    ///
    /// # Panics
    /// As for [`wedges_of`](Self::wedges_of).
    pub fn merged_wedges(&self, node: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        let merged = self.wedges.as_deref().zip(self.update_of(node)).map(|(all, update)| {
            let children = self.children(update);
            let record = all.split(update, children, || self.created_count(update));
            let wedges = children.into_iter().flat_map(|child| all.of(child));
            wedges.enumerate().filter_map(move |(i, wedge)| {
                let parent = record.map_or(Some(0), |record| record.parent(i))?;
                Some((wedge, all.at(node, parent)))
            })
        });
        merged.into_iter().flatten()
    }

    /// Returns the names of the materials; `None` if the mesh has none.
    pub fn material_names(&self) -> Option<&[String]> {
        self.wedges.as_ref()?.labels.names[0].as_deref()
    }

    /// Returns the names of the objects; `None` if the mesh has none.
    pub fn object_names(&self) -> Option<&[String]> {
        self.wedges.as_ref()?.labels.names[1].as_deref()
    }

    /// Returns the object of the faces that use a wedge, by its place among the
    /// [names](Self::object_names); `None` if the mesh has no objects.
    pub fn object_of(&self, wedge: u32) -> Option<u32> {
        let labels = &self.wedges.as_ref()?.labels;
        labels.names[1].as_ref()?;
        labels.pairs.get(labels.of(wedge) as usize).map(|pair| pair[1])
    }

    /// Returns the material of the faces that use a wedge, by its place among the
    /// [names](Self::material_names); `None` if the mesh has no materials.
    pub fn material_of(&self, wedge: u32) -> Option<u32> {
        let labels = &self.wedges.as_ref()?.labels;
        labels.names[0].as_ref()?;
        labels.pairs.get(labels.of(wedge) as usize).map(|pair| pair[0])
    }
}
