//! An octree with the objects in each leaf, which shows where contacts may be.

use meshlod_mesh::{FaceId, Mesh};
use meshlod_spatial::Octree;

use crate::check::subject::Subject;
use crate::{CheckOptions, ObjectId};

/// An octree over the valid faces of a mesh, with the faces and objects in each leaf.
///
/// Every contact between objects lies in a leaf with faces of both, but not every such leaf has a
/// contact. The leaves are those of [`Octree`].
///
/// # References
/// [CC05] section 3: cells with faces of two objects are contacts; differs: they are only
/// candidates, whose faces are tested exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectOctree {
    /// Minimum corner of the root cube, in model units.
    pub origin: [f64; 3],
    /// Side length of the root cube, in model units.
    pub side: f64,
    /// Nonempty leaves of the octree, sorted by level, then by z, y and x.
    pub leaves: Vec<ObjectLeaf>,
}

/// A leaf of an [`ObjectOctree`] with the faces and objects in it.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectLeaf {
    /// Level of the leaf: its side length is that of the root divided by 2^level.
    pub level: u8,
    /// Integer coordinates of the leaf in the grid of its level, each below 2^level.
    pub at: [u32; 3],
    /// Objects with faces in the leaf, lowest first.
    pub objects: Vec<ObjectId>,
    /// Faces that pass through the leaf, lowest first.
    pub faces: Vec<FaceId>,
}

impl ObjectOctree {
    /// Builds the octree over a mesh. The only option used is [`CheckOptions::objects`].
    ///
    /// Faces with missing or non-finite vertices are excluded.
    pub fn of(mesh: &Mesh, options: &CheckOptions) -> Self {
        let subject = Subject::of(mesh, options);
        let faces: Vec<FaceId> = subject.valid_faces().map(|(face, _)| face).collect();
        let octree =
            Octree::new(faces.len(), |i| mesh.triangle(mesh.faces[faces[i as usize].index()]));
        let of_face = &subject.objects().of_face;
        let leaves = octree.leaves().iter().map(|leaf| {
            let faces: Vec<FaceId> = leaf.triangles.iter().map(|&i| faces[i as usize]).collect();
            let mut objects: Vec<ObjectId> = faces.iter().map(|f| of_face[f.index()]).collect();
            objects.sort_unstable();
            objects.dedup();
            ObjectLeaf { level: leaf.level, at: leaf.at, objects, faces }
        });
        Self { origin: octree.origin(), side: octree.side(), leaves: leaves.collect() }
    }

    /// Iterates over the leaves that contain faces of two objects or more.
    pub fn shared(&self) -> impl Iterator<Item = &ObjectLeaf> + '_ {
        self.leaves.iter().filter(|leaf| leaf.objects.len() > 1)
    }

    /// Returns the minimum corner and the side length of a leaf, in model units.
    pub fn corner_and_side(&self, leaf: &ObjectLeaf) -> ([f64; 3], f64) {
        let side = self.side / f64::from(1u32 << leaf.level);
        (std::array::from_fn(|axis| self.origin[axis] + f64::from(leaf.at[axis]) * side), side)
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;
    use meshlod_samples as samples;

    use super::*;
    use crate::{Finding, Kind, Kinds, findings};

    /// Merges two meshes, the second moved along x.
    fn both(first: Mesh, second: Mesh, x: f64) -> Mesh {
        let mut mesh = first;
        let offset = mesh.positions.len() as u32;
        mesh.positions.extend(second.positions.iter().map(|p| [p[0] + x, p[1], p[2]]));
        mesh.faces.extend(second.faces.iter().map(|f| f.map(|v| VertexId(v.0 + offset))));
        mesh
    }

    #[test]
    fn separate_objects_share_no_leaf_if_leaves_are_small() {
        let mesh = both(samples::sphere(1000), samples::sphere(1000), 2.2);
        let octree = ObjectOctree::of(&mesh, &CheckOptions::default());
        assert!(octree.leaves.len() > 100 && octree.shared().count() == 0);
        assert!(octree.leaves.iter().all(|leaf| leaf.faces.len() <= 16));
    }

    #[test]
    fn every_contact_is_in_a_shared_leaf() {
        let mesh = both(samples::sphere(1000), samples::torus(1000), 0.3);
        let options = CheckOptions { kinds: Kinds::NONE.with(Kind::Contact), ..Default::default() };
        let octree = ObjectOctree::of(&mesh, &options);
        let contacts = findings(&mesh, &options);
        assert!(contacts.len() > 20);
        for contact in contacts {
            let Finding::Contact { objects, faces, intersection } = contact else { unreachable!() };
            let holds = |leaf: &&ObjectLeaf| {
                leaf.objects == objects && faces.iter().all(|face| leaf.faces.contains(face))
            };
            let leaf = octree.shared().find(holds).expect("a leaf with both");
            let (corner, side) = octree.corner_and_side(leaf);
            assert!(
                (0..3).all(|i| (intersection.point[i] - corner[i] - side / 2.0).abs() < 4.0 * side)
            );
        }
    }
}
