//! Measures the time of mesh checks, for meshes of a hundred thousand to four million faces.

use anyhow::Result;
use meshlod::check::{BroadPhase, CheckOptions, Kind, Kinds, findings};
use meshlod::mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};

use crate::lab::table::Table;
use crate::{least_seconds, one_core};

const ROUNDS: usize = 5;
/// Mesh files, and the number of 1:4 subdivisions.
const MESHES: [(&str, usize); 5] =
    [("horse-97k.ply", 0), ("igea.ply", 0), ("dragon.ply", 0), ("igea.ply", 1), ("igea.ply", 2)];

/// Returns a table of seconds per million faces, by the kinds of findings checked for.
pub fn section() -> Result<String> {
    let of_pairs = [Kind::SelfIntersection, Kind::Contact, Kind::Crowded];
    let meeting = of_pairs.into_iter().fold(Kinds::NONE, Kinds::with);
    let other = of_pairs.into_iter().fold(Kinds::ALL, Kinds::without);
    let columns = [
        (Kinds::ALL, BroadPhase::Tree),
        (other, BroadPhase::Tree),
        (meeting, BroadPhase::Tree),
        (meeting, BroadPhase::Octree),
    ];
    let mut table = Table::new([
        "mesh, s per million faces",
        "faces",
        "all kinds",
        "all but intersections",
        "intersections, by tree",
        "intersections, by octree",
    ]);
    for (file, times) in MESHES {
        let Some(mut mesh) = crate::read(file)? else { continue };
        for _ in 0..times {
            mesh = subdivided(&mesh);
        }
        let faces = mesh.faces.len();
        let name =
            if times == 0 { file.to_owned() } else { format!("{file} × {}", 1 << (2 * times)) };
        let mut row = vec![name, faces.to_string()];
        for (kinds, broad_phase) in columns {
            let options = CheckOptions { kinds, broad_phase, ..CheckOptions::default() };
            // The octree takes nine times as long, so one round must do.
            let rounds = if broad_phase == BroadPhase::Octree { 1 } else { ROUNDS };
            let seconds = one_core(|| least_seconds(rounds, || findings(&mesh, &options)));
            row.push(format!("{:.3}", seconds / faces as f64 * 1e6));
        }
        table.row(row);
    }
    Ok(format!(
        "CPU time on one core, the best of {ROUNDS} rounds (one round by octree); file input and output are \
         excluded, everything derived from the faces is included. As published, not run here: CGAL's \
         self-intersection test takes 1.72 s per million faces (CGAL/cgal pull request 4344, 2019). \
         To reproduce: `cargo xtask results check`.\n\n{}",
        table.markdown()
    ))
}

/// Subdivides each face into four at the edge midpoints, keeping the order of faces.
fn subdivided(mesh: &Mesh) -> Mesh {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let mut positions = mesh.positions.clone();
    let mut middles = vec![None; 3 * mesh.faces.len()];
    let mut faces = Vec::with_capacity(4 * mesh.faces.len());
    for (f, &[a, b, c]) in mesh.faces.iter().enumerate() {
        let [ab, bc, ca] = std::array::from_fn(|k| {
            let side = Side::new(FaceId::new(f), k);
            let middle = *middles[3 * f + k].get_or_insert_with(|| {
                let [p, q] = side.ends(&mesh.faces).map(|v| mesh.positions[v.index()]);
                positions.push(std::array::from_fn(|axis| (p[axis] + q[axis]) / 2.0));
                VertexId::new(positions.len() - 1)
            });
            if let Twin::Side(twin) = connectivity.twin(side) {
                middles[3 * twin.face().index() + twin.corner()] = Some(middle);
            }
            middle
        });
        faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh::new(positions, faces)
}

#[cfg(test)]
mod tests {
    use meshlod::samples;

    use super::*;

    #[test]
    fn a_closed_mesh_in_four_is_closed_and_as_connected() {
        let mesh = subdivided(&samples::torus(200));
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        assert_eq!(mesh.faces.len(), 4 * samples::torus(200).faces.len());
        assert!(connectivity.is_closed() && connectivity.inconsistent_edges() == 0);
        assert_eq!(mesh.positions.len() + mesh.faces.len(), connectivity.edge_count());
    }
}
