//! What strips send.

use std::collections::VecDeque;

use meshlod::mesh::VertexId;
use meshlod::strip::Strips;

/// What it takes to draw some strips.
pub(super) struct Sent {
    /// Where each strip is drawn by itself.
    pub vertices: usize,
    /// In one list, with a restart between strips.
    pub indices_with_restart: usize,
    pub strips: usize,
    /// Windows of a strip that draw nothing, but for the first of one that begins with an odd triangle.
    pub swaps: usize,
    /// What a cache of the last 16 and 32 vertices has to fetch, a triangle.
    pub acmr16: f64,
    pub acmr32: f64,
}

impl Sent {
    pub(super) fn of(strips: &Strips) -> Self {
        let vertices = strips.vertices().len();
        let triangles = strips.triangles().count();
        let windows: usize = strips.iter().map(|strip| strip.len().saturating_sub(2)).sum();
        let odd = strips.iter().filter(|strip| strip.len() > 2 && strip[0] == strip[1]).count();
        let acmr = |size| misses(strips.vertices(), size) as f64 / triangles.max(1) as f64;
        Self {
            vertices,
            indices_with_restart: vertices + strips.len().saturating_sub(1),
            strips: strips.len(),
            swaps: windows - triangles - odd,
            acmr16: acmr(16),
            acmr32: acmr(32),
        }
    }
}

/// How many vertices a first-in-first-out cache does not have when they are asked for.
fn misses(vertices: &[VertexId], size: usize) -> usize {
    let mut cache = VecDeque::with_capacity(size + 1);
    let mut misses = 0;
    for vertex in vertices {
        if !cache.contains(vertex) {
            misses += 1;
            cache.push_back(*vertex);
            if cache.len() > size {
                cache.pop_front();
            }
        }
    }
    misses
}
