//! Vertices that rounding puts at one place.

use meshlod_codec::Malformed;
use meshlod_io::Note;
use meshlod_mesh::Mesh;
use rayon::prelude::*;

use crate::jobs::JobError;

/// Notes the vertices of a mesh that decode to the place of another one.
pub(super) fn shared_places(
    mesh: &Mesh,
    decoded: Result<Mesh, Malformed>,
) -> Result<Note, JobError> {
    let decoded = decoded.map_err(JobError::output)?;
    let lost = places(mesh).saturating_sub(places(&decoded));
    Ok(Note::changed(
        lost,
        "vertex moved to the place of another",
        "vertices moved to the places of others",
    )
    .remedied("more bits keep them apart"))
}

/// Returns the number of different places of the vertices that faces use.
fn places(mesh: &Mesh) -> usize {
    let used = mesh.used_vertices();
    let places = mesh.positions.par_iter().zip(&used).filter(|(_, used)| **used);
    // Adding 0 makes -0 the same place.
    let mut places: Vec<_> = places.map(|(at, _)| at.map(|x| (x + 0.0).to_bits())).collect();
    places.par_sort_unstable();
    places.dedup();
    places.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_in_one_cell_are_counted() {
        let mesh = meshlod_fixtures::tetrahedron();
        let mut rounded = mesh.clone();
        rounded.positions[1] = rounded.positions[0];
        let note = |decoded: &Mesh| shared_places(&mesh, Ok(decoded.clone())).unwrap();
        assert_eq!([note(&mesh).count, note(&rounded).count], [0, 1]);
    }
}
