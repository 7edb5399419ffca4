//! Display of a stage: shading, colours, background.

use meshlod::picture::{BackFaces, Background, Lighting, Wireframe};
use serde::{Deserialize, Serialize};

use crate::Shade;
use crate::placement::CLAY;

/// How the subjects of a stage are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Display {
    /// Shading of the surface.
    pub shading: Shading,
    /// Colours of the surface.
    pub coloring: Coloring,
    /// Draw the edges of all faces.
    pub wireframe: bool,
    /// Tint faces that are seen from behind.
    pub back_faces: bool,
    /// Draw a soft shadow on the ground.
    pub ground: bool,
    /// Use a dark background in place of the light one of pictures.
    pub is_dark: bool,
}

/// Shading of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shading {
    /// Normals of the vertices.
    #[default]
    Smooth,
    /// One normal per face.
    Flat,
}

/// Source of the colours of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Coloring {
    /// Materials, textures or vertex colours of the file, or the colour of clay.
    #[default]
    Own,
    /// The colour of clay.
    Clay,
    /// Checkerboard in texture coordinates.
    Checker,
    /// One colour for each object.
    Objects,
    /// One colour for each material.
    Materials,
    /// Distance from the original, for subjects that were compared with it.
    Heat,
    /// One colour for each triangle strip.
    Strips,
    /// One colour for each part or block of compressed geometry.
    Parts,
}

impl Coloring {
    /// All colourings, in the order in which menus list them.
    pub const ALL: [Self; 8] = [
        Self::Own,
        Self::Clay,
        Self::Checker,
        Self::Objects,
        Self::Materials,
        Self::Heat,
        Self::Strips,
        Self::Parts,
    ];

    /// Returns the name that menus show.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "File colours",
            Self::Clay => "Clay",
            Self::Checker => "UV checker",
            Self::Objects => "Objects",
            Self::Materials => "Materials",
            Self::Heat => "Distance",
            Self::Strips => "Strips",
            Self::Parts => "Parts",
        }
    }

    /// Returns true if each face has its own colour.
    pub(crate) fn is_by_face(self) -> bool {
        self.is_by_mesh_face() || self == Self::Parts
    }

    /// Returns true if a mesh needs the colours of its faces on the GPU.
    pub(crate) fn is_by_mesh_face(self) -> bool {
        matches!(self, Self::Objects | Self::Materials | Self::Strips)
    }
}

/// Tint of faces seen from behind, a warm red that no light makes of clay.
const BEHIND: [u8; 3] = [214, 92, 74];

impl Default for Display {
    fn default() -> Self {
        Self {
            shading: Shading::Smooth,
            coloring: Coloring::Own,
            wireframe: false,
            back_faces: false,
            ground: true,
            is_dark: true,
        }
    }
}

impl Display {
    /// Returns the background.
    pub fn background(&self) -> Background {
        match self.is_dark {
            true => Background::Gradient { top: [62, 66, 73], bottom: [34, 36, 40] },
            false => Background::default(),
        }
    }

    /// Returns the look of a subject.
    pub fn shade(&self) -> Shade {
        let own_colors = matches!(self.coloring, Coloring::Own | Coloring::Heat);
        Shade {
            lighting: match self.coloring {
                Coloring::Heat => Lighting::Soft,
                _ => Lighting::Studio,
            },
            back_faces: if self.back_faces { BackFaces::Tint(BEHIND) } else { BackFaces::Same },
            is_flat: self.shading == Shading::Flat,
            wireframe: self.wireframe.then(Wireframe::default),
            face_colors: self.coloring.is_by_face(),
            own_colors,
            checker: self.coloring == Coloring::Checker,
            tint: if self.coloring == Coloring::Clay { CLAY } else { [255; 3] },
            ..Shade::default()
        }
    }
}
