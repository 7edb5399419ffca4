//! Attributes and locks of a mesh, carried over to the vertices of the conditioned mesh.

use std::collections::{BTreeMap, HashMap};

use crate::condition::fans::{Fans, Joined};
use crate::{Attributes, Lock, Locks, Mesh, Side, VertexId, WedgeId, merge_equal_wedges};

/// Largest number of vertices that are tied where a chain of edges has come apart.
const MOST_TIED: usize = 8;

/// Returns the mesh with the vertices of `fans`. Wedges that only stitching has brought to one
/// vertex are merged if they are equal.
pub(super) fn mesh(mut mesh: Mesh, fans: &Fans, is_stitched: bool) -> Mesh {
    mesh.faces = fans.faces();
    let copied: Vec<_> = fans.copies.iter().map(|v| mesh.positions[v.index()]).collect();
    mesh.positions.extend(copied);
    if let Some(attributes) = &mut mesh.attributes {
        part_wedges(attributes, &mesh.faces);
    }
    if is_stitched {
        merge_equal_wedges(&mut mesh);
    }
    mesh
}

/// Gives each vertex wedges of its own: those of several vertices are copied.
fn part_wedges(attributes: &mut Attributes, faces: &[[VertexId; 3]]) {
    let named = attributes.corners.as_flattened().iter().max().map_or(0, |w| w.index() + 1);
    if attributes.layers.is_empty() {
        // Without values their number is what the file claims.
        attributes.wedge_count = named;
    }
    let mut home: Vec<Option<VertexId>> = vec![None; named];
    let mut copies: HashMap<(WedgeId, VertexId), WedgeId> = HashMap::new();
    let mut origins = Vec::new();
    let first = attributes.wedge_count;
    for (wedge, &v) in attributes.corners.as_flattened_mut().iter_mut().zip(faces.as_flattened()) {
        if *home[wedge.index()].get_or_insert(v) != v {
            let of = *wedge;
            *wedge = *copies.entry((of, v)).or_insert_with(|| {
                origins.push(of);
                WedgeId::new(first + origins.len() - 1)
            });
        }
    }
    attributes.wedge_count += origins.len();
    for layer in &mut attributes.layers {
        for wedge in &origins {
            let start = wedge.index() * layer.width;
            layer.values.extend_from_within(start..start + layer.width);
        }
    }
}

/// Returns the locks of the conditioned mesh. Copies have the lock and the tie of their vertex,
/// `borders` are corners whose vertices are locked, and copies along the edges that have come apart
/// are tied.
pub(super) fn locks(
    mesh: &Mesh,
    locks: &Locks,
    fans: &Fans,
    borders: Option<Vec<usize>>,
    opened: &[Vec<Side>],
) -> Locks {
    let count = mesh.positions.len() + fans.copies.len();
    let mut of_vertex = Vec::new();
    if !locks.of_vertex.is_empty() || borders.is_some() {
        of_vertex = locks.of_vertex.clone();
        of_vertex.resize(mesh.positions.len(), Lock::Free);
        let copied = |v: &VertexId| of_vertex[v.index()];
        let copied: Vec<Lock> = fans.copies.iter().map(copied).collect();
        of_vertex.extend(copied);
        for corner in borders.into_iter().flatten() {
            of_vertex[fans.at(corner).index()] = Lock::Locked;
        }
    }
    let mut ties = copied_ties(locks, fans, mesh.positions.len());
    let mut is_held = vec![false; count];
    ties.iter().flatten().for_each(|v| is_held[v.index()] = true);
    of_vertex.iter().zip(&mut is_held).for_each(|(lock, held)| *held |= *lock == Lock::Locked);
    ties.extend(chains(mesh, fans, opened).into_iter().filter(|tie| {
        tie.len() <= MOST_TIED && !tie.iter().any(|v| is_held[v.index()])
    }));
    Locks { of_vertex, ties }
}

/// Returns the ties of the input with all copies of their vertices.
fn copied_ties(locks: &Locks, fans: &Fans, inputs: usize) -> Vec<Vec<VertexId>> {
    if locks.ties.is_empty() {
        return Vec::new();
    }
    let mut copies: HashMap<VertexId, Vec<VertexId>> = HashMap::new();
    for (i, &v) in fans.copies.iter().enumerate() {
        copies.entry(v).or_default().push(VertexId::new(inputs + i));
    }
    let with_copies = |v: &VertexId| {
        std::iter::once(*v).chain(copies.get(v).into_iter().flatten().copied()).collect::<Vec<_>>()
    };
    locks.ties.iter().map(|tie| tie.iter().flat_map(with_copies).collect()).collect()
}

/// Returns the copies that end edges which have come apart, one group for each place.
fn chains(mesh: &Mesh, fans: &Fans, opened: &[Vec<Side>]) -> Vec<Vec<VertexId>> {
    let mut all: Vec<VertexId> =
        opened.iter().flatten().flat_map(|&side| fans.side_ends(side)).collect();
    all.sort_unstable();
    all.dedup();
    let place = |v: VertexId| all.binary_search(&v).expect("it is among all");
    let mut joined = Joined::new(all.len());
    for sides in opened {
        let from = sides[0].ends(&mesh.faces)[0];
        let ends = |side: Side| {
            let [v, w] = fans.side_ends(side).map(place);
            if side.ends(&mesh.faces)[0] == from { [v, w] } else { [w, v] }
        };
        let first = ends(sides[0]);
        for &other in &sides[1..] {
            let other = ends(other);
            joined.join(first[0], other[0]);
            joined.join(first[1], other[1]);
        }
    }
    let mut groups: BTreeMap<usize, Vec<VertexId>> = BTreeMap::new();
    for (i, &v) in all.iter().enumerate() {
        groups.entry(joined.root(i)).or_default().push(v);
    }
    groups.into_values().filter(|group| group.len() > 1).collect()
}
