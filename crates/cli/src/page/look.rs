//! How a mesh looks best: by what came with it.

use meshlod::mesh::LayerKind;
use meshlod::picture::{Materials, Normals, Paint, Style, Wireframe};
use meshlod::{Mesh, Scene, materials_of};

use crate::failure::Failure;
use crate::session::Session;

/// What a mesh and its levels are drawn with.
#[derive(Clone, Debug)]
pub struct Look {
    pub coat: Coat,
    pub normals: Normals,
    /// What is below the lines where edges are drawn.
    pub under_lines: Coat,
    pub lines: Wireframe,
    /// Where to look.
    pub direction: [f64; 3],
    pub up: [f64; 3],
}

/// Where the colours come from.
#[derive(Clone, Debug)]
pub enum Coat {
    Plain([u8; 3]),
    /// Of vertices or faces.
    Colors,
    Materials(Materials),
    /// Over the uvs.
    Checker {
        /// Along a unit of uv.
        squares: u32,
    },
}

/// Edges that bend by more than this, in radians, are sharp where a file has no normals.
const CREASE_RAD: f64 = 1.0;

/// Light, to see lines on.
const CLAY: Coat = Coat::Plain([226, 208, 186]);

impl Coat {
    /// Of all that a scene shows, as it is meant to look; `materials` are the scene's.
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

    /// That in which a mesh is compared with its levels, by the eye as by the image error; see
    /// [`Paint::comparison`].
    pub fn comparison(mesh: &Mesh, materials: Materials) -> Self {
        match Paint::comparison(mesh, &materials) {
            Paint::Materials(_) => Self::Materials(materials),
            Paint::Checker { squares } => Self::Checker { squares },
            Paint::Colors => Self::Colors,
            Paint::Plain(color) => Self::Plain(color),
            // Values and colours of faces are never what a file came with.
            Paint::FaceColors(_) | Paint::FaceValues(_) | Paint::VertexValues(_) => CLAY,
        }
    }

    pub fn paint(&self) -> Paint<'_> {
        match self {
            Self::Plain(color) => Paint::Plain(*color),
            Self::Colors => Paint::Colors,
            Self::Materials(materials) => Paint::Materials(materials),
            Self::Checker { squares } => Paint::Checker { squares: *squares },
        }
    }

    /// How many images it needs.
    pub fn textures(&self) -> usize {
        match self {
            Self::Materials(materials) => materials.textures.len(),
            _ => 0,
        }
    }
}

impl Look {
    /// Of a file: as it is, and in clay where its edges are drawn.
    pub fn new(coat: Coat, mesh: &Mesh, direction: [f64; 3], up: [f64; 3]) -> Self {
        Self {
            coat,
            normals: normals_of(mesh),
            under_lines: CLAY,
            lines: Wireframe { width_px: 0.9, ..Wireframe::default() },
            direction,
            up,
        }
    }

    /// As it is.
    pub fn shaded(&self) -> Style<'_> {
        Style { paint: self.coat.paint(), normals: self.normals, ..Style::default() }
    }

    /// With every face shown.
    pub fn wired(&self) -> Style<'_> {
        Style {
            paint: self.under_lines.paint(),
            normals: Normals::Flat,
            wireframe: Some(self.lines),
            ..Style::default()
        }
    }
}

/// The materials of a scene; images that cannot be read are named `of` the file.
pub fn materials(scene: &Scene, of: &std::path::Path, session: &Session) -> Materials {
    let (materials, unread) = materials_of(scene);
    for image in unread {
        let reason = format_args!("image {}: {}", image.name, image.reason);
        session.warn(Failure::at(of, reason));
    }
    materials
}

/// The normals that came with it, or creases where it bends sharply.
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
        assert!(matches!(Coat::comparison(&mesh, materials()), Coat::Checker { .. }));
        assert!(matches!(Coat::of(&scene, materials()), Coat::Materials(_)));
    }
}
