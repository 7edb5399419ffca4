//! `compress`: writes a compressed mesh for rendering or transmission.

mod constraints;
mod gltf;
mod place;
mod report;
mod resident;
mod sweep;
mod transport;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use meshlod::codec::{CompressionTarget, Reconstruction, Scheme};
use meshlod::jobs::ErrorPoses;
use meshlod::{Mesh, Scene, SceneCounts, model_limits};
use serde_json::json;

use crate::options::args::{AttributeErrorArgs, ReadArgs};
use crate::options::constraints::ConstraintArgs;
use crate::options::fuse;
use crate::options::parse::{self, Bound};
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::text::model_scene;
use crate::text::numbers::percent;

use self::place::Placed;
use self::report::{CompressedFile, StripCounts};

/// Compress a scene for rendering or transmission: meshes with attributes and objects, and in .mlq
/// and .mlz nodes, materials, skins and animations as they are. No face is removed, and every vertex
/// moves to a grid: --lock-contacts keeps vertices at one place together, and other locks are refused
#[derive(Args)]
pub struct Compress {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write: .mlq to render from directly, .mlz to send, .glb for other programs
    #[arg(value_name = "OUT", required_unless_present = "sweep")]
    output: Option<PathBuf>,
    /// Encoding of positions: any scheme in .mlq [default: blocks], lattice in .mlz, parts in .glb
    #[arg(long, value_name = "SCHEME")]
    scheme: Option<SchemeArg>,
    /// Use --scheme parts as in the paper: vertices at the minimum corners of their cells, measured
    /// against truncated bits
    #[arg(long)]
    paper: bool,
    /// Store the faces of --scheme parts as triangle strips, in local indices of mostly one byte that
    /// are drawn as they are: a larger file, but far less memory while it is drawn
    #[arg(long)]
    strips: bool,
    /// Write no file, but list sizes and errors of --scheme parts with these numbers of parts:
    /// 1,16,64,256
    #[arg(long, value_name = "PARTS", value_delimiter = ',', value_parser = parse::whole,
        allow_negative_numbers = true, conflicts_with_all = ["output", "bits", "error", "reduction",
        "strips", "resident", "strict", "animation_error", "normal_error", "uv_error", "color_error"])]
    sweep: Vec<usize>,
    /// Write .glb that a GPU reads directly: KHR_mesh_quantization without EXT_meshopt_compression
    #[arg(long)]
    resident: bool,
    /// Largest error of animated rotations in .glb, in degrees, at any time; translations and scales
    /// may err by the arc of this angle at the largest of their track [default: 0.1]
    #[arg(long, value_name = "DEGREES", value_parser = parse::length, allow_hyphen_values = true)]
    animation_error: Option<f64>,
    #[command(flatten)]
    target: CompressTarget,
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
#[group(multiple = false)]
struct CompressTarget {
    /// As accurate as a grid of this many bits per axis over the whole mesh [default: 11]
    #[arg(long, value_name = "BITS", allow_negative_numbers = true)]
    bits: Option<u32>,
    /// Mean distance between the surfaces: 0.005% of the diagonal, or 0.1 in model units
    #[arg(short, long, value_name = "BOUND", value_parser = parse::bound,
        allow_hyphen_values = true)]
    error: Option<Bound>,
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

/// Purpose of the output file, by its suffix.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Resident,
    Transport,
    Gltf,
}

