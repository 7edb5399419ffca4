//! Tiles of the eight parts of a cell, put together.

use meshlod_mesh::{Attributes, Labels, Mesh, VertexId, WedgeId};
use rustc_hash::FxHashMap;

use crate::cell::Cell;
use crate::lattice::Point;
use crate::samples::Samples;
use crate::tile::{SAME, TileMesh, point_of};

/// Mesh of several tiles.
#[derive(Debug)]
pub struct Merged {
    /// The mesh, with a border on the sides of the whole cell.
    pub tile: TileMesh,
    /// Number of edges between the tiles that no edge of another one meets.
    pub open: usize,
}

/// Joins the tiles of parts of a cell at the curves along which they meet.
pub fn merge(parts: Vec<TileMesh>, cell: Cell) -> Merged {
    let mut joined = Joined::default();
    let (mut samples, mut seams) = (Vec::new(), Vec::new());
    for mut part in parts {
        samples.push(std::mem::take(&mut part.samples));
        seams.append(&mut part.seams);
        joined.add(part);
    }
    let Joined { mesh, border, .. } = joined;
    let sides = |v: VertexId| cell.sides_of(point_of(&mesh, v));
    let (border, inner): (Vec<_>, Vec<_>) =
        border.into_iter().partition(|&[a, b]| sides(a) & sides(b) != 0);
    let samples = Samples::of_parts(&samples);
    seams.retain(|&point| cell.sides_of(point) != 0);
    seams.sort_unstable();
    seams.dedup();
    Merged { tile: TileMesh { mesh, border, seams, samples }, open: unmatched(&inner) }
}

/// Returns the number of directed edges that are not there in the other direction.
fn unmatched(edges: &[[VertexId; 2]]) -> usize {
    let mut sums: FxHashMap<[VertexId; 2], i32> = FxHashMap::default();
    for &[a, b] in edges {
        match a < b {
            true => *sums.entry([a, b]).or_default() += 1,
            false => *sums.entry([b, a]).or_default() -= 1,
        }
    }
    sums.values().map(|sum| sum.unsigned_abs() as usize).sum()
}

#[derive(Default)]
struct Joined {
    mesh: Mesh,
    border: Vec<[VertexId; 2]>,
    /// Vertex of a border at each point.
    at: FxHashMap<Point, VertexId>,
    /// Wedges at vertices of borders.
    wedges: FxHashMap<VertexId, Vec<WedgeId>>,
}

impl Joined {
    fn add(&mut self, part: TileMesh) {
        let is_border = part.border_vertices();
        let TileMesh { mesh, border, .. } = part;
        let vertices: Vec<VertexId> = (0..mesh.positions.len())
            .map(|i| {
                let next = VertexId::new(self.mesh.positions.len());
                let v = match is_border[i] {
                    true => *self.at.entry(point_of(&mesh, VertexId::new(i))).or_insert(next),
                    false => next,
                };
                if v == next {
                    self.mesh.positions.push(mesh.positions[i]);
                }
                v
            })
            .collect();
        if let Some(attributes) = &mesh.attributes {
            self.add_attributes(attributes, &mesh.faces, (&vertices, &is_border));
        }
        if let Some(labels) = &mesh.materials {
            let own = self
                .mesh
                .materials
                .get_or_insert_with(|| Labels { names: labels.names.clone(), of_face: Vec::new() });
            own.of_face.extend(&labels.of_face);
        }
        self.mesh.faces.extend(mesh.faces.iter().map(|face| face.map(|v| vertices[v.index()])));
        self.border.extend(border.iter().map(|edge| edge.map(|v| vertices[v.index()])));
    }

    fn add_attributes(
        &mut self,
        attributes: &Attributes,
        faces: &[[VertexId; 3]],
        (vertices, is_border): (&[VertexId], &[bool]),
    ) {
        let own = self.mesh.attributes.get_or_insert_with(|| {
            let layers = attributes.layers.iter();
            let layers =
                layers.map(|layer| meshlod_mesh::Layer { values: Vec::new(), ..layer.clone() });
            Attributes { wedge_count: 0, corners: Vec::new(), layers: layers.collect() }
        });
        let mut homes = vec![None; attributes.wedge_count];
        for (face, corners) in faces.iter().zip(&attributes.corners) {
            for (v, wedge) in face.iter().zip(corners) {
                homes[wedge.index()] = Some(*v);
            }
        }
        let mut new = vec![WedgeId(0); attributes.wedge_count];
        for (i, home) in homes.iter().enumerate() {
            let Some(home) = *home else { continue };
            let old = WedgeId::new(i);
            let shared = is_border[home.index()]
                .then(|| self.wedges.entry(vertices[home.index()]).or_default());
            let known = shared.as_ref().and_then(|known| {
                known.iter().find(|&&wedge| is_close(own, wedge, attributes, old)).copied()
            });
            new[i] = known.unwrap_or_else(|| {
                let wedge = WedgeId::new(own.wedge_count);
                own.wedge_count += 1;
                for (into, from) in own.layers.iter_mut().zip(&attributes.layers) {
                    into.values.extend_from_slice(from.of(old));
                }
                if let Some(known) = shared {
                    known.push(wedge);
                }
                wedge
            });
        }
        let corners = attributes.corners.iter();
        own.corners.extend(corners.map(|corners| corners.map(|wedge| new[wedge.index()])));
    }
}

fn is_close(a: &Attributes, of_a: WedgeId, b: &Attributes, of_b: WedgeId) -> bool {
    a.layers
        .iter()
        .zip(&b.layers)
        .all(|(a, b)| a.of(of_a).iter().zip(b.of(of_b)).all(|(x, y)| (x - y).abs() <= SAME))
}
