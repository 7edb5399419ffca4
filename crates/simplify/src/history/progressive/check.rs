//! Checks that decoded vertex splits can be applied and yield valid meshes.

use meshlod_mesh::{FaceId, MeshError, VertexId, WedgeId};

use super::{Progressive, ProgressiveError};

/// Refines a decoded mesh to its finest level and back, checking every split before it is applied.
///
/// Cost: linear.
pub(super) fn check(read: &mut Progressive) -> Result<(), ProgressiveError> {
    ranges(read)?;
    read.level().validate()?;
    let mut wedge_vertices = WedgeVertices::new(read);
    for index in (0..read.len()).rev() {
        fits(read, index)
            .and_then(|()| wedge_vertices.refine(read, index))
            .map_err(|why| ProgressiveError::Bad { what: "split", index, why })?;
    }
    // Labels of faces never change.
    read.level().validate()?;
    while read.coarsen() {}
    Ok(())
}

/// Checks that every index is in range, also in removed elements, and every position is finite.
fn ranges(read: &Progressive) -> Result<(), ProgressiveError> {
    let (mesh, splits) = (&read.mesh, &read.splits);
    let count = mesh.positions.len();
    if let Some(v) = mesh.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        let (vertex, position) = (VertexId::new(v), mesh.positions[v]);
        return Err(MeshError::NotFinite { vertex, position }.into());
    }
    for (f, face) in mesh.faces.iter().enumerate() {
        if let Some(&vertex) = face.iter().find(|v| v.index() >= count) {
            return Err(MeshError::BadVertex { face: FaceId::new(f), vertex, count }.into());
        }
    }
    let wedges = mesh.attributes.as_ref().map_or(0, |attributes| attributes.wedge_count);
    let corners = mesh.attributes.iter().flat_map(|attributes| &attributes.corners);
    for (f, corners) in corners.enumerate() {
        if let Some(wedge) = corners.iter().find(|w| w.index() >= wedges) {
            let (face, wedge) = (FaceId::new(f), wedge.0);
            return Err(MeshError::BadWedge { face, wedge, count: wedges }.into());
        }
    }
    let bad = |index, why| Err(ProgressiveError::Bad { what: "split", index, why });
    for (index, split) in splits.splits.iter().enumerate() {
        let ends = [split.kept, split.removed];
        if ends.iter().any(|v| v.index() >= count) || split.kept == split.removed {
            return bad(index, "its ends must be two different vertices");
        }
        if !split.position.iter().all(|x| x.is_finite()) {
            return bad(index, "its position is not finite");
        }
        let is_face = |face: FaceId| face.index() < mesh.faces.len();
        let corners = &splits.moved[splits.moved_range(index)];
        if !corners.iter().all(|corner| is_face(corner.face()) && corner.slot() < 3) {
            return bad(index, "it moves a corner that does not exist");
        }
        if !splits.removed_faces[splits.removed_range(index)].iter().all(|&face| is_face(face)) {
            return bad(index, "it adds a face that does not exist");
        }
        if splits.blended[splits.blended_range(index)].iter().any(|w| w.index() >= wedges) {
            return bad(index, "it blends a wedge that does not exist");
        }
    }
    match splits.wedges.iter().position(|w| w.index() >= wedges) {
        Some(corner) => Err(ProgressiveError::Bad {
            what: "moved corner",
            index: corner,
            why: "its wedge does not exist",
        }),
        None => Ok(()),
    }
}

/// Checks that a split's corners are at the vertex that it splits and its faces are not alive yet.
fn fits(read: &Progressive, index: usize) -> Result<(), &'static str> {
    let (mesh, splits) = (&read.mesh, &read.splits);
    let kept = splits.splits[index].kept;
    let corners = &splits.moved[splits.moved_range(index)];
    let removed_faces = &splits.removed_faces[splits.removed_range(index)];
    if corners.len() > MOST_CORNERS {
        return Err("it moves more corners than a contraction can");
    }
    for (i, corner) in corners.iter().enumerate() {
        let face = corner.face().index();
        if !read.alive[face] || mesh.faces[face][corner.slot()] != kept {
            return Err("it moves a corner of another vertex");
        }
        if corners[..i].contains(corner) {
            return Err("it moves a corner twice");
        }
    }
    // A component that vanished may have many faces.
    let mut removed_faces = removed_faces.to_vec();
    removed_faces.sort_unstable();
    let there = removed_faces.iter().any(|face| read.alive[face.index()]);
    let twice = removed_faces.windows(2).any(|pair| pair[0] == pair[1]);
    if there || twice { Err("it adds a face that is already alive") } else { Ok(()) }
}

/// Upper limit of the corners that a contraction moves.
const MOST_CORNERS: usize = 256;

/// Vertex of every wedge, and the number of corners that use it: a wedge belongs to one vertex.
struct WedgeVertices(Vec<(VertexId, u32)>);

impl WedgeVertices {
    /// Collects the wedges of the base, which is a valid mesh.
    fn new(read: &Progressive) -> Self {
        let wedges = read.mesh.attributes.as_ref().map_or(0, |a| a.wedge_count);
        let mut this = Self(vec![(VertexId(0), 0); wedges]);
        for face in (0..read.alive.len()).filter(|&face| read.alive[face]) {
            for slot in 0..3 {
                // A valid mesh has no conflict.
                let _ = this.enter(read, face, slot);
            }
        }
        this
    }

    /// Applies a split that passed the checks.
    fn refine(&mut self, read: &mut Progressive, index: usize) -> Result<(), &'static str> {
        let corners = read.splits.moved_range(index);
        for i in corners.clone() {
            let corner = read.splits.moved[i];
            if let Some(wedge) = wedge(read, corner.face().index(), corner.slot()) {
                self.0[wedge.index()].1 -= 1;
            }
        }
        read.refine();
        for i in corners {
            let corner = read.splits.moved[i];
            self.enter(read, corner.face().index(), corner.slot())?;
        }
        for i in read.splits.removed_range(index) {
            let face = read.splits.removed_faces[i].index();
            (0..3).try_for_each(|slot| self.enter(read, face, slot))?;
        }
        Ok(())
    }

    fn enter(&mut self, read: &Progressive, face: usize, slot: usize) -> Result<(), &'static str> {
        let Some(wedge) = wedge(read, face, slot) else { return Ok(()) };
        let vertex = read.mesh.faces[face][slot];
        let (owner, uses) = &mut self.0[wedge.index()];
        if *uses == 0 {
            *owner = vertex;
        }
        *uses += 1;
        if *owner == vertex { Ok(()) } else { Err("a wedge would be at two vertices") }
    }
}

fn wedge(read: &Progressive, face: usize, slot: usize) -> Option<WedgeId> {
    read.mesh.attributes.as_ref().map(|attributes| attributes.corners[face][slot])
}
