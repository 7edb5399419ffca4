//! Conditioning of a mesh for simplification: borders that lie on each other are sewn together, and
//! non-manifold vertices are split, until every vertex has one fan of faces.
//!
//! Both are one question: which sides of faces belong together? [`suspects`] finds the places where
//! it arises, [`links`] answers it for the edges that the faces share, [`stitch`] for borders at
//! equal positions, and [`fans`] then numbers the vertices: corners that linked sides connect are
//! one vertex. [`carry`] changes the mesh and takes attributes and locks along, and [`rejoin`] makes
//! one vertex of the copies that have not moved.

mod carry;
mod fans;
mod links;
mod near;
mod pairing;
mod rejoin;
mod stitch;
mod suspects;

use crate::{Connectivity, Locks, Mesh, Side};

use carry::Change;
use fans::FanVertices;
use links::Links;
pub use near::{NearBorders, near_borders};
use rejoin::Joints;
use suspects::Around;
pub use suspects::is_balanced;

/// Treatment of boundary edges that lie on each other in the conditioning of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Borders {
    /// Boundary edges at equal positions and of opposite directions become one edge.
    #[default]
    Stitch,
    /// Boundary edges stay as they are.
    Keep,
}

/// Selection of the vertices that the conditioning of a mesh examines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Search {
    /// Vertices that end a boundary edge, an edge with an odd number of faces, or one whose faces do
    /// not agree. A pinched vertex of closed fans, and a front with its back, are not found.
    ///
    /// One pass over the faces finds them.
    Unbalanced,
    /// All vertices on the boundary and all that are not manifold.
    #[default]
    All,
}

/// Options of [`condition`].
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ConditionOptions {
    /// Selection of the vertices to examine.
    pub search: Search,
    /// Treatment of boundary edges that lie on each other.
    pub borders: Borders,
    /// True to lock every vertex on the boundary of the conditioned mesh, where edges that the
    /// splitting has opened do not count.
    pub lock_boundary: bool,
}

/// Numbers of edges, vertices and faces that the conditioning of a mesh has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Conditioning {
    /// Number of pairs of boundary edges that became one edge.
    pub stitched_edges: usize,
    /// Number of vertices that were merged into others.
    pub stitched_vertices: usize,
    /// Number of vertices whose fans of faces became several vertices.
    pub split_vertices: usize,
    /// Number of faces left out because they repeat one with the same material and orientation.
    pub duplicate_faces: usize,
}

/// Mesh of manifold vertices made from any mesh, with the constraints on its vertices.
#[derive(Clone, Debug)]
pub struct Conditioned {
    /// The conditioned mesh. Vertices keep their ids, and copies follow; a vertex that was merged
    /// into another is unused.
    pub mesh: Mesh,
    /// Constraints on the vertices of the conditioned mesh.
    pub locks: Locks,
    /// Numbers of edges, vertices and faces that have been changed.
    pub counts: Conditioning,
    joints: Joints,
}

impl std::ops::AddAssign for Conditioning {
    fn add_assign(&mut self, other: Self) {
        self.stitched_edges += other.stitched_edges;
        self.stitched_vertices += other.stitched_vertices;
        self.split_vertices += other.split_vertices;
        self.duplicate_faces += other.duplicate_faces;
    }
}

impl Conditioned {
    /// Makes one vertex again of all copies of a vertex that have not moved in a simplified mesh.
    ///
    /// `level` must be made from the conditioned mesh and keep the order of its vertices. Copies
    /// stay apart if they have moved, or if several vertices at their position could be theirs.
    ///
    /// Cost: O(n), n = vertices.
    pub fn rejoin(&self, level: &mut Mesh) {
        self.joints.rejoin(level);
    }
}

