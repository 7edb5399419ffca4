//! Locks of a scene: vertices are counted through all its meshes, mesh after mesh.

use meshlod_io::Scene;
use meshlod_mesh::{Lock, Locks, VertexId};
use meshlod_simplify::SimplifyError;

/// The locks of all meshes of a scene as [`SceneSimplifier`](crate::SceneSimplifier) takes them, of
/// those of each. Meshes at the end may be left out: nothing of them is locked.
///
/// Where locks of a mesh have fewer vertices than it has, the rest are free.
pub fn join_locks(scene: &Scene, of_meshes: &[Locks]) -> Locks {
    let mut all = Locks::default();
    if of_meshes.iter().all(|own| *own == Locks::default()) {
        return all;
    }
    for (i, mesh) in scene.meshes.iter().enumerate() {
        let start = all.of_vertex.len();
        if let Some(own) = of_meshes.get(i) {
            all.of_vertex.extend(&own.of_vertex);
            let moved = |v: &VertexId| VertexId::new(start + v.index());
            all.ties.extend(own.ties.iter().map(|tie| tie.iter().map(moved).collect::<Vec<_>>()));
        }
        all.of_vertex.resize(start + mesh.mesh.positions.len(), Lock::Free);
    }
    all
}

/// The locks of each mesh among those of all.
pub(crate) fn split(scene: &Scene, all: &Locks) -> Result<Vec<Locks>, SimplifyError> {
    let counts = scene.meshes.iter().map(|mesh| mesh.mesh.positions.len());
    let starts: Vec<usize> = counts
        .scan(0, |end, count| {
            *end += count;
            Some(*end - count)
        })
        .collect();
    let expected = scene.meshes.iter().map(|mesh| mesh.mesh.positions.len()).sum();
    let mut of_vertex = all.of_vertex.clone();
    if of_vertex.is_empty() && !all.ties.is_empty() {
        of_vertex.resize(expected, Lock::Free);
    }
    if !of_vertex.is_empty() && of_vertex.len() != expected {
        return Err(SimplifyError::BadMask { found: of_vertex.len(), expected });
    }
    let mut of_meshes = vec![Locks::default(); scene.meshes.len()];
    for (tie, members) in all.ties.iter().enumerate() {
        if let Some(&vertex) = members.iter().find(|v| v.index() >= expected) {
            return Err(SimplifyError::BadTie { tie, vertex, count: expected });
        }
        let mesh_of = |v: &VertexId| starts.partition_point(|&start| start <= v.index()) - 1;
        let Some(mesh) = members.first().map(mesh_of) else { continue };
        if members.iter().all(|v| mesh_of(v) == mesh) {
            let own = |v: &VertexId| VertexId::new(v.index() - starts[mesh]);
            of_meshes[mesh].ties.push(members.iter().map(own).collect());
        } else {
            members.iter().for_each(|v| of_vertex[v.index()] = Lock::Locked);
        }
    }
    if of_vertex.contains(&Lock::Locked) || of_vertex.contains(&Lock::Protected) {
        for ((mesh, own), &start) in scene.meshes.iter().zip(&mut of_meshes).zip(&starts) {
            own.of_vertex = of_vertex[start..start + mesh.mesh.positions.len()].to_vec();
        }
    }
    Ok(of_meshes)
}
