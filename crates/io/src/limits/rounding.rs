//! Rounding of coordinates by a format.

use meshlod_mesh::Mesh;

use crate::format::Format;
use crate::format::facts::Coordinates;
use crate::gltf::write::new_document::local_space::to_local;
use crate::notes::Note;
use crate::precision::{Precision, fits_f32, rounding};
use crate::scene::Scene;

impl Scene {
    /// Returns the largest change of a coordinate when the scene is written in a format and read
    /// back, in model units; infinite for a coordinate that cannot be written.
    pub fn rounding(&self, format: Format, precision: Precision) -> f64 {
        let precision = precision.of(self.meshes.iter().map(|mesh| &mesh.mesh));
        let of_mesh = |mesh: &Mesh| self.mesh_rounding(mesh, format, precision);
        self.meshes.iter().map(|mesh| of_mesh(&mesh.mesh)).fold(0.0, f64::max)
    }

    /// Returns the largest change of a coordinate of one mesh of the scene, see
    /// [`Scene::rounding`].
    pub fn mesh_rounding(&self, mesh: &Mesh, format: Format, precision: Precision) -> f64 {
        match (self.coordinates(format), precision) {
            (Coordinates::Binary32, _) if format.is_gltf() => self.gltf_rounding(mesh),
            (Coordinates::Binary32, _) | (Coordinates::Binary, Precision::F32) => rounding(mesh),
            (_, Precision::F64) => 0.0,
            // The shortest decimal of an `f32` usually parses to a different `f64`.
            (_, Precision::F32 | Precision::Auto) => {
                let read = |x: f64| (x as f32).to_string().parse().unwrap_or(f64::INFINITY);
                let coordinates = mesh.positions.as_flattened().iter();
                coordinates.map(|&x: &f64| (read(x) - x).abs()).fold(0.0, f64::max)
            }
        }
    }

    fn gltf_rounding(&self, mesh: &Mesh) -> f64 {
        if self.source.is_some() || fits_f32(mesh) {
            return rounding(mesh);
        }
        let mut local = Mesh::new(mesh.positions.clone(), mesh.faces.clone());
        to_local(&mut local);
        rounding(&local)
    }

    /// Notes the vertices that a requested precision rounds although the format could store them
    /// exactly, if rounding changes the shape.
    pub fn precision_limits(&self, format: Format, precision: Precision) -> Option<Note> {
        let has_both = self.coordinates(format) != Coordinates::Binary32;
        if precision != Precision::F32 || !has_both {
            return None;
        }
        let (most, count) = changes(&self.shown_mesh())?;
        let why = format!(" by up to {most:.1e}");
        let note = Note::changed(count, "vertex rounded", "vertices rounded").detailed(&why);
        Some(note.remedied("--precision auto or f64 keeps them"))
    }

    /// Returns the largest change of a coordinate and the number of rounded vertices, if the format
    /// has only 32 bits and they change the shape.
    pub(crate) fn unavoidable_rounding(&self, format: Format) -> Option<(f64, usize)> {
        if self.coordinates(format) != Coordinates::Binary32 {
            return None;
        }
        if !format.is_gltf() {
            return changes(&self.shown_mesh());
        }
        let of_mesh = |mesh: &Mesh| {
            if self.source.is_some() || fits_f32(mesh) {
                return changes(mesh);
            }
            let mut local = Mesh::new(mesh.positions.clone(), mesh.faces.clone());
            to_local(&mut local);
            changes(&local)
        };
        let all = self.meshes.iter().filter_map(|mesh| of_mesh(&mesh.mesh));
        all.reduce(|(a, n), (b, m)| (a.max(b), n + m))
    }

    /// Returns the number type of the coordinates of this scene in a format.
    fn coordinates(&self, format: Format) -> Coordinates {
        match self.is_written_as_solids(format) {
            true => Coordinates::Decimal,
            false => format.stores().coordinates,
        }
    }
}

/// Returns the largest change of a coordinate and the number of rounded vertices, if 32 bits change
/// the shape of a mesh.
fn changes(mesh: &Mesh) -> Option<(f64, usize)> {
    let is_inexact = |p: &&[f64; 3]| p.iter().any(|&x| f64::from(x as f32) != x);
    let count = mesh.positions.iter().filter(is_inexact).count();
    (!fits_f32(mesh)).then(|| (rounding(mesh), count))
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::grid;

    use super::*;

    fn at(mut mesh: Mesh, scale: f64, offset: [f64; 3]) -> Mesh {
        for position in &mut mesh.positions {
            *position = [0, 1, 2].map(|i| position[i] * scale + offset[i]);
        }
        mesh
    }

    #[test]
    fn rounding_that_was_asked_for_is_noted_where_it_changes_the_shape() {
        let note = |scale, format, precision| {
            let scene = Scene::from_mesh("", at(grid(3), scale, [500_000.0, 5_400_000.0, 100.0]));
            scene.precision_limits(format, precision).map(|note| note.to_string())
        };
        let text = note(0.013, Format::Ply, Precision::F32).unwrap();
        assert!(text.contains("vertices rounded by up to 3.9e-2"), "{text}");
        assert_eq!(note(0.013, Format::Ply, Precision::Auto), None);
        assert_eq!(note(0.013, Format::Glb, Precision::F32), None);
        assert_eq!(note(0.5, Format::Ply, Precision::F32), None);
    }
}