impl Compress {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        let Some(output) = self.output.take() else { return self.run_sweep(session) };
        let kind = self.check_output(&output)?;
        self.apply_locks(kind)?;
        files::check_apart(&output, &[&self.input])?;
        let mut scene = files::read_surface(&self.input, &self.reading, session)?;
        self.check_scene(kind, &scene)?;
        self.attributes.refine_for(&scene);
        let fused = self.constraints.fuse.apply(&mut scene, session);
        session.progress.stage("compressing");
        let start = Instant::now();
        let (packed, counts) = self.pack(kind, scene, session)?;
        let time = start.elapsed();
        for remark in &packed.remarks {
            session.warn(Failure::at(&self.input, remark));
        }
        if !packed.reached {
            let best = percent(100.0 * packed.reduction());
            let reason = format_args!(
                "the target is out of reach; the reduction is {best}: ask for a smaller --reduction or a larger --error"
            );
            session.miss(&Failure::at(&self.input, reason));
        }
        scene_files::write_encoded(&output, &packed.notes, &packed.bytes, session)?;
        let figures = packed.figures(&output, time, fused, counts);
        let mut text = fuse::to_text(fused.as_ref()) + &packed.text(&output, time);
        if let Some(counts) = counts {
            text += &model_scene::counts_text(&counts, ErrorPoses::Unknown);
        }
        let outcome = Outcome::Missed.when(session.strict && !packed.reached);
        Ok(Answer { outcome, ..Answer::new(figures, text) })
    }

    /// Lists what numbers of parts give, and writes nothing.
    fn run_sweep(mut self, session: &Session) -> Result<Answer, Failure> {
        if self.scheme != Some(SchemeArg::Parts) {
            return Err(Failure::usage("--sweep needs --scheme parts"));
        }
        if self.sweep.contains(&0) {
            return Err(Failure::usage("--sweep: a number of parts must be at least 1, not 0"));
        }
        self.apply_locks(Kind::Resident)?;
        let mut scene = files::read_surface(&self.input, &self.reading, session)?;
        let fused = self.constraints.fuse.apply(&mut scene, session);
        let Placed { mesh, .. } = self.place(scene, session)?;
        let (mut json, text) = self.sweep(&mesh, session)?;
        json["fused"] = json!(fused);
        Ok(Answer::new(json, fuse::to_text(fused.as_ref()) + &text))
    }

    fn pack(
        &self,
        kind: Kind,
        scene: Scene,
        session: &Session,
    ) -> Result<(CompressedFile, Option<SceneCounts>), Failure> {
        if kind == Kind::Gltf {
            return Ok((self.gltf(scene)?, None));
        }
        let mut notes = model_limits(&scene);
        let Placed { mesh, rest, counts } = self.place(scene, session)?;
        let mut packed = match kind {
            Kind::Resident => self.resident(&mesh, rest)?,
            _ => self.transport(&mesh, &rest)?,
        };
        notes.append(&mut packed.notes);
        notes.push(packed.missed_bounds(&self.attributes.bounds()));
        packed.notes = notes;
        Ok((packed, counts))
    }

    /// Refuses an output that cannot be written and options that do not apply to it, before any
    /// work is done.
    fn check_output(&self, output: &Path) -> Result<Kind, Failure> {
        let suffix = output.extension().map(|suffix| suffix.to_ascii_lowercase());
        let (kind, schemes): (_, &[SchemeArg]) = match suffix.as_ref().and_then(|of| of.to_str()) {
            Some("mlq") => (Kind::Resident, SchemeArg::value_variants()),
            Some("mlz") => (Kind::Transport, &[SchemeArg::Lattice]),
            Some("glb" | "vrm") => (Kind::Gltf, &[SchemeArg::Parts]),
            _ => {
                let name = files::name(output);
                let reason =
                    format_args!("{name}: a compressed file must end in .mlq, .mlz or .glb");
                return Err(Failure::usage(reason));
            }
        };
        let name = files::name(output);
        if self.scheme.is_some_and(|scheme| !schemes.contains(&scheme)) {
            return Err(Failure::usage(format_args!(
                "{name}: this format does not support that --scheme"
            )));
        }
        if self.paper && self.scheme != Some(SchemeArg::Parts) {
            return Err(Failure::usage("--paper needs --scheme parts"));
        }
        if self.strips && (kind, self.scheme) != (Kind::Resident, Some(SchemeArg::Parts)) {
            return Err(Failure::usage("--strips needs --scheme parts and an .mlq file"));
        }
        if self.resident && kind != Kind::Gltf {
            return Err(Failure::usage("--resident needs a .glb file"));
        }
        if self.animation_error.is_some() && (kind != Kind::Gltf || self.scheme.is_some()) {
            return Err(Failure::usage("--animation-error needs a .glb file without --scheme"));
        }
        if self.animation_error.is_some_and(|degrees| !(0.01..=90.0).contains(&degrees)) {
            return Err(Failure::usage("--animation-error must be between 0.01 and 90 degrees"));
        }
        let AttributeErrorArgs { normal_error, uv_error, color_error } = &self.attributes;
        let bounds = match (kind, self.scheme) {
            (Kind::Resident | Kind::Transport, _) => None,
            (Kind::Gltf, None) => *color_error,
            _ => normal_error.or(*uv_error).or(*color_error),
        };
        if bounds.is_some() {
            return Err(Failure::usage(format_args!(
                "{name}: this format does not support that bound on attribute errors"
            )));
        }
        files::check_place(output).map(|()| kind)
    }

    fn target(&self, mesh: &Mesh) -> CompressionTarget {
        match (self.target.error, self.target.reduction) {
            (Some(error), _) => CompressionTarget::Error(error.length(mesh.bounds().diagonal())),
            (None, Some(part)) => CompressionTarget::Reduction(part),
            (None, None) => CompressionTarget::Bits(self.bits()),
        }
    }

    fn bits(&self) -> u32 {
        self.target.bits.unwrap_or(11)
    }

    fn scheme(&self) -> Scheme {
        match self.scheme {
            Some(SchemeArg::Parts) => Scheme::Parts(self.reconstruction()),
            Some(SchemeArg::Lattice) => Scheme::Lattice,
            Some(SchemeArg::Blocks) | None => Scheme::Blocks,
        }
    }

    /// Returns where in their cells vertices of parts are decoded to.
    fn reconstruction(&self) -> Reconstruction {
        if self.paper { Reconstruction::Truncated } else { Reconstruction::Centred }
    }

    /// Creates a failure that names the input.
    fn failed(&self, error: impl std::fmt::Display) -> Failure {
        Failure::at(&self.input, error)
    }
}
