//! Drawing style of a mesh, chosen by its attributes and materials.

use meshlod::mesh::LayerKind;
use meshlod::picture::{Materials, Normals, Paint, Style, Wireframe};
use meshlod::{Mesh, Scene, materials_of};

use crate::failure::Failure;
use crate::session::Session;

/// Drawing style of a mesh and its simplified levels.
#[derive(Clone, Debug)]
pub struct SubjectStyle {
    pub paint: OwnedPaint,
    pub normals: Normals,
    /// Colouring of the surface under the wireframe.
    pub wire_paint: OwnedPaint,
    pub wireframe: Wireframe,
    /// Viewing direction of the pictures.
    pub direction: [f64; 3],
    pub up: [f64; 3],
}

/// Source of the colours of a surface, an owned [`Paint`].
#[derive(Clone, Debug)]
pub enum OwnedPaint {
    Plain([u8; 3]),
    /// Colours of the vertices or faces of the mesh.
    Colors,
    Materials(Materials),
    /// Checkerboard in texture coordinates.
    Checker {
        /// Number of squares per unit of the texture coordinates.
        squares: u32,
    },
}

/// Dihedral angle, in radians, above which edges are sharp if a file has no normals.
const CREASE_RAD: f64 = 1.0;

/// Light colour on which lines are visible.
const CLAY: OwnedPaint = OwnedPaint::Plain([226, 208, 186]);

impl OwnedPaint {
    /// Returns the colouring that shows a scene as its author meant it; `materials` are those of
    /// the scene.
    pub fn of(scene: &Scene, materials: Materials) -> Self {
        let white = |material: &meshlod::io::Material| material.base_color[..3] == [1.0; 3];
        let colors = |mesh: &meshlod::io::SceneMesh| has(&mesh.mesh, LayerKind::Color(0));
        if !materials.textures.is_empty() || !scene.materials.iter().all(white) {
            Self::Materials(materials)
        } else if scene.meshes.iter().any(colors) {
            Self::Colors
        } else {
            CLAY
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
            Paint::FaceColors(_) | Paint::FaceValues(_) | Paint::VertexValues(_) => CLAY,
        }
    }

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

impl SubjectStyle {
    /// Returns the drawing style of a mesh: with `paint`, and in the colour of clay under the
    /// wireframe.
    pub fn new(paint: OwnedPaint, mesh: &Mesh, direction: [f64; 3], up: [f64; 3]) -> Self {
        Self {
            paint,
            normals: normals_of(mesh),
            wire_paint: CLAY,
            wireframe: Wireframe { width_px: 0.9, ..Wireframe::default() },
            direction,
            up,
        }
    }

    /// Returns the drawing style for shaded pictures.
    pub fn shaded(&self) -> Style<'_> {
        Style { paint: self.paint.as_paint(), normals: self.normals, ..Style::default() }
    }

    /// Returns the drawing style for pictures with a wireframe.
    pub fn wired(&self) -> Style<'_> {
        Style {
            paint: self.wire_paint.as_paint(),
            normals: Normals::Flat,
            wireframe: Some(self.wireframe),
            ..Style::default()
        }
    }
}

/// Returns the materials of a scene, with a warning for each image of the file that cannot be read.
pub fn materials(scene: &Scene, of: &std::path::Path, session: &Session) -> Materials {
    let (materials, unread) = materials_of(scene);
    for image in unread {
        let reason = format_args!("image {}: {}", image.name, image.reason);
        session.warn(Failure::at(of, reason));
    }
    materials
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
    use meshlod::samples;

    use super::*;

    #[test]
    fn uvs_without_a_texture_are_compared_under_a_checker_whatever_the_colours() {
        let mesh = samples::fish(500);
        let mut scene = Scene::from_mesh("fish", mesh.clone());
        let red = [1.0, 0.0, 0.0, 1.0];
        scene.materials = vec![meshlod::io::Material { base_color: red, ..Default::default() }];
        let materials = || materials_of(&scene).0;
        assert!(matches!(OwnedPaint::comparison(&mesh, materials()), OwnedPaint::Checker { .. }));
        assert!(matches!(OwnedPaint::of(&scene, materials()), OwnedPaint::Materials(_)));
    }
}
