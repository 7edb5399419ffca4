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
    Checker,
}

/// Squares of the checkerboard along a unit of uv.
const SQUARES: u32 = 16;

/// Edges that bend by more than this, in radians, are sharp where a file has no normals.
const CREASE_RAD: f64 = 1.0;

/// Light, to see lines on.
const CLAY: Coat = Coat::Plain([226, 208, 186]);

impl Coat {
    /// Of all that a scene shows; images that cannot be read are named `of` the file.
    pub fn of(scene: &Scene, of: &std::path::Path, session: &Session) -> Self {
        let (materials, unread) = materials_of(scene);
        for image in unread {
            let reason = format_args!("image {}: {}", image.name, image.reason);
            session.warn(Failure::at(of, reason));
        }
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

    /// Itself, or a checkerboard where a mesh has uvs and nothing to see them by.
    pub fn or_checker(self, mesh: &Mesh) -> Self {
        match self {
            Self::Plain(_) if has(mesh, LayerKind::Uv(0)) => Self::Checker,
            coat => coat,
        }
    }

    pub fn paint(&self) -> Paint<'_> {
        match self {
            Self::Plain(color) => Paint::Plain(*color),
            Self::Colors => Paint::Colors,
            Self::Materials(materials) => Paint::Materials(materials),
            Self::Checker => Paint::Checker { squares: SQUARES },
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
