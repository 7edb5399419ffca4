//! The request for a compression.

use meshlod_codec::CompressionTarget;
use meshlod_io::gltf::SourceDocument;
use meshlod_io::{Format, Scene};
use meshlod_mesh::{AttributeBounds, Mesh};
use meshlod_strip::StripQuality;

use crate::jobs::JobError;
use crate::{Bound, FileKind};

/// Request of [`compress`](super::compress).
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CompressRequest {
    /// Kind of file, with what it alone can be asked for.
    pub packing: Packing,
    /// Accuracy or size of the positions.
    pub target: CompressTarget,
    /// True to unite closed components that intersect before anything else.
    pub fuse: bool,
    /// True to keep vertices at one place together: all are rounded to one lattice.
    ///
    /// Meshes that several nodes show become one mesh then, with a copy for each node.
    pub lock_contacts: bool,
    /// Name of that mesh.
    pub name: String,
}

/// Kind of a compressed file, with what it alone can be asked for.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
pub enum Packing {
    /// `.mlq`, which is drawn from directly.
    Resident {
        /// Encoding of positions; `None` for blocks, or the lattice if contacts are locked.
        #[cfg_attr(feature = "serde", serde(default))]
        scheme: Option<PositionScheme>,
        /// Largest errors of attributes.
        #[cfg_attr(feature = "serde", serde(default))]
        attributes: AttributeBounds,
    },
    /// `.mlz`, to send.
    Sent {
        /// True to round positions to a lattice with power-of-two cells, which several meshes share.
        #[cfg_attr(feature = "serde", serde(default))]
        on_lattice: bool,
        /// Largest errors of attributes.
        #[cfg_attr(feature = "serde", serde(default))]
        attributes: AttributeBounds,
    },
    /// `.glb`, for other programs.
    Gltf(GltfPacking),
}

/// Encoding of positions in an `.mlq` file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
pub enum PositionScheme {
    /// In blocks of 32 vertices, each with cells that are aligned with the surface.
    Blocks,
    /// On a lattice with power-of-two cells, which several meshes can share.
    Lattice,
    /// In 8 bits per axis, in parts of the mesh that share one grid.
    Parts {
        /// Quality of the triangle strips that faces are stored as; `None` for fewer bits that must
        /// be decoded to draw them.
        #[cfg_attr(feature = "serde", serde(default))]
        strips: Option<StripQuality>,
    },
}

/// Form of a compressed `.glb` file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
pub enum GltfPacking {
    /// The whole scene, with quantized attributes.
    Scene {
        /// Largest error of normals and tangents in degrees; `None` for 8 bits per component.
        #[cfg_attr(feature = "serde", serde(default))]
        normal_error: Option<f64>,
        /// Largest error of texture coordinates, where 1 is the whole texture; `None` for 12 bits.
        #[cfg_attr(feature = "serde", serde(default))]
        uv_error: Option<f64>,
        /// Largest error of animated rotations in degrees, from 0.01 to 90; `None` for 0.1.
        #[cfg_attr(feature = "serde", serde(default))]
        animation_error: Option<f64>,
        /// True for a file that a GPU reads directly, without meshopt's compression.
        #[cfg_attr(feature = "serde", serde(default))]
        resident: bool,
    },
    /// Only the surface, in parts that are nodes with matrices of their own.
    Parts,
}

/// Accuracy or size of compressed positions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum CompressTarget {
    /// As accurate as a grid of this many bits per axis over the whole mesh.
    Bits(u32),
    /// Mean distance between the surfaces.
    Error(Bound),
    /// Fraction of position storage to save, compared with three `f32` for each vertex.
    Reduction(f64),
}

impl Default for CompressTarget {
    fn default() -> Self {
        Self::Bits(11)
    }
}

impl Default for Packing {
    fn default() -> Self {
        Self::Resident { scheme: None, attributes: AttributeBounds::default() }
    }
}

