//! Flat regions with as few faces as their outlines need.
//!
//! Faces that lie in one plane and continue each other are a **region**. What is inside it goes, and
//! so does each vertex on a straight part of its outline that both sides can do without; what is left
//! of the outline is triangulated anew. No vertex moves and none is added. A closed model of flats
//! has 2 (n - χ) faces then, n being its corners.
//!
//! Where regions cannot be told from the plane alone, they stay as they are: one that covers itself,
//! one whose attributes are not linear in the plane, or one whose new edges are elsewhere already.
//!
//! Read in this order:
//!
//! | module | what it holds |
//! |---|---|
//! | `regions` | faces that lie in one plane and continue each other |
//! | `slivers` | faces without area on the edges of regions |
//! | `linear` | whether attributes are linear over faces |
//! | `outline` | the vertices of outlines that stay, and the sides between them |
//! | `fill` | a region's outline, triangulated |
//! | `apart` | new edges that are elsewhere already |
//! | `sample` | an estimate of how much is flat |
//! | `give_up` | regions that stay as they are, where they cannot be filled |

mod apart;
mod fill;
mod give_up;
mod linear;
mod outline;
mod regions;
mod sample;
mod slivers;

use meshlod_mesh::{Attributes, Connectivity, Lock, Locks, Mesh, VertexId, WedgeId};
use rayon::prelude::*;

use crate::flat::fill::fill;
use crate::flat::give_up::GivenUp;
use crate::flat::linear::Linear;
use crate::flat::outline::{OutlineSide, Outlines, least_faces, pinched};
use crate::flat::regions::{Region, Regions};
pub use crate::flat::sample::flat_part;

/// Mesh whose flat regions have as few faces as their outlines need.
#[derive(Clone, Debug)]
pub struct Flattened {
    /// The mesh; `None` if no face goes. Vertices and wedges keep their ids, and those that went are
    /// unused.
    pub mesh: Option<Mesh>,
    /// Upper bound of the distance between the mesh and its input, both ways, in model units: 0 if
    /// all that went was exactly flat.
    pub moved: f64,
    /// Number of faces that the outlines of all regions need, given the constraints. The mesh has more
    /// where a region had to stay as it is.
    pub needed_faces: usize,
    /// True if the mesh has edges of more than two faces, or vertices of several fans: flats end there,
    /// and stay where they share more.
    pub is_crowded: bool,
}

/// Constraints on what may go.
#[derive(Clone, Copy, Debug)]
pub struct FlatOptions<'l> {
    /// Vertices that stay where they are: all that are locked, protected or tied.
    pub locks: &'l Locks,
    /// True if no vertex on the boundary may go.
    pub lock_boundary: bool,
    /// Largest distance by which the surface may move, in model units. With 0 only what is exactly
    /// flat goes.
    pub tolerance: f64,
}

/// A face to be made: its vertices and wedges, and the face of the input that it has all else from.
#[derive(Clone, Copy, Debug)]
struct NewFace {
    vertices: [VertexId; 3],
    wedges: [WedgeId; 3],
    like: u32,
}

/// Faces that the flat regions of a mesh need, found without filling any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlatNeeds {
    /// Number of faces that the outlines of all regions need, given the constraints, or a lower bound of
    /// it. [`flatten`] leaves more where regions have to stay as they are.
    pub faces: usize,
    /// True if the mesh has edges of more than two faces, or vertices of several fans: flats end there,
    /// and stay where they share more.
    pub is_crowded: bool,
}

/// Returns how many faces the flat regions of a mesh need, see [`flatten`], or once it is more than
/// `most`, a lower bound.
///
/// Cost: O(n), n = faces, at most a third of that of filling them.
/// # Panics
/// If the mesh is not valid, see [`Mesh::validate`].
pub fn flat_needs(mesh: &Mesh, options: &FlatOptions<'_>, most: usize) -> FlatNeeds {
    let mut flats = Flats::find(mesh, options);
    let is_crowded = flats.is_crowded();
    let least = |region: &Region| if region.is_kept { region.faces.len() } else { 1 };
    let least: usize = flats.regions.list.iter().map(least).sum();
    if least > most {
        return FlatNeeds { faces: least, is_crowded };
    }
    flats.keep_pinched();
    FlatNeeds { faces: flats.needed(&flats.outlines().sides), is_crowded }
}

