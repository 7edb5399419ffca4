//! Fusing: components that pass through each other become one surface, without what is inside.

mod balance;
mod patches;
mod solids;
#[cfg(test)]
mod tests;

use meshlod_mesh::{FaceId, Labels, Mesh};

use crate::imprint::{Imprint, Imprinted, at_fitting_size, imprinted};
use crate::objects::{Objects, ObjectsBy};
use crate::repair::{drop_unused, retain_faces, stitch};
use balance::Groups;
use patches::patches;
use solids::Solids;

/// What fusing did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fused {
    /// Where components met.
    pub imprint: Imprint,
    /// Pieces of faces that were left out, since they were inside.
    pub buried: usize,
    /// Edges along which what is left was joined.
    pub joined: usize,
}

impl Fused {
    /// Counts another mesh in.
    pub fn add(&mut self, other: &Self) {
        self.imprint.pairs += other.imprint.pairs;
        self.imprint.faces += other.imprint.faces;
        self.imprint.vertices += other.imprint.vertices;
        self.buried += other.buried;
        self.joined += other.joined;
    }
}

/// Makes one surface of closed components that pass through each other: cuts them along the lines
/// where they meet, as [`imprint`](crate::imprint()) does, leaves out what is inside, and joins what is
/// left.
///
/// A patch between lines goes if a closed shell of another component has it inside, or on its surface:
/// of two that lie on each other and look one way, the first stays; of two that look against each
/// other, none. What meets nothing stays, also inside. `solid` tells of the faces of `mesh` that they
/// cannot be seen through; a shell with another hides nothing, nor does one that is inside out. Open
/// components hide nothing either; they are cut, lose what is inside closed ones, and are not joined
/// to them.
///
/// Labels of objects tell afterwards which face is of what; where there are less than two, they are
/// named by component. Where nothing meets, the mesh is what it was.
///
/// Closed components that meet are closed together afterwards; where that would not be so, since
/// faces lie in one plane only up to rounding, they are only cut.
///
/// Takes a mesh that has passed [`Mesh::validate`]. Cost: that of [`imprint`](crate::imprint()), and
/// for each patch up to 128 times the faces of each shell in whose box it is, up to 2^28 in all; what
/// is beyond that stays.
/// # References
/// [JKSH13]: winding numbers tell what is inside; here of closed shells, beside each face.
pub fn fuse(mesh: &Mesh, solid: impl Fn(FaceId) -> bool) -> (Mesh, Fused) {
    at_fitting_size(mesh, |mesh| fuse_fitting(mesh, solid))
}

fn fuse_fitting(mesh: &Mesh, solid: impl Fn(FaceId) -> bool) -> (Mesh, Fused) {
    let Imprinted { mesh: mut fused, imprint, parents, lines } = imprinted(mesh);
    let objects = Objects::of(mesh, ObjectsBy::Auto);
    let component: Vec<u32> =
        parents.iter().map(|parent| objects.component_of_face[parent.index()]).collect();
    let patches = patches(&fused, &component, &lines);
    if patches.is_empty() {
        return (fused, Fused { imprint, ..Fused::default() });
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
    let groups = Groups::of(&fused, &component, &is_solid);
    keep_closed(&fused, &groups, &mut is_buried);
    let of_face = parents.iter().map(|parent| objects.of_face[parent.index()].0).collect();
    fused.objects = Some(Labels { names: objects.names, of_face });
    let buried = retain_faces(&mut fused, |face| !is_buried[face]);
    // What is left of several objects is joined, too.
    let labels = fused.objects.take();
    let joined = stitch(&mut fused, 0.0);
    fused.objects = labels;
    drop_unused(&mut fused);
    (fused, Fused { imprint, buried, joined })
}

/// Leaves solid components alone that would not be closed together: where faces lie in one plane but
/// for rounding, it cannot be told what is inside.
fn keep_closed(mesh: &Mesh, groups: &Groups, is_buried: &mut [bool]) {
    let closed = groups.closed(mesh, |face| !is_buried[face]);
    for (face, is_buried) in is_buried.iter_mut().enumerate() {
        *is_buried &= groups.of_face(face).is_none_or(|group| closed[group]);
    }
}
