//! Places where a new edge passes over an edge of the input.
//!
//! Between two surfaces that are nearly parallel the distance is linear wherever neither has an
//! edge, so it is greatest at a vertex of one of them or where two edges cross.

use glam::DVec3;
use meshlod_mesh::Mesh;

use crate::forest::NONE;

/// Edges of the input by their vertices.
#[derive(Debug)]
pub(super) struct InputEdges {
    /// Start of each vertex's neighbours.
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    /// By vertex: the last update at whose coarse side it was.
    seen: Vec<u32>,
}

impl InputEdges {
    /// Lists the edges of the input.
    pub(super) fn new(input: &Mesh) -> Self {
        let mut pairs: Vec<[u32; 2]> = Vec::with_capacity(6 * input.faces.len());
        for [a, b, c] in &input.faces {
            let (a, b, c) = (a.0, b.0, c.0);
            pairs.extend([[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        }
        let mut starts = vec![0; input.positions.len() + 1];
        pairs.iter().for_each(|&[v, _]| starts[v as usize + 1] += 1);
        for v in 1..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut room = starts.clone();
        let mut neighbours = vec![0; pairs.len()];
        for [v, other] in pairs {
            neighbours[room[v as usize] as usize] = other;
            room[v as usize] += 1;
        }
        let mut this = Self { starts, neighbours, seen: vec![NONE; input.positions.len()] };
        this.leave_out_repeats();
        this
    }

    /// Leaves each neighbour once: inner edges have two faces.
    fn leave_out_repeats(&mut self) {
        let mut end = 0;
        for v in 0..self.starts.len() - 1 {
            let range = self.starts[v] as usize..self.starts[v + 1] as usize;
            self.starts[v] = end as u32;
            self.neighbours[range.clone()].sort_unstable();
            let mut last = None;
            for i in range {
                let other = self.neighbours[i];
                if last.replace(other) != Some(other) {
                    self.neighbours[end] = other;
                    end += 1;
                }
            }
        }
        let last = self.starts.len() - 1;
        self.starts[last] = end as u32;
        self.neighbours.truncate(end);
    }

    /// Visits the edges at some vertices, each once.
    pub(super) fn at(&mut self, vertices: &[u32], update: u32, mut visit: impl FnMut([u32; 2])) {
        vertices.iter().for_each(|&v| self.seen[v as usize] = update);
        for &v in vertices {
            let [start, end] = [v, v + 1].map(|v| self.starts[v as usize] as usize);
            for &other in &self.neighbours[start..end] {
                if v < other || self.seen[other as usize] != update {
                    visit([v, other]);
                }
            }
        }
    }
}

/// Finds where a new edge passes over an edge of the input, each given by its start and its direction.
/// Returns the point on the new edge; `None` if they do not pass each other, or at most `least` apart.
#[inline]
pub(super) fn crossing([p, d]: [DVec3; 2], [q, e]: [DVec3; 2], least: f64) -> Option<DVec3> {
    let between = q - p;
    let (dd, ee, de) = (d.dot(d), e.dot(e), d.dot(e));
    let (along_d, along_e) = (d.dot(between), e.dot(between));
    let area = dd * ee - de * de;
    // Compared before dividing, since most edges do not cross.
    let (s, t) = (along_d * ee - along_e * de, along_d * de - along_e * dd);
    if !(s > 0.0 && s < area && t > 0.0 && t < area) {
        return None;
    }
    let (new, input) = (p + d * (s / area), q + e * (t / area));
    (new.distance_squared(input) > least * least).then_some(new)
}