impl Packing {
    /// Returns the default packing for a kind of file; `None` if it is no compressed file.
    pub fn of(kind: FileKind) -> Option<Self> {
        let attributes = AttributeBounds::default();
        match kind {
            FileKind::Resident => Some(Self::Resident { scheme: None, attributes }),
            FileKind::Sent => Some(Self::Sent { on_lattice: false, attributes }),
            FileKind::Mesh(Format::Glb) => Some(Self::Gltf(GltfPacking::Scene {
                normal_error: None,
                uv_error: None,
                animation_error: None,
                resident: false,
            })),
            FileKind::Mesh(_) | FileKind::Levels => None,
        }
    }

    /// Makes the bound of texture coordinates hold for textures that a material repeats by scaling
    /// the coordinates.
    pub(super) fn refined_for(&self, scene: &Scene) -> Self {
        let scale = scene.source.as_ref().map_or(1.0, SourceDocument::largest_texture_scale);
        let mut packing = self.clone();
        if scale > 1.0 {
            match &mut packing {
                Self::Resident { attributes, .. } | Self::Sent { attributes, .. } => {
                    attributes.uv /= scale;
                }
                Self::Gltf(GltfPacking::Scene { uv_error, .. }) => {
                    let bound = uv_error.unwrap_or(AttributeBounds::default().uv);
                    *uv_error = Some(bound / scale);
                }
                Self::Gltf(GltfPacking::Parts) => {}
            }
        }
        packing
    }
}

impl CompressTarget {
    /// Returns the target for the positions of a mesh.
    pub(super) fn of(self, mesh: &Mesh) -> CompressionTarget {
        match self {
            Self::Bits(bits) => CompressionTarget::Bits(bits),
            Self::Error(error) => CompressionTarget::Error(error.length(mesh.bounds().diagonal())),
            Self::Reduction(part) => CompressionTarget::Reduction(part),
        }
    }

    /// Returns the number of bits for the positions of a whole scene in glTF.
    ///
    /// # Errors
    /// Another target, and numbers that the format cannot have.
    pub(super) fn bits_of_gltf(self) -> Result<u32, JobError> {
        match self {
            Self::Bits(bits @ 1..=16) => Ok(bits),
            Self::Bits(bits) => Err(JobError::request(
                "",
                format_args!("--bits must be between 1 and 16 in .glb, not {bits}"),
            )),
            Self::Error(_) | Self::Reduction(_) => Err(JobError::request(
                "",
                "--error and --reduction need --scheme parts in .glb; use --bits",
            )),
        }
    }
}

impl CompressRequest {
    /// Fails if parts of the request do not go together, whatever scene it is for.
    ///
    /// # Errors
    /// [`JobError::Request`].
    pub fn check(&self) -> Result<(), JobError> {
        let refused = |reason: &str| Err(JobError::request("", reason));
        let is_scattered = match &self.packing {
            Packing::Resident { scheme, .. } => {
                !matches!(scheme, None | Some(PositionScheme::Lattice))
            }
            Packing::Gltf(form) => *form == GltfPacking::Parts,
            Packing::Sent { .. } => false,
        };
        if self.lock_contacts && is_scattered {
            return refused(
                "--lock-contacts needs one grid for all vertices: use --scheme lattice, or leave out --scheme",
            );
        }
        match (&self.packing, self.target) {
            (Packing::Sent { .. }, CompressTarget::Reduction(_)) => {
                refused("--reduction does not go with .mlz; use --bits or --error")
            }
            (Packing::Gltf(GltfPacking::Scene { animation_error, .. }), target) => {
                match animation_error.is_none_or(|degrees| (0.01..=90.0).contains(&degrees)) {
                    true => target.bits_of_gltf().map(|_| ()),
                    false => refused("--animation-error must be between 0.01 and 90 degrees"),
                }
            }
            _ => Ok(()),
        }
    }

    /// Refuses contacts that a file keeps on grids of their own: those of several meshes in `.glb`.
    pub(super) fn check_scene(&self, scene: &Scene) -> Result<(), JobError> {
        let is_gltf = matches!(self.packing, Packing::Gltf(_));
        match self.lock_contacts && is_gltf && scene.instances().len() > 1 {
            false => Ok(()),
            true => Err(JobError::request(
                "lock_contacts",
                "the meshes of a .glb file have grids of their own; write .mlq or .mlz",
            )),
        }
    }
}
