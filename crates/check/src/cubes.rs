//! Cubes over a model, and the objects in each: a net for contacts that can be looked at.

use meshlod_mesh::{FaceId, Mesh};
use meshlod_spatial::Octree;

use crate::check::subject::Subject;
use crate::{CheckOptions, ObjectId};

/// An octree of cubes over the sound faces of a mesh, with the objects in each cube.
///
/// What objects have in common, they have in a cube with two objects or more; not every such cube
/// has a contact. The same mesh gives the same cubes: their rules are those of [`Octree`].
/// # References
/// [CC05] section 3: cubes with faces of two objects are contacts; differs: they are candidates, the
/// faces in them are tested exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Cubes {
    /// The least corner of the whole.
    pub origin: [f64; 3],
    /// The side of the whole, in model units.
    pub side: f64,
    /// The leaves that faces pass through: by level, then along the axes, the last one first.
    pub marked: Vec<MarkedCube>,
}

/// A cube that faces pass through.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkedCube {
    /// How often the whole was halved.
    pub level: u8,
    /// Which it is along each axis, of 2^level.
    pub at: [u32; 3],
    /// The objects with faces in it, lowest first.
    pub objects: Vec<ObjectId>,
    /// The faces that pass through it, lowest first.
    pub faces: Vec<FaceId>,
}

impl Cubes {
    /// The cubes over `mesh`; of the options, what makes an object counts.
    ///
    /// Faces that name vertices that are not there or not finite have no part.
    pub fn of(mesh: &Mesh, options: &CheckOptions) -> Self {
        let subject = Subject::of(mesh, options);
        let faces: Vec<FaceId> = subject.sound().map(|(face, _)| face).collect();
        let octree =
            Octree::new(faces.len(), |i| mesh.triangle(mesh.faces[faces[i as usize].index()]));
        let of_face = &subject.objects().of_face;
        let marked = octree.cubes().iter().map(|cube| {
            let faces: Vec<FaceId> = cube.triangles.iter().map(|&i| faces[i as usize]).collect();
            let mut objects: Vec<ObjectId> = faces.iter().map(|f| of_face[f.index()]).collect();
            objects.sort_unstable();
            objects.dedup();
            MarkedCube { level: cube.level, at: cube.at, objects, faces }
        });
        Self { origin: octree.origin(), side: octree.side(), marked: marked.collect() }
    }

    /// The cubes with faces of two objects or more.
    pub fn shared(&self) -> impl Iterator<Item = &MarkedCube> + '_ {
        self.marked.iter().filter(|cube| cube.objects.len() > 1)
    }

    /// The least corner of a cube, and its side, in model units.
    pub fn place(&self, cube: &MarkedCube) -> ([f64; 3], f64) {
        let side = self.side / f64::from(1u32 << cube.level);
        (std::array::from_fn(|axis| self.origin[axis] + f64::from(cube.at[axis]) * side), side)
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;
    use meshlod_samples as samples;

    use super::*;
    use crate::{Finding, Kind, Kinds, findings};

    /// Two meshes in one, the second moved along x.
    fn both(first: Mesh, second: Mesh, x: f64) -> Mesh {
        let mut mesh = first;
        let offset = mesh.positions.len() as u32;
        mesh.positions.extend(second.positions.iter().map(|p| [p[0] + x, p[1], p[2]]));
        mesh.faces.extend(second.faces.iter().map(|f| f.map(|v| VertexId(v.0 + offset))));
        mesh
    }

    #[test]
    fn objects_that_are_apart_share_no_cube_where_cubes_are_small() {
        let mesh = both(samples::sphere(1000), samples::sphere(1000), 2.2);
        let cubes = Cubes::of(&mesh, &CheckOptions::default());
        assert!(cubes.marked.len() > 100 && cubes.shared().count() == 0);
        assert!(cubes.marked.iter().all(|cube| cube.faces.len() <= 16));
    }

    #[test]
    fn every_contact_is_in_a_shared_cube() {
        let mesh = both(samples::sphere(1000), samples::torus(1000), 0.3);
        let options = CheckOptions { kinds: Kinds::NONE.with(Kind::Contact), ..Default::default() };
        let cubes = Cubes::of(&mesh, &options);
        let contacts = findings(&mesh, &options);
        assert!(contacts.len() > 20);
        for contact in contacts {
            let Finding::Contact { objects, faces, touch } = contact else { unreachable!() };
            let holds = |cube: &&MarkedCube| {
                cube.objects == objects && faces.iter().all(|face| cube.faces.contains(face))
            };
            let cube = cubes.shared().find(holds).expect("a cube with both");
            let (corner, side) = cubes.place(cube);
            assert!((0..3).all(|i| (touch.place[i] - corner[i] - side / 2.0).abs() < 4.0 * side));
        }
    }
}