/// Sews borders of a mesh together that lie on each other, and gives each fan of faces at a
/// non-manifold vertex a vertex of its own; `None` if there is nothing to do.
///
/// Two boundary edges are sewn if their ends are at equal positions, where -0 equals 0, and they
/// run in opposite directions, unless that would make a non-manifold edge, a face without three
/// different vertices, or a fold of two faces that lie on each other. Vertices are only merged if
/// they are locked alike, and tied ones never.
///
/// At an edge of more than two faces those are paired that continue each other most smoothly, with
/// some favour for the same material; a face and its reverse never are. Faces that repeat another
/// with the same material and orientation are left out.
///
/// Cost: O(n log n), n = faces at boundary edges and non-manifold vertices, and linear in all else.
/// # Panics
/// If the mesh is not valid, see [`Mesh::validate`].
pub fn condition(mesh: &Mesh, locks: &Locks, options: &ConditionOptions) -> Option<Conditioned> {
    let suspects = match options.search {
        Search::Unbalanced => suspects::unbalanced(mesh),
        Search::All => suspects::irregular(mesh),
    };
    if !suspects.contains(&true) {
        return None;
    }
    let mut around = Around::new(mesh, &suspects);
    let connect =
        |around: &Around| Connectivity::new(&around.mesh.faces, around.mesh.positions.len());
    let mut connectivity = connect(&around);
    let duplicates = links::duplicate_faces(&around.mesh, &connectivity);
    let left_out: Vec<u32> = duplicates.iter().map(|face| around.faces[face.index()]).collect();
    if !duplicates.is_empty() {
        around.remove(&duplicates);
        connectivity = connect(&around);
    }
    let mut links = Links::new(&around.mesh, &connectivity);
    let border = around.border(&connectivity);
    let mut sewn = match options.borders {
        Borders::Stitch => stitch::sew(&around.mesh, &border, &around.locks(locks), &mut links),
        Borders::Keep => Vec::new(),
    };
    let fans = settle(&around, &mut links, &mut sewn);
    if duplicates.is_empty() && sewn.is_empty() && fans.copies.is_empty() {
        return None;
    }
    let counts = Conditioning {
        stitched_edges: sewn.len(),
        stitched_vertices: fans.merged(),
        split_vertices: fans.split_vertices(),
        duplicate_faces: left_out.len(),
    };
    let open = border.into_iter().filter(|&side| !links.is_linked(side));
    let locked =
        options.lock_boundary.then(|| open.flat_map(|side| fans.side_ends(side)).collect());
    let change = Change::new(mesh.positions.len(), &around, &fans);
    let locks = change.locks(mesh, locks, locked);
    let mesh = change.mesh(mesh, &left_out, counts.stitched_edges > 0);
    let joints = Joints::new(&mesh, &change);
    Some(Conditioned { mesh, locks, counts, joints })
}

/// Numbers the vertices, and cuts the links that would make a non-manifold mesh after all.
///
/// Cutting only divides vertices further: where no sewn edge is left at a vertex, only what the
/// input has remains to be cut, and that needs no third round.
fn settle(around: &Around, links: &mut Links, sewn: &mut Vec<[Side; 2]>) -> FanVertices {
    let mut fans = FanVertices::new(around, links);
    let mut odd = fans.odd_sides();
    if !odd.is_empty() && !sewn.is_empty() {
        let held = fans.ends(&odd);
        let is_held = |side: &Side| fans.side_ends(*side).iter().any(|v| held.contains(v));
        let (cut, kept) = sewn.drain(..).partition(|pair| pair.iter().any(is_held));
        *sewn = kept;
        let cut: Vec<[Side; 2]> = cut;
        cut.iter().for_each(|pair| links.cut(pair[0]));
        fans = FanVertices::new(around, links);
        odd = fans.odd_sides();
    }
    if !odd.is_empty() {
        odd.iter().for_each(|&side| links.cut(side));
        sewn.retain(|pair| links.is_linked(pair[0]));
        fans = FanVertices::new(around, links);
    }
    fans
}

#[cfg(test)]
mod tests;
