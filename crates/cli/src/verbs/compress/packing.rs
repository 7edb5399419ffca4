//! Kind of a compressed file by its suffix, and which options go with it.

use meshlod::jobs::{GltfPacking, Packing, PositionScheme};
use meshlod::strip::StripQuality;
use meshlod::{FileKind, Format};

use super::{Compress, SchemeArg};
use crate::options::args::AttributeErrorArgs;
use crate::session::failure::Failure;
use crate::session::files;

impl Compress {
    /// Returns what the suffix and the options ask for.
    ///
    /// # Errors
    /// A suffix of another kind of file, and options that do not apply to the kind.
    pub(super) fn packing(&self) -> Result<Packing, Failure> {
        let name = files::name(&self.output);
        let attributes = self.attributes.bounds();
        let packing = match (FileKind::of_path(&self.output).ok(), self.scheme) {
            (Some(FileKind::Resident), scheme) => {
                let scheme = scheme.map(|scheme| self.position_scheme(scheme));
                Packing::Resident { scheme, attributes }
            }
            (Some(FileKind::Sent), None) => Packing::Sent { on_lattice: false, attributes },
            (Some(FileKind::Sent), Some(SchemeArg::Lattice)) => {
                Packing::Sent { on_lattice: true, attributes }
            }
            (Some(FileKind::Mesh(Format::Glb)), None) => Packing::Gltf(self.whole_scene()),
            (Some(FileKind::Mesh(Format::Glb)), Some(SchemeArg::Parts)) => {
                Packing::Gltf(GltfPacking::Parts)
            }
            (Some(FileKind::Sent | FileKind::Mesh(Format::Glb)), Some(_)) => {
                let reason = format_args!("{name}: this format does not support that --scheme");
                return Err(Failure::usage(reason));
            }
            _ => {
                let reason =
                    format_args!("{name}: a compressed file must end in .mlq, .mlz or .glb");
                return Err(Failure::usage(reason));
            }
        };
        self.check_options(&packing)?;
        Ok(packing)
    }

    fn position_scheme(&self, scheme: SchemeArg) -> PositionScheme {
        match scheme {
            SchemeArg::Blocks => PositionScheme::Blocks,
            SchemeArg::Lattice => PositionScheme::Lattice,
            SchemeArg::Parts => {
                PositionScheme::Parts { strips: self.strips.then_some(StripQuality::QUICK) }
            }
        }
    }

    fn whole_scene(&self) -> GltfPacking {
        let AttributeErrorArgs { normal_error, uv_error, .. } = self.attributes;
        let (animation_error, resident) = (self.animation_error, self.resident);
        GltfPacking::Scene { normal_error, uv_error, animation_error, resident }
    }

    /// Refuses options that the kind of file has no place for.
    fn check_options(&self, packing: &Packing) -> Result<(), Failure> {
        let is_parts =
            matches!(packing, Packing::Resident { scheme: Some(PositionScheme::Parts { .. }), .. });
        if self.strips && !is_parts {
            return Err(Failure::usage("--strips needs --scheme parts and an .mlq file"));
        }
        if self.resident && !matches!(packing, Packing::Gltf(_)) {
            return Err(Failure::usage("--resident needs a .glb file"));
        }
        let is_whole = matches!(packing, Packing::Gltf(GltfPacking::Scene { .. }));
        if self.animation_error.is_some() && !is_whole {
            return Err(Failure::usage("--animation-error needs a .glb file without --scheme"));
        }
        let AttributeErrorArgs { normal_error, uv_error, color_error } = &self.attributes;
        let unheard = match packing {
            Packing::Resident { .. } | Packing::Sent { .. } => None,
            Packing::Gltf(GltfPacking::Scene { .. }) => *color_error,
            Packing::Gltf(GltfPacking::Parts) => normal_error.or(*uv_error).or(*color_error),
        };
        match unheard {
            None => Ok(()),
            Some(_) => Err(Failure::usage(format_args!(
                "{}: this format does not support that bound on attribute errors",
                files::name(&self.output)
            ))),
        }
    }
}
