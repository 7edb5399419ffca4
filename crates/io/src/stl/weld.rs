//! Corners at the same place become one vertex.

use meshlod_mesh::VertexId;
use rustc_hash::FxHashMap;

/// The vertices so far, by their places.
#[derive(Default)]
pub(super) struct Welder {
    pub positions: Vec<[f64; 3]>,
    ids: FxHashMap<[u64; 3], VertexId>,
}

impl Welder {
    /// Room for the vertices of so many facets: a closed mesh has half as many.
    pub fn with_facets(facets: usize) -> Self {
        let mut ids = FxHashMap::default();
        ids.reserve(facets / 2);
        Self { positions: Vec::with_capacity(facets / 2), ids }
    }

    /// The vertex at a finite place, bit for bit; −0 is 0.
    pub fn vertex(&mut self, position: [f64; 3]) -> VertexId {
        let position = position.map(|x| x + 0.0);
        *self.ids.entry(position.map(f64::to_bits)).or_insert_with(|| {
            self.positions.push(position);
            VertexId::new(self.positions.len() - 1)
        })
    }
}
