//! `compress`: writes a compressed mesh for rendering or transmission.

mod locks;
mod packing;
mod report;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use meshlod::jobs::{self, CompressRequest, CompressTarget};

use crate::options::args::{AttributeErrorArgs, ReadArgs};
use crate::options::constraints::ConstraintArgs;
use crate::options::parse;
use crate::options::tolerance::Tolerance;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::scene_files;
use crate::text::numbers::percent;

/// Compress a scene for rendering or transmission
///
/// Meshes keep their attributes and objects, and .mlq and .mlz also hold nodes, materials, skins
/// and animations as they are. No face is removed, and every vertex moves to a grid:
/// --lock-contacts keeps vertices at one place together, and other locks are refused.
#[derive(Args)]
pub struct Compress {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write: .mlq to render from directly, .mlz to send, .glb for other programs
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Encoding of positions
    ///
    /// In .mlq any scheme [default: blocks], in .mlz lattice, in .glb parts.
    #[arg(long, value_name = "SCHEME")]
    scheme: Option<SchemeArg>,
    /// Store the faces of --scheme parts as triangle strips
    ///
    /// Local indices of mostly one byte that are drawn as they are: a larger file, but far less
    /// memory while it is drawn.
    #[arg(long)]
    strips: bool,
    /// Write a .glb that a GPU reads directly
    ///
    /// With KHR_mesh_quantization and without EXT_meshopt_compression.
    #[arg(long)]
    resident: bool,
    /// Largest error of rotations in .glb, in degrees [default: 0.1]
    ///
    /// At any time of an animation; translations and scales may err by the arc of this angle at the
    /// largest of their track.
    #[arg(long, value_name = "DEGREES", value_parser = parse::degrees, allow_hyphen_values = true)]
    animation_error: Option<f64>,
    #[command(flatten)]
    target: CompressTargetArgs,
    #[command(flatten)]
    attributes: AttributeErrorArgs,
    #[command(flatten)]
    constraints: ConstraintArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

/// Target of the compression: accuracy or size.
#[derive(Args)]
#[command(next_help_heading = "Accuracy, one of")]
#[group(id = "CompressTarget", multiple = false)]
struct CompressTargetArgs {
    /// As accurate as a grid of this many bits per axis over the whole mesh [default: 11]
    #[arg(long, value_name = "BITS", allow_negative_numbers = true)]
    bits: Option<u32>,
    /// Mean distance between the surfaces: 0.005% of the diagonal, or 0.1 in model units
    #[arg(short, long, value_name = "BOUND", value_parser = Tolerance::parse,
        allow_hyphen_values = true)]
    error: Option<Tolerance>,
    /// Reduction of positions against three f32 per vertex: 70%
    #[arg(long, value_name = "RATIO", value_parser = parse::ratio, allow_hyphen_values = true)]
    reduction: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SchemeArg {
    /// Eight bits per axis and one matrix per part; vertices shared by parts are stored in each
    Parts,
    /// Each vertex in one block, in cells aligned with the surface
    Blocks,
    /// Each vertex in one block, on a lattice of power-of-two cells that all meshes share
    Lattice,
}

impl Compress {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let hearing = Hearing::new(session, &self.input, &self.output);
        let request = self.request(session)?;
        request.check().map_err(|error| hearing.failure(error))?;
        files::check_place(&self.output)?;
        files::check_apart(&self.output, &[&self.input])?;
        let scene = files::read_surface(&self.input, &self.reading, session)?;
        if let Some(error) = &self.target.error {
            error.doubt("--error", &self.input, &scene, session);
        }
        let done = jobs::compress(scene, &request, &hearing);
        let (bytes, report) = done.map_err(|error| hearing.failure(error))?;
        if !report.reached {
            let best = percent(100.0 * report.reduction);
            let reason = format_args!(
                "the target is out of reach; the reduction is {best}: ask for a smaller --reduction or a larger --error"
            );
            session.miss(&Failure::at(&self.input, reason));
        }
        scene_files::write_encoded(&self.output, &report.notes, &bytes, session)?;
        let text = report::text(&self.output, &report);
        Ok(Answer::new(report::figures(&self.output, &report), text))
    }

    fn request(&self, session: &Session) -> Result<CompressRequest, Failure> {
        Ok(CompressRequest {
            packing: self.packing()?,
            target: self.target.target(&self.input, session)?,
            fuse: self.constraints.fuse.fuse,
            lock_contacts: self.ties_contacts()?,
            name: files::stem(&self.input),
        })
    }
}

impl CompressTargetArgs {
    fn target(&self, input: &Path, session: &Session) -> Result<CompressTarget, Failure> {
        Ok(match (self.bits, &self.error, self.reduction) {
            (_, Some(error), _) => CompressTarget::Error(error.bound("--error", input, session)?),
            (_, _, Some(part)) => CompressTarget::Reduction(part),
            (Some(bits), ..) => CompressTarget::Bits(bits),
            _ => CompressTarget::default(),
        })
    }
}
