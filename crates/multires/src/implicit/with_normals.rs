//! Normals for models that come without, so that they are drawn and blended as other attributes.

use std::sync::Arc;

use meshlod_mesh::{Layer, LayerKind};

use super::Implicit;
use crate::wedges::Wedges;

impl Implicit {
    /// Returns the model with a layer of normals in place of those it has: each wedge gets the
    /// normal of its node. A model without wedges gets one for each node, of the node's number.
    ///
    /// Cuts, and all else about the model, stay as they are. Cost: linear.
    /// # Panics
    /// There are not as many normals as nodes.
    pub fn with_normals(mut self, of_nodes: &[[f32; 3]]) -> Self {
        assert_eq!(of_nodes.len(), self.node_count(), "one normal for each node");
        let bare = || {
            let mut wedges = Wedges::default();
            wedges.base.clone_from(&self.base);
            wedges
        };
        let mut wedges = self.wedges.take().map_or_else(bare, Arc::unwrap_or_clone);
        let of_wedge = |node: u32| wedges.of(node).flat_map(move |_| of_nodes[node as usize]);
        let values = (0..of_nodes.len() as u32).flat_map(of_wedge).collect();
        let (kind, name) = (LayerKind::Normal, "NORMAL".to_owned());
        wedges.values.replace(&Layer { kind, name, width: 3, values });
        self.wedges = Some(Arc::new(wedges));
        self
    }
}
