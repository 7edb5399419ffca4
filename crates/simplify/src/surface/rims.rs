//! Cones that close the boundaries of a surface, so that an open surface has a volume too: the open
//! problem of [LJ05], which gives the volume up at boundaries.

use glam::DVec3;
use meshlod_mesh::{Connectivity, Mesh, Side, Twin, UnionFind, VertexId};

/// Not on a boundary.
const NONE: u32 = u32::MAX;

/// Apexes of cones over the boundary loops: a loop's apex is the mean of its vertices in the input
/// and never moves. Loops that share a vertex have one apex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rims {
    /// Loop of each vertex; empty on a closed surface.
    loop_of: Vec<u32>,
    apexes: Vec<DVec3>,
}

impl Rims {
    pub(crate) fn new(mesh: &Mesh, connectivity: &Connectivity) -> Self {
        if connectivity.boundary_edges() == 0 {
            return Self::default();
        }
        let count = mesh.positions.len();
        let (mut joined, mut on_rim) = (UnionFind::new(count), vec![false; count]);
        let open = |side: &Side| connectivity.twin(*side) == Twin::Boundary;
        for [a, b] in connectivity.edges().filter(open).map(|side| side.ends(&mesh.faces)) {
            joined.union(a.0, b.0);
            (on_rim[a.index()], on_rim[b.index()]) = (true, true);
        }
        let mut number = vec![NONE; count];
        let mut loop_of = vec![NONE; count];
        let mut sums: Vec<(DVec3, f64)> = Vec::new();
        for v in (0..count).filter(|&v| on_rim[v]) {
            let root = joined.find(v as u32) as usize;
            if number[root] == NONE {
                number[root] = sums.len() as u32;
                sums.push((DVec3::ZERO, 0.0));
            }
            loop_of[v] = number[root];
            let (sum, members) = &mut sums[number[root] as usize];
            (*sum, *members) = (*sum + DVec3::from(mesh.positions[v]), *members + 1.0);
        }
        Self { loop_of, apexes: sums.into_iter().map(|(sum, members)| sum / members).collect() }
    }

    /// Returns the apex over the boundary at a vertex.
    pub(crate) fn apex(&self, v: VertexId) -> Option<DVec3> {
        let rim = *self.loop_of.get(v.index())?;
        self.apexes.get(rim as usize).copied()
    }

    /// Makes a vertex the one that others have been contracted into.
    pub(crate) fn join(&mut self, kept: VertexId, contracted: &[VertexId]) {
        let mut rims = contracted.iter().filter_map(|v| self.loop_of.get(v.index()));
        if let Some(&rim) = rims.find(|&&rim| rim != NONE) {
            self.loop_of[kept.index()] = rim;
        }
    }
}
