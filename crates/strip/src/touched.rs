//! Nodes of a path cover that have changed.

/// A list of nodes in the order in which they were first marked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Touched {
    nodes: Vec<u32>,
    is_marked: Vec<bool>,
}

impl Touched {
    /// Adds a node unless it is in the list.
    #[inline]
    pub(crate) fn mark(&mut self, node: usize) {
        if node >= self.is_marked.len() {
            self.is_marked.resize(node + 1, false);
        }
        if !std::mem::replace(&mut self.is_marked[node], true) {
            self.nodes.push(node as u32);
        }
    }

    /// Empties the list. Cost: its length.
    pub(crate) fn clear(&mut self) {
        self.nodes.drain(..).for_each(|node| self.is_marked[node as usize] = false);
    }

    /// Returns the nodes of the list, each once.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }
}
