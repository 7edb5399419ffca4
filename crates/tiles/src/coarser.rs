//! Tile of a cell from those of its parts.

use meshlod_mesh::{Lock, Mesh, VertexId, WedgeId};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::cell::Cell;
use crate::chords::{divide_chords, divide_edges};
use crate::curves::{Flap, SimplerBorder, simplify_border};
use crate::lattice::Point;
use crate::octree::TileTree;
use crate::tile::TileMesh;

/// Part of the error of a level within which its border curves are simplified.
const OF_CURVES: f64 = 0.125;

/// Simplifies the mesh of a tile.
pub trait Coarsen {
    /// Reason why a mesh cannot be simplified.
    type Error: std::fmt::Display + Send;

    /// Simplifies a mesh to about an error, with locks for its vertices, and then further to a number
    /// of faces if it still has more. Returns the mesh, and a distance that no point of either is
    /// farther from the other.
    ///
    /// # Errors
    /// The method decides.
    fn coarsen(
        &self,
        mesh: &Mesh,
        locks: Vec<Lock>,
        error: f64,
    ) -> Result<(Mesh, f64), Self::Error>;

    /// Returns the error at which a mesh has a number of faces.
    ///
    /// # Errors
    /// The method decides.
    fn loss(&self, mesh: &Mesh, faces: usize) -> Result<f64, Self::Error>;

    /// Returns the distances of points from a mesh; none if it has no area.
    fn distances(&self, points: &Mesh, mesh: &Mesh) -> Vec<f64>;
}

/// Tile that is coarser than what it was made from.
#[derive(Debug)]
pub struct Coarser {
    /// The tile.
    pub tile: TileMesh,
    /// Bound of the distance between the tile and what it was made from, both ways, in steps.
    pub distance: f64,
    /// Whether the tile could not be simplified without harm to its border, and is as it was.
    pub is_unchanged: bool,
}

/// Simplifies a tile of an octree within an error, in steps of the lattice.
///
/// # Errors
/// Errors of the method.
pub fn coarser<C: Coarsen>(
    mut tile: TileMesh,
    (cell, tree): (Cell, &TileTree),
    error: f64,
    method: &C,
) -> Result<Coarser, C::Error> {
    let border = simplify_border(&tile, cell, tree, OF_CURVES * error);
    let moved = 2.0 * border.distance;
    take_border(&mut tile, border);
    let edges: Vec<[Point; 2]> =
        tile.border.iter().map(|edge| edge.map(|v| tile.point(v))).collect();
    let locks = tile.border_vertices().into_iter();
    let locks = locks.map(|is_border| if is_border { Lock::Locked } else { Lock::Free }).collect();
    let (mesh, distance) = method.coarsen(&tile.mesh, locks, error)?;
    let found = with_border(mesh, &edges);
    let is_unchanged = found.is_none();
    let (samples, seams) = (std::mem::take(&mut tile.samples), std::mem::take(&mut tile.seams));
    let (mut tile, distance) = match found {
        // Vertices move to whole steps.
        Some(tile) => (tile, distance + 0.75f64.sqrt()),
        None => (tile, 0.0),
    };
    (tile.samples, tile.seams) = (samples, seams);
    divide_chords(&mut tile, cell);
    Ok(Coarser { tile, distance: distance + moved, is_unchanged })
}

/// Gives a tile a simpler border, with faces between the old curves and the new ones.
fn take_border(tile: &mut TileMesh, border: SimplerBorder) {
    let old: FxHashSet<_> = tile.border.iter().copied().collect();
    let new = border.edges.iter().filter(|edge| !old.contains(*edge));
    let new: FxHashSet<_> = new.map(|&[a, b]| if a < b { [a, b] } else { [b, a] }).collect();
    divide_edges(&mut tile.mesh, &new);
    let beside = faces_at(&tile.mesh, &old);
    for Flap { corners, edges } in border.flaps {
        let is_at = |v: VertexId| tile.mesh.faces.iter().position(|face| face.contains(&v));
        let faces = [0, 1, 2].map(|i| {
            // An edge that a new one lies on has been divided.
            let face = beside.get(&edges[i]).copied().or_else(|| is_at(corners[i]));
            face.expect("vertices of the border have faces")
        });
        if let Some(attributes) = &mut tile.mesh.attributes {
            let wedges: [WedgeId; 3] = [0, 1, 2].map(|i| {
                let own = tile.mesh.faces[faces[i]].iter().position(|&v| v == corners[i]);
                attributes.corners[faces[i]][own.expect("a corner is an end of its edge")]
            });
            attributes.corners.push(wedges);
        }
        if let Some(labels) = &mut tile.mesh.materials {
            labels.of_face.push(labels.of_face[faces[2]]);
        }
        tile.mesh.faces.push(corners);
    }
    tile.border = border.edges;
}

/// Returns the first face at each of some directed edges.
fn faces_at(mesh: &Mesh, edges: &FxHashSet<[VertexId; 2]>) -> FxHashMap<[VertexId; 2], usize> {
    let mut faces = FxHashMap::default();
    for (face, &[a, b, c]) in mesh.faces.iter().enumerate() {
        for edge in [[a, b], [b, c], [c, a]] {
            if edges.contains(&edge) {
                faces.entry(edge).or_insert(face);
            }
        }
    }
    faces
}

/// Returns a simplified mesh with the border that it must have, and whole coordinates; `None` if an
/// edge of the border is missing.
fn with_border(mut mesh: Mesh, edges: &[[Point; 2]]) -> Option<TileMesh> {
    let ends: FxHashSet<Point> = edges.iter().flatten().copied().collect();
    let points: Vec<Option<Point>> = mesh
        .positions
        .iter()
        .map(|&at| {
            let point = at.map(|x| x as i32);
            (point.map(f64::from) == at && ends.contains(&point)).then_some(point)
        })
        .collect();
    let mut wanted: FxHashMap<[Point; 2], usize> = FxHashMap::default();
    edges.iter().for_each(|&edge| *wanted.entry(edge).or_default() += 1);
    let mut border = Vec::new();
    for &[a, b, c] in &mesh.faces {
        for edge in [[a, b], [b, c], [c, a]] {
            let [Some(from), Some(to)] = edge.map(|v| points[v.index()]) else { continue };
            if let Some(count) = wanted.get_mut(&[from, to]).filter(|count| **count > 0) {
                *count -= 1;
                border.push(edge);
            }
        }
    }
    for position in &mut mesh.positions {
        *position = position.map(f64::round);
    }
    let tile = TileMesh { mesh, border, ..TileMesh::default() };
    (tile.border.len() == edges.len()).then_some(tile)
}
