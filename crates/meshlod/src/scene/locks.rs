//! Vertex locks of a whole scene, whose vertices are numbered mesh after mesh.

use meshlod_io::Scene;
use meshlod_mesh::{Lock, Locks, VertexId};
use meshlod_simplify::SimplifyError;

/// Joins the vertex locks of the meshes of a scene into one list, as
/// [`SceneSimplifier`](crate::scene::SceneSimplifier) takes it.
///
/// Meshes at the end may be left out and are free. Tied vertices at different positions are locked
/// instead: a transform can move them together in world space although they are apart in their
/// mesh.
///
/// # Errors
/// Locks that do not match their mesh.
pub fn join_locks(scene: &Scene, of_meshes: &[Locks]) -> Result<Locks, SimplifyError> {
    let mut all = Locks::default();
    if of_meshes.iter().all(|own| *own == Locks::default()) {
        return Ok(all);
    }
    for (i, mesh) in scene.meshes.iter().enumerate() {
        let (start, positions) = (all.of_vertex.len(), &mesh.mesh.positions);
        all.of_vertex.resize(start + positions.len(), Lock::Free);
        let Some(own) = of_meshes.get(i) else { continue };
        let (found, expected) = (own.of_vertex.len(), positions.len());
        if found != 0 && found != expected {
            return Err(SimplifyError::LockCount { found, expected });
        }
        all.of_vertex[start..start + found].copy_from_slice(&own.of_vertex);
        for (tie, members) in own.ties.iter().enumerate() {
            if let Some(&vertex) = members.iter().find(|v| v.index() >= expected) {
                return Err(SimplifyError::BadTie { tie, vertex, count: expected });
            }
            let place = |v: VertexId| positions[v.index()];
            let moved = members.iter().map(|v| VertexId::new(start + v.index()));
            if members.iter().all(|&v| place(v) == place(members[0])) {
                all.ties.push(moved.collect());
            } else {
                moved.for_each(|v| all.of_vertex[v.index()] = Lock::Locked);
            }
        }
    }
    Ok(all)
}

/// Splits the vertex locks of a scene into one list for each mesh.
pub(crate) fn split(scene: &Scene, all: &Locks) -> Result<Vec<Locks>, SimplifyError> {
    let starts = starts(scene.meshes.iter().map(|mesh| mesh.mesh.positions.len()));
    let (found, expected) = (all.of_vertex.len(), starts[scene.meshes.len()]);
    if found != 0 && found != expected {
        return Err(SimplifyError::LockCount { found, expected });
    }
    let mut of_meshes = vec![Locks::default(); scene.meshes.len()];
    if *all == Locks::default() {
        return Ok(of_meshes);
    }
    let mut of_vertex = all.of_vertex.clone();
    of_vertex.resize(expected, Lock::Free);
    for (tie, members) in all.ties.iter().enumerate() {
        if let Some(&vertex) = members.iter().find(|v| v.index() >= expected) {
            return Err(SimplifyError::BadTie { tie, vertex, count: expected });
        }
        let Some(mesh) = members.first().map(|&v| owner(&starts, v)) else { continue };
        if members.iter().all(|&v| owner(&starts, v) == mesh) {
            let own = |v: &VertexId| VertexId::new(v.index() - starts[mesh]);
            of_meshes[mesh].ties.push(members.iter().map(own).collect());
        } else {
            members.iter().for_each(|v| of_vertex[v.index()] = Lock::Locked);
        }
    }
    for (own, range) in of_meshes.iter_mut().zip(starts.windows(2)) {
        own.of_vertex = of_vertex[range[0]..range[1]].to_vec();
    }
    Ok(of_meshes)
}

/// Returns the start of each of some consecutive runs, and the end of the last.
fn starts(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let ends = counts.scan(0, |end, count| {
        *end += count;
        Some(*end)
    });
    std::iter::once(0).chain(ends).collect()
}

/// Returns the run that a vertex is in.
fn owner(starts: &[usize], v: VertexId) -> usize {
    starts.partition_point(|&start| start <= v.index()) - 1
}

#[cfg(test)]
mod tests {
    use meshlod_io::SceneMesh;
    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;

    use super::*;

    /// A scene of two meshes and a bare one between them; two vertices of the last are at one
    /// place.
    fn scene() -> Scene {
        let mut pinched = samples::sphere(100);
        pinched.positions[5] = pinched.positions[3];
        let meshes = [samples::torus(100), Mesh::default(), pinched];
        let meshes = meshes.map(|mesh| SceneMesh { mesh, ..SceneMesh::default() }).to_vec();
        Scene { meshes, ..Scene::default() }
    }

    #[test]
    fn locks_joined_and_split_are_what_they_were() {
        let scene = scene();
        let count = |mesh: usize| scene.meshes[mesh].mesh.positions.len();
        let first = Locks { of_vertex: vec![Lock::Protected; count(0)], ties: Vec::new() };
        let last = Locks { of_vertex: Vec::new(), ties: vec![[3, 5].map(VertexId).to_vec()] };
        let all = join_locks(&scene, &[first.clone(), Locks::default(), last.clone()]).unwrap();
        assert_eq!(all.of_vertex.len(), count(0) + count(2));
        let split = split(&scene, &all).unwrap();
        assert_eq!((&split[0], &split[2].ties), (&first, &last.ties));
        assert_eq!(split[2].of_vertex, vec![Lock::Free; count(2)]);
        assert_eq!(join_locks(&scene, &split), Ok(all));
        assert_eq!(join_locks(&scene, &[Locks::default()]), Ok(Locks::default()));
    }

    #[test]
    fn what_is_apart_in_its_mesh_is_not_tied() {
        let scene = scene();
        let ties = vec![[1, 2].map(VertexId).to_vec()];
        let all = join_locks(&scene, &[Locks { ties, ..Locks::default() }]).unwrap();
        assert!(all.ties.is_empty());
        let [free, locked] = [Lock::Free, Lock::Locked];
        assert_eq!(all.of_vertex[..4], [free, locked, locked, free]);
    }

    #[test]
    fn ties_across_meshes_are_locks() {
        let scene = scene();
        let torus = scene.meshes[0].mesh.positions.len();
        let ties = vec![[4, torus + 6].map(VertexId::new).to_vec()];
        let split = split(&scene, &Locks { ties, ..Locks::default() }).unwrap();
        assert_eq!((split[0].of_vertex[4], split[2].of_vertex[6]), (Lock::Locked, Lock::Locked));
        assert!(split.iter().all(|own| own.ties.is_empty()));
    }

    #[test]
    fn locks_of_another_scene_are_refused() {
        let scene = scene();
        let wrong = Locks { of_vertex: vec![Lock::Free; 3], ..Locks::default() };
        assert!(split(&scene, &wrong).is_err() && join_locks(&scene, &[wrong]).is_err());
        let wrong = Locks { ties: vec![vec![VertexId(9999)]], ..Locks::default() };
        assert!(split(&scene, &wrong).is_err() && join_locks(&scene, &[wrong]).is_err());
    }
}
