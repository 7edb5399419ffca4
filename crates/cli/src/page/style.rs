//! Drawing style of a mesh, chosen by its attributes and materials.

use meshlod::picture::{Materials, Normals, Style, Wireframe};
use meshlod::scene::materials_of;
pub use meshlod::scene::{OwnedPaint, normals_of};
use meshlod::{Mesh, Scene};

use crate::session::Session;
use crate::session::failure::Failure;

/// Drawing style of a mesh and its simplified levels.
#[derive(Clone, Debug)]
pub struct SubjectStyle {
    pub paint: OwnedPaint,
    pub normals: Normals,
    /// Whether each material is single-sided; see [`Style::single_sided`].
    pub single_sided: Vec<bool>,
    /// Colouring of the surface under the wireframe.
    pub wire_paint: OwnedPaint,
    pub wireframe: Wireframe,
    /// Viewing direction of the pictures.
    pub direction: [f64; 3],
    pub up: [f64; 3],
}

impl SubjectStyle {
    /// Returns the drawing style of a mesh: with `paint`, in the colour of clay under the wireframe,
    /// and from both sides.
    pub fn new(paint: OwnedPaint, mesh: &Mesh, direction: [f64; 3], up: [f64; 3]) -> Self {
        Self {
            paint,
            normals: normals_of(mesh),
            single_sided: Vec::new(),
            wire_paint: OwnedPaint::CLAY,
            wireframe: Wireframe { width_px: 0.9, ..Wireframe::default() },
            direction,
            up,
        }
    }

    /// Returns the drawing style for shaded pictures.
    pub fn shaded(&self) -> Style<'_> {
        Style {
            paint: self.paint.as_paint(),
            normals: self.normals,
            single_sided: &self.single_sided,
            ..Style::default()
        }
    }

    /// Returns the drawing style for pictures with a wireframe.
    pub fn wired(&self) -> Style<'_> {
        Style {
            paint: self.wire_paint.as_paint(),
            normals: Normals::Flat,
            single_sided: &self.single_sided,
            wireframe: Some(self.wireframe),
            ..Style::default()
        }
    }
}

/// Returns the materials of a scene, with a warning for each image of the file that cannot be
/// drawn, or only smaller than it is.
pub fn materials(scene: &Scene, of: &std::path::Path, session: &Session) -> Materials {
    let (materials, warnings) = materials_of(scene);
    for image in warnings {
        let reason = format_args!("image {}: {}", image.name, image.reason);
        session.warn(Failure::at(of, reason));
    }
    materials
}
