//! Fusing: the union of closed components that pass through each other, as one surface.

mod closed_groups;
mod patches;
mod solids;
#[cfg(test)]
mod tests;

use meshlod_mesh::{FaceId, Labels, Mesh};

use crate::imprint::{Imprint, Imprinted, at_safe_scale, imprinted};
use crate::objects::{Objects, ObjectsBy};
use crate::repair::{drop_unused, retain_faces, stitch};
use closed_groups::SolidGroups;
use patches::patches;
use solids::Solids;

/// Counts of the changes that [`fuse`] made to a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fused {
    /// Counts of the cuts made where components intersect, before anything is removed.
    pub imprint: Imprint,
    /// Number of faces, or pieces of cut faces, removed because they were inside another component.
    pub buried: usize,
    /// Number of edges along which the remaining surfaces were joined.
    pub joined: usize,
    /// Number of components that intersect others but were left as they are, because they are open
    /// or inside out.
    pub left: usize,
}

impl Fused {
    /// Adds the counts for another mesh to these.
    pub fn add(&mut self, other: &Self) {
        self.imprint.pairs += other.imprint.pairs;
        self.imprint.faces += other.imprint.faces;
        self.imprint.vertices += other.imprint.vertices;
        self.buried += other.buried;
        self.joined += other.joined;
        self.left += other.left;
    }
}

/// Merges closed components that pass through each other into a single surface.
///
/// Components are cut along their intersections as in [`imprint`](crate::imprint()), the inner
/// pieces are removed, and the rest is joined.
///
/// A patch between intersections is removed if it lies inside a closed shell of another component
/// or on its surface. Of two coincident patches of equal orientation the first stays, of two of
/// opposite orientation neither. Components that intersect nothing stay, even inside others.
/// `solid` returns true for opaque faces of `mesh`: a shell with any other face hides nothing, nor
/// does one that is inside out. Open components and those inside out are neither cut nor cut others:
/// they would only be torn open along the cuts.
///
/// Object labels of the result show where each face came from; with fewer than two objects they are
/// named by component. If nothing intersects, the mesh is returned unchanged.
///
/// Closed components that intersect are closed together afterwards. If they would not be, because
/// faces are coplanar only up to rounding, they are only cut.
///
/// The mesh must have passed [`Mesh::validate`]. Cost: that of [`imprint`](crate::imprint()), and
/// for each patch up to 128 times the faces of each shell whose box contains it, at most 2^28 in
/// all; patches beyond that limit stay.
///
/// # References
/// [JKSH13]: winding numbers decide what is inside; here those of closed shells, next to each face.
pub fn fuse(mesh: &Mesh, solid: impl Fn(FaceId) -> bool) -> (Mesh, Fused) {
    at_safe_scale(mesh, |mesh| fuse_scaled(mesh, solid))
}

fn fuse_scaled(mesh: &Mesh, solid: impl Fn(FaceId) -> bool) -> (Mesh, Fused) {
    let objects = Objects::of(mesh, ObjectsBy::Auto);
    let is_closed = Solids::closed_components(mesh, &objects.component_of_face, objects.components);
    let Imprinted { mesh: mut fused, imprint, parents, contact_edges, left } =
        imprinted(mesh, |component| is_closed[component]);
    let component: Vec<u32> =
        parents.iter().map(|parent| objects.component_of_face[parent.index()]).collect();
    let patches = patches(&fused, &component, &contact_edges);
    if patches.is_empty() {
        return (fused, Fused { imprint, left, ..Fused::default() });
    }
    let mut solids = Solids::of(mesh, &objects.component_of_face, solid);
    let mut is_buried = vec![false; fused.faces.len()];
    for patch in patches {
        let own = component[patch.faces[0].index()];
        if solids.hide(&fused, &patch, own) {
            patch.faces.iter().for_each(|face| is_buried[face.index()] = true);
        }
    }
    let is_solid = solids.components(&objects.component_of_face);
    let groups = SolidGroups::of(&fused, &component, &is_solid);
    keep_closed(&fused, &groups, &mut is_buried);
    let of_face = parents.iter().map(|parent| objects.of_face[parent.index()].0).collect();
    fused.objects = Some(Labels { names: objects.names, of_face });
    let buried = retain_faces(&mut fused, |face| !is_buried[face]);
    // Without labels, the remains of different objects are joined too.
    let labels = fused.objects.take();
    let joined = stitch(&mut fused, 0.0);
    fused.objects = labels;
    drop_unused(&mut fused);
    (fused, Fused { imprint, buried, joined, left })
}

/// Keeps all of the solid components that would not be closed together: if faces are coplanar only
/// up to rounding, inside and outside cannot be decided.
fn keep_closed(mesh: &Mesh, groups: &SolidGroups, is_buried: &mut [bool]) {
    let closed = groups.closed(mesh, |face| !is_buried[face]);
    for (face, is_buried) in is_buried.iter_mut().enumerate() {
        *is_buried &= groups.of_face(face).is_none_or(|group| closed[group]);
    }
}
