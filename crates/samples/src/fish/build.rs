//! Assembly of the fish's mesh: a grid of quads, the patches that replace parts of it, and their
//! wedges.

use std::collections::BTreeMap;

use glam::DVec3;
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};

use super::patch::{Chart, Patch, Spot, Within, in_cell, rim, within};

/// Texture cells of the faces that close the mouth and the tail.
const LACES: [usize; 2] = [14, 15];

/// A corner of a face: its vertex, texture coordinate and colour.
type Corner = (VertexId, [f64; 2], DVec3);

/// The fish while it is built.
pub(super) struct Builder {
    rings: usize,
    around: usize,
    mesh: Mesh,
    corners: Vec<[WedgeId; 3]>,
    uvs: Vec<f32>,
    colors: Vec<f32>,
    /// Wedges by vertex and the bits of their values; equal wedges are shared.
    wedges: BTreeMap<(VertexId, [u32; 5]), WedgeId>,
}

impl Builder {
    pub fn new(rings: usize, around: usize) -> Self {
        Self {
            rings,
            around,
            mesh: Mesh::default(),
            corners: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            wedges: BTreeMap::new(),
        }
    }

    /// Adds the grid of points `spot(ring, turn)` without the blocks of patches, and closes both
    /// ends.
    pub fn body(&mut self, patches: &[Patch], spot: impl Fn(usize, f64) -> Spot) {
        let around = self.around;
        let mut colors = Vec::new();
        for ring in 0..=self.rings {
            for j in 0..around {
                let spot = spot(ring, j as f64 / around as f64);
                self.mesh.positions.push(spot.position.into());
                colors.push(spot.color);
            }
        }
        let corner = |builder: &Self, ring: usize, j: usize| {
            let vertex = builder.vertex(ring, j);
            let [u, v] = [ring as f64 / builder.rings as f64, j as f64 / around as f64];
            (vertex, [0.01 + 0.98 * u, 0.37 + 0.62 * v], colors[vertex.index()])
        };
        for ring in 0..self.rings {
            for j in 0..around {
                if !patches.iter().any(|patch| patch.block.holds(ring, j, around)) {
                    let places = [(ring, j), (ring + 1, j), (ring + 1, j + 1), (ring, j + 1)];
                    let quad = places.map(|(ring, j)| corner(self, ring, j));
                    self.quad(quad);
                }
            }
        }
        self.lace_mouth(&colors);
        self.lace_tail(&colors);
    }

    fn vertex(&self, ring: usize, j: usize) -> VertexId {
        VertexId::new(ring * self.around + j % self.around)
    }

    /// Closes the first ring from its left corner to its right, upper points to lower.
    fn lace_mouth(&mut self, colors: &[DVec3]) {
        let quarter = self.around / 4;
        let upper = |k: usize| quarter + k;
        let lower = |k: usize| 5 * quarter - k;
        self.lace(0, |k| [lower(k), upper(k)], LACES[0], colors);
    }

    /// Closes the last ring from the belly to the back, left points to right.
    fn lace_tail(&mut self, colors: &[DVec3]) {
        let around = self.around;
        self.lace(self.rings, |k| [k, around - k], LACES[1], colors);
    }

    /// Closes a ring by quads between the pairs of points `pair(k)`, in `around / 2` steps from a
    /// point paired with itself to another.
    fn lace(
        &mut self,
        ring: usize,
        pair: impl Fn(usize) -> [usize; 2],
        cell: usize,
        colors: &[DVec3],
    ) {
        let steps = self.around / 2;
        let corner = |builder: &Self, k: usize, which: usize| {
            let vertex = builder.vertex(ring, pair(k)[which]);
            let u = if k == 0 || k == steps { 0.5 } else { which as f64 };
            let uv = [0.1 + 0.8 * u, 0.05 + 0.9 * k as f64 / steps as f64];
            (vertex, in_cell(Chart { cell, uv }), colors[vertex.index()])
        };
        for k in 0..steps {
            let quad = [(k, 0), (k, 1), (k + 1, 1), (k + 1, 0)];
            let [a, b, c, d] = quad.map(|(k, which)| corner(self, k, which));
            match k {
                0 => self.face([a, c, d]),
                _ if k + 1 == steps => self.face([a, b, c]),
                _ => self.quad([a, b, c, d]),
            }
        }
    }

    /// Adds the walls and the cap of a patch.
    pub fn patch(&mut self, patch: &Patch) {
        let [a, b] = patch.block.size();
        let rim = rim(a, b);
        let mut below: Vec<_> = rim.iter().map(|&[i, j]| self.root(patch, i, j)).collect();
        for level in 1..=patch.levels {
            let places = |level: usize| {
                let t = level as f64 / patch.levels as f64;
                rim.iter().map(move |&[i, j]| within(i, j, [a, b], t)).collect::<Vec<_>>()
            };
            let (low, high) = (places(level - 1), places(level));
            let above: Vec<_> = high.iter().map(|&at| self.add(patch.shape.place(at))).collect();
            for k in 0..rim.len() {
                let n = (k + 1) % rim.len();
                let ids = [below[k], below[n], above[n], above[k]];
                self.patch_quad(patch, ids, [low[k], low[n], high[n], high[k]]);
            }
            below = above;
        }
        self.cap(patch, &rim, &below);
    }