/// Gives the flat regions of a mesh as few faces as their outlines need.
///
/// Borders, edges between materials, objects or values of faces, seams of attributes, and the volume
/// stay as they are. Attributes that are not linear in the plane of a region, to half of
/// [`AttributeBounds`](meshlod_mesh::AttributeBounds) by default, keep it as it is.
///
/// Cost: O(n log n), n = faces, and again for each time that regions turn out to stay as they are,
/// O(log n) times at most.
/// # Panics
/// If the mesh is not valid, see [`Mesh::validate`].
pub fn flatten(mesh: &Mesh, options: &FlatOptions<'_>) -> Flattened {
    let mut flats = Flats::find(mesh, options);
    flats.keep_pinched();
    let is_crowded = flats.is_crowded();
    let mut given_up = GivenUp::default();
    let mut needed = None;
    let mut last = Tried::default();
    loop {
        let outlines = flats.outlines();
        let needed_faces = *needed.get_or_insert_with(|| flats.needed(&outlines.sides));
        let as_it_is = Flattened { mesh: None, moved: 0.0, needed_faces, is_crowded };
        let regions = &mut flats.regions;
        if regions.list.iter().all(|region| region.is_kept) {
            return as_it_is;
        }
        let tried = Tried::new(mesh, regions, outlines.sides, &last);
        let mut failed: Vec<usize> = tried.failed();
        if failed.is_empty() {
            match apart::take_apart(mesh, regions, (&tried.faces, &tried.sides)) {
                Ok(faces) if faces.len() < mesh.faces.len() => {
                    let moved = regions.moved(outlines.moved);
                    return Flattened { mesh: Some(with_faces(mesh, &faces)), moved, ..as_it_is };
                }
                Ok(_) => return as_it_is,
                Err(together) => failed = together,
            }
        }
        given_up.give_up(mesh, regions, failed);
        last = tried;
    }
}

/// The flat regions of a mesh, and what limits them.
struct Flats<'m> {
    mesh: &'m Mesh,
    options: &'m FlatOptions<'m>,
    connectivity: Connectivity,
    linear: Linear<'m>,
    regions: Regions,
    /// True for each vertex that must stay.
    held: Vec<bool>,
}

impl<'m> Flats<'m> {
    fn find(mesh: &'m Mesh, options: &'m FlatOptions<'m>) -> Self {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let linear = Linear::new(mesh);
        let regions = Regions::find(mesh, &connectivity, &linear, options.tolerance);
        let held = held(mesh, options.locks);
        Self { mesh, options, connectivity, linear, regions, held }
    }

    /// Keeps regions as they are that would come apart.
    fn keep_pinched(&mut self) {
        let Self { mesh, connectivity, linear, regions, .. } = self;
        for r in pinched(mesh, connectivity, linear, regions) {
            regions.list[r].is_kept = true;
        }
    }

    fn is_crowded(&self) -> bool {
        self.connectivity.non_manifold_edges() + self.connectivity.pinched_vertices() > 0
    }

    fn outlines(&self) -> Outlines {
        let Self { mesh, options, connectivity, linear, regions, held } = self;
        Outlines::new(mesh, connectivity, linear, regions, held, options)
    }

    /// Returns the number of faces that all regions need within these outlines.
    fn needed(&self, sides: &[Vec<OutlineSide>]) -> usize {
        let Self { mesh, connectivity, linear, regions, .. } = self;
        let of_region = |(region, sides): (&Region, &Vec<OutlineSide>)| match region.is_kept {
            true => region.faces.len(),
            false => least_faces(mesh, connectivity, linear, (regions, region), sides.len()),
        };
        regions.list.iter().zip(sides).map(of_region).sum()
    }
}

/// Outlines of regions, and the faces that they were filled with.
#[derive(Default)]
struct Tried {
    sides: Vec<Vec<OutlineSide>>,
    /// Faces of each region: none of one that is kept, `None` where that is impossible.
    faces: Vec<Option<Vec<NewFace>>>,
}

impl Tried {
    /// Fills regions, but those whose outlines are as before.
    fn new(mesh: &Mesh, regions: &Regions, sides: Vec<Vec<OutlineSide>>, last: &Self) -> Self {
        let faces = (0..regions.list.len()).into_par_iter().map(|r| {
            let (region, sides) = (&regions.list[r], &sides[r]);
            match last.sides.get(r) {
                _ if region.is_kept => Some(Vec::new()),
                Some(before) if before == sides => last.faces[r].clone(),
                _ => fill(mesh, region, sides),
            }
        });
        let faces = faces.collect();
        Self { sides, faces }
    }

    /// Returns the regions that cannot be filled.
    fn failed(&self) -> Vec<usize> {
        (0..self.faces.len()).filter(|&r| self.faces[r].is_none()).collect()
    }
}

/// Returns which vertices must stay.
fn held(mesh: &Mesh, locks: &Locks) -> Vec<bool> {
    let locks = locks.with_ties_locked(mesh.positions.len());
    let is_held = |v| locks.of(VertexId::new(v)) != Lock::Free;
    (0..mesh.positions.len()).map(is_held).collect()
}

fn with_faces(mesh: &Mesh, faces: &[NewFace]) -> Mesh {
    let like: Vec<u32> = faces.iter().map(|face| face.like).collect();
    let attributes = mesh.attributes.as_ref().map(|attributes| Attributes {
        corners: faces.iter().map(|face| face.wedges).collect(),
        ..attributes.clone()
    });
    Mesh {
        positions: mesh.positions.clone(),
        faces: faces.iter().map(|face| face.vertices).collect(),
        attributes,
        materials: mesh.materials.as_ref().map(|labels| labels.select(&like)),
        objects: mesh.objects.as_ref().map(|labels| labels.select(&like)),
        face_layers: mesh.select_face_layers(&like),
    }
}

#[cfg(test)]
mod tests;
