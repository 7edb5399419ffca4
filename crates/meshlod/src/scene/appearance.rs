//! Colours and normals with which a mesh is drawn, chosen by what its file holds.

use meshlod_io::{Material, Scene, SceneMesh};
use meshlod_mesh::{LayerKind, Mesh};
use meshlod_picture::{Materials, Normals, Paint};

/// Source of the colours of a surface, an owned [`Paint`].
#[derive(Clone, Debug)]
pub enum OwnedPaint {
    /// One sRGB colour.
    Plain([u8; 3]),
    /// Colours of the vertices or faces of the mesh.
    Colors,
    /// Materials with their textures.
    Materials(Materials),
    /// Checkerboard in texture coordinates.
    Checker {
        /// Number of squares per unit of the texture coordinates.
        squares: u32,
    },
}

/// Dihedral angle, in radians, above which edges are sharp if a file has no normals.
const CREASE_RAD: f64 = 1.0;

impl OwnedPaint {
    /// Light colour on which lines are visible, for a mesh without colours of its own.
    pub const CLAY: Self = Self::Plain([226, 208, 186]);

    /// Returns the colouring that shows a scene as its author meant it; `materials` are those of
    /// the scene, see [`materials_of`](crate::scene::materials_of).
    pub fn of(scene: &Scene, materials: Materials) -> Self {
        let white = |material: &Material| material.base_color[..3] == [1.0; 3];
        let colors = |mesh: &SceneMesh| has(&mesh.mesh, LayerKind::Color(0));
        if !materials.textures.is_empty() || !scene.materials.iter().all(white) {
            Self::Materials(materials)
        } else if scene.meshes.iter().any(colors) {
            Self::Colors
        } else {
            Self::CLAY
        }
    }

    /// Returns the colouring in which a mesh is compared with its levels, by eye and by image
    /// error; see [`Paint::comparison`].
    pub fn comparison(mesh: &Mesh, materials: Materials) -> Self {
        match Paint::comparison(mesh, &materials) {
            Paint::Materials(_) => Self::Materials(materials),
            Paint::Checker { squares } => Self::Checker { squares },
            Paint::Colors => Self::Colors,
            Paint::Plain(color) => Self::Plain(color),
            // A file never comes with values or face colours.
            Paint::FaceColors(_) | Paint::FaceValues(_) | Paint::VertexValues(_) => Self::CLAY,
        }
    }

    /// Returns the paint, borrowed.
    pub fn as_paint(&self) -> Paint<'_> {
        match self {
            Self::Plain(color) => Paint::Plain(*color),
            Self::Colors => Paint::Colors,
            Self::Materials(materials) => Paint::Materials(materials),
            Self::Checker { squares } => Paint::Checker { squares: *squares },
        }
    }

    /// Returns the number of textures used.
    pub fn textures(&self) -> usize {
        match self {
            Self::Materials(materials) => materials.textures.len(),
            _ => 0,
        }
    }
}

/// Returns the mesh's own normals if it has any, otherwise computed ones with creases.
pub fn normals_of(mesh: &Mesh) -> Normals {
    match has(mesh, LayerKind::Normal) {
        true => Normals::FromMesh,
        false => Normals::Creased { crease_rad: CREASE_RAD },
    }
}

fn has(mesh: &Mesh, kind: LayerKind) -> bool {
    mesh.attributes.as_ref().is_some_and(|all| all.layer(kind).is_some())
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;
    use crate::scene::materials_of;

    #[test]
    fn uvs_without_a_texture_are_compared_under_a_checker_whatever_the_colours() {
        let mesh = samples::fish(500);
        let mut scene = Scene::from_mesh("fish", mesh.clone());
        let red = [1.0, 0.0, 0.0, 1.0];
        scene.materials = vec![Material { base_color: red, ..Default::default() }];
        let materials = || materials_of(&scene).0;
        assert!(matches!(OwnedPaint::comparison(&mesh, materials()), OwnedPaint::Checker { .. }));
        assert!(matches!(OwnedPaint::of(&scene, materials()), OwnedPaint::Materials(_)));
    }
}
