//! Conditioning of a mesh for simplification: borders that lie on each other are sewn together, and
//! non-manifold vertices are split, until every vertex has one fan of faces.
//!
//! Both are one question: which sides of faces belong together? [`links`] answers it for the edges
//! that the faces share, [`stitch`] for borders at equal positions, and [`fans`] then numbers the
//! vertices: corners that linked sides connect are one vertex. [`carry`] takes attributes and
//! locks along, and [`rejoin`] makes one vertex of the copies that have not moved.

mod carry;
mod fans;
mod links;
mod near;
mod pairing;
mod rejoin;
mod stitch;

use std::borrow::Cow;

use crate::{Connectivity, FaceId, Locks, Mesh, Side, Twin, VertexId};

use fans::Fans;
use links::Links;
pub use near::{NearBorders, near_borders};
use rejoin::Joints;

/// Treatment of boundary edges that lie on each other in the conditioning of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Borders {
    /// Boundary edges at equal positions and of opposite directions become one edge.
    #[default]
    Stitch,
    /// Boundary edges stay as they are.
    Keep,
}

/// Options of [`condition`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ConditionOptions {
    /// What happens to boundary edges that lie on each other.
    pub borders: Borders,
    /// True to lock every vertex on the boundary of the conditioned mesh, where edges that the
    /// splitting has opened do not count.
    pub lock_boundary: bool,
}

/// Numbers of edges, vertices and faces that the conditioning of a mesh has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    /// What has been changed.
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
    /// that have moved, or of which nobody can tell to which of several vertices at one position
    /// they belong, stay apart.
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
/// Cost: O(n log n), n = boundary and non-manifold edges, and linear in all else.
/// # Panics
/// If the mesh is not valid, see [`Mesh::validate`].
pub fn condition(mesh: &Mesh, locks: &Locks, options: &ConditionOptions) -> Option<Conditioned> {
    let mut connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let duplicates = links::duplicate_faces(mesh, &connectivity);
    let mut mesh = Cow::Borrowed(mesh);
    if !duplicates.is_empty() {
        mesh = Cow::Owned(without(&mesh, &duplicates));
        connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    }
    let mut links = Links::new(&mesh, &connectivity);
    let mut sewn = match options.borders {
        Borders::Stitch => stitch::sew(&mesh, &connectivity, locks, &mut links),
        Borders::Keep => Vec::new(),
    };
    let is_clean = links.opened.is_empty() && connectivity.pinched_vertices() == 0;
    if duplicates.is_empty() && sewn.is_empty() && is_clean {
        return None;
    }
    let fans = settle(&mesh, &mut links, &mut sewn);
    let counts = Conditioning {
        stitched_edges: sewn.len(),
        stitched_vertices: fans.merged(&mesh),
        split_vertices: fans.split_vertices(),
        duplicate_faces: duplicates.len(),
    };
    let borders = options.lock_boundary.then(|| boundary_corners(&mesh, &connectivity, &links));
    let locks = carry::locks(&mesh, locks, &fans, borders, &links.opened);
    let joints = Joints::new(&mesh, &fans);
    let mesh = carry::mesh(mesh.into_owned(), &fans, counts.stitched_edges > 0);
    Some(Conditioned { mesh, locks, counts, joints })
}

/// Numbers the vertices, and cuts the links that would make a non-manifold mesh after all.
///
/// Cutting only divides vertices further: where no sewn edge is left at a vertex, only what the
/// input has remains to be cut, and that needs no third round.
fn settle(mesh: &Mesh, links: &mut Links, sewn: &mut Vec<[Side; 2]>) -> Fans {
    let mut fans = Fans::new(mesh, links);
    if !sewn.is_empty() {
        let odd = fans.odd_sides(mesh);
        let held = fans.ends(&odd);
        let is_odd = |side: &Side| fans.side_ends(*side).iter().any(|v| held.contains(v));
        let before = sewn.len();
        sewn.retain(|pair| {
            let keep = !pair.iter().any(is_odd);
            if !keep {
                links.cut(pair[0]);
            }
            keep
        });
        if sewn.len() < before {
            fans = Fans::new(mesh, links);
        }
    }
    let odd = fans.odd_sides(mesh);
    if !odd.is_empty() {
        odd.iter().for_each(|&side| links.cut(side));
        sewn.retain(|pair| links.is_linked(pair[0]));
        fans = Fans::new(mesh, links);
    }
    fans
}

/// Returns the corners at the ends of all boundary edges that have not been sewn.
fn boundary_corners(mesh: &Mesh, connectivity: &Connectivity, links: &Links) -> Vec<usize> {
    let sides = (0..mesh.faces.len()).flat_map(|f| (0..3).map(move |k| Side::new(FaceId::new(f), k)));
    sides
        .filter(|&side| connectivity.twin(side) == Twin::Boundary && !links.is_linked(side))
        .flat_map(|side| [fans::corner(side, 0), fans::corner(side, 1)])
        .collect()
}

/// Returns a mesh without some of its faces, given in ascending order.
fn without(mesh: &Mesh, faces: &[FaceId]) -> Mesh {
    let mut out = faces.iter().map(|face| face.0).peekable();
    let kept: Vec<u32> =
        (0..mesh.faces.len() as u32).filter(|&f| out.next_if_eq(&f).is_none()).collect();
    let pick = |corners: &[[VertexId; 3]]| kept.iter().map(|&f| corners[f as usize]).collect();
    Mesh {
        positions: mesh.positions.clone(),
        faces: pick(&mesh.faces),
        attributes: mesh.attributes.as_ref().map(|attributes| {
            let corners = kept.iter().map(|&f| attributes.corners[f as usize]).collect();
            crate::Attributes { corners, ..attributes.clone() }
        }),
        materials: mesh.materials.as_ref().map(|labels| labels.select(&kept)),
        objects: mesh.objects.as_ref().map(|labels| labels.select(&kept)),
    }
}

#[cfg(test)]
mod tests;