    /// Adds the cap of a patch whose walls end in the vertices `top` along `rim`.
    fn cap(&mut self, patch: &Patch, rim: &[[usize; 2]], top: &[VertexId]) {
        let [a, b] = patch.block.size();
        let mut ids = BTreeMap::new();
        ids.extend(rim.iter().copied().zip(top.iter().copied()));
        for i in 1..a {
            for j in 1..b {
                ids.insert([i, j], self.add(patch.shape.place(within(i, j, [a, b], 1.0))));
            }
        }
        for i in 0..a {
            for j in 0..b {
                let places = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
                let at = places.map(|[i, j]| within(i, j, [a, b], 1.0));
                self.patch_quad(patch, places.map(|place| ids[&place]), at);
            }
        }
    }

    /// Returns the vertex of the body at a point of the block of a patch.
    fn root(&self, patch: &Patch, i: usize, j: usize) -> VertexId {
        self.vertex(patch.block.rings[0] + i, patch.block.around[0] + j)
    }

    fn patch_quad(&mut self, patch: &Patch, ids: [VertexId; 4], at: [Within; 4]) {
        let mean = |part: fn(&Within) -> f64| at.iter().map(part).sum::<f64>() / 4.0;
        let middle = Within { u: mean(|at| at.u), v: mean(|at| at.v), t: mean(|at| at.t) };
        let corner = |k: usize| {
            let (chart, spot) = patch.shape.look(at[k], middle);
            (ids[k], in_cell(chart), spot.color)
        };
        self.quad([corner(0), corner(1), corner(2), corner(3)]);
    }

    fn add(&mut self, position: DVec3) -> VertexId {
        self.mesh.positions.push(position.into());
        VertexId::new(self.mesh.positions.len() - 1)
    }

    /// Adds a quad, split along its shorter diagonal.
    fn quad(&mut self, [a, b, c, d]: [Corner; 4]) {
        let length = |a: Corner, b: Corner| {
            let [a, b] = [a.0, b.0].map(|v| DVec3::from(self.mesh.positions[v.index()]));
            a.distance_squared(b)
        };
        if length(a, c) <= length(b, d) * (1.0 + 1e-9) {
            self.face([a, b, c]);
            self.face([a, c, d]);
        } else {
            self.face([a, b, d]);
            self.face([b, c, d]);
        }
    }

    fn face(&mut self, corners: [Corner; 3]) {
        self.mesh.faces.push(corners.map(|corner| corner.0));
        let wedges = corners.map(|corner| self.wedge(corner));
        self.corners.push(wedges);
    }

    fn wedge(&mut self, (vertex, uv, color): Corner) -> WedgeId {
        let values = [uv[0], uv[1], color.x, color.y, color.z].map(|value| value as f32);
        let next = WedgeId::new(self.wedges.len());
        let wedge = *self.wedges.entry((vertex, values.map(f32::to_bits))).or_insert(next);
        if wedge == next {
            self.uvs.extend(&values[..2]);
            self.colors.extend(&values[2..]);
        }
        wedge
    }

    /// Returns the mesh, with normals and without the vertices inside blocks.
    pub fn finish(self) -> Mesh {
        let normals = vertex_normals(&self.mesh);
        let mut of_wedge = vec![[0.0; 3]; self.wedges.len()];
        for (&(vertex, _), wedge) in &self.wedges {
            of_wedge[wedge.index()] = normals[vertex.index()];
        }
        let layer =
            |kind, name: &str, width, values| Layer { kind, name: name.into(), width, values };
        let mut mesh = self.mesh;
        mesh.attributes = Some(Attributes {
            corners: self.corners,
            wedge_count: of_wedge.len(),
            layers: vec![
                layer(LayerKind::Normal, "normal", 3, of_wedge.into_iter().flatten().collect()),
                layer(LayerKind::Uv(0), "uv", 2, self.uvs),
                layer(LayerKind::Color(0), "color", 3, self.colors),
            ],
        });
        mesh.compact();
        mesh
    }
}

/// Computes unit normals of vertices: face normals weighted by the angle at the vertex [TW98].
fn vertex_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for &face in &mesh.faces {
        let points = mesh.triangle(face);
        let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
        for k in 0..3 {
            let [p, q, r] = [0, 1, 2].map(|step| points[(k + step) % 3]);
            sums[face[k].index()] += normal * (q - p).angle_between(r - p);
        }
    }
    sums.into_iter().map(|sum| sum.normalize_or_zero().as_vec3().to_array()).collect()
}
