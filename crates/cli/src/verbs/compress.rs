//! `compress`: writes a compressed mesh for rendering or transmission.

mod constraints;
mod gltf;
mod place;
mod resident;
mod transport;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use meshlod::codec::{CompressionTarget, LayerReport, Reconstruction, Scheme};
use meshlod::io::write_file;
use meshlod::{Mesh, Scene, SceneCounts};
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::args::{AttributeErrorArgs, ReadArgs};
use crate::constraints::ConstraintArgs;
use crate::failure::Failure;
use crate::files;
use crate::fuse;
use crate::model_scene;
use crate::numbers::{count, faces, percent, value};
use crate::parse::{self, Bound};
use crate::session::Session;

use self::place::Placed;

/// Compress a scene for rendering or transmission: meshes with attributes and objects, and in .mlq
/// and .mlz nodes, materials, skins and animations as they are. No face is removed, and every vertex
/// moves to a grid: --lock-contacts keeps vertices at one place together, and other locks are refused
#[derive(Args)]
pub struct Compress {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write: .mlq to render from directly, .mlz to send, .glb for other programs
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    target: CompressTarget,
    /// Encoding of positions: any scheme in .mlq [default: blocks], lattice in .mlz, parts in .glb
    #[arg(long, value_name = "SCHEME")]
    scheme: Option<SchemeArg>,
    /// Use --scheme parts as in the paper: vertices at the minimum corners of their cells, measured
    /// against truncated bits
    #[arg(long)]
    paper: bool,
    /// Write .glb that a GPU reads directly: KHR_mesh_quantization without EXT_meshopt_compression
    #[arg(long)]
    resident: bool,
    #[command(flatten)]
    attributes: AttributeErrorArgs,
    #[command(flatten)]
    constraints: ConstraintArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

/// Target of the compression: accuracy or size.
#[derive(Args)]
#[group(multiple = false)]
struct CompressTarget {
    /// As accurate as a grid of this many bits per axis over the whole mesh [default: 11]
    #[arg(long, value_name = "BITS", allow_negative_numbers = true)]
    bits: Option<u32>,
    /// Mean distance between the surfaces: 0.005% of the diagonal, or 0.1 in model units
    #[arg(long, value_name = "BOUND", value_parser = parse::bound, allow_hyphen_values = true)]
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

/// Compressed file with the figures to report.
struct CompressedFile {
    bytes: Vec<u8>,
    /// Bytes of positions, connectivity and attributes.
    sizes: [usize; 3],
    /// Bytes of nodes, materials, images and all else that is not compressed with the surface.
    scene: usize,
    vertices: usize,
    faces: usize,
    /// Kind and number of pieces: blocks, parts or meshes.
    pieces: (&'static str, usize),
    layers: Vec<LayerReport>,
    reached: bool,
    /// Messages on data of the input that is left out or not compressed.
    left_out: Vec<String>,
}

impl Compress {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        let kind = self.check_output()?;
        self.apply_locks(kind)?;
        files::check_apart(&self.output, &[&self.input])?;
        let mut scene = files::read(&self.input, &self.reading, session)?;
        self.check_scene(kind, &scene)?;
        let fused = self.constraints.fuse.apply(&mut scene, session);
        session.progress.stage("compressing");
        let start = Instant::now();
        let (packed, counts) = self.pack(kind, scene, session)?;
        let time = start.elapsed();
        for left_out in &packed.left_out {
            session.warn(Failure::at(&self.input, left_out));
        }
        if !packed.reached {
            let best = percent(100.0 * packed.reduction());
            let reason = format_args!("the target is out of reach; the reduction is {best}");
            session.warn(Failure::at(&self.input, reason));
        }
        session.progress.stage(&format!("writing {}", files::name(&self.output)));
        write_file(&self.output, &packed.bytes)?;
        let mut json = self.json(&packed, time);
        json["fused"] = fuse::to_json(fused.as_ref());
        let mut text = fuse::to_text(fused.as_ref()) + &self.text(&packed, time);
        if let Some(counts) = counts {
            json["scene"] = model_scene::counts_json(&counts);
            text += &model_scene::counts_text(&counts);
        }
        Ok(Answer { missed: session.strict && !packed.reached, ..Answer::new(json, text) })
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
        let Placed { mesh, rest, counts } = self.place(scene, session)?;
        let packed = match kind {
            Kind::Resident => self.resident(&mesh, rest)?,
            _ => self.transport(&mesh, &rest)?,
        };
        Ok((packed, counts))
    }

    /// Refuses an output that cannot be written and options that do not apply to it, before any
    /// work is done.
    fn check_output(&self) -> Result<Kind, Failure> {
        let suffix = self.output.extension().map(|suffix| suffix.to_ascii_lowercase());
        let (kind, schemes): (_, &[SchemeArg]) = match suffix.as_ref().and_then(|of| of.to_str()) {
            Some("mlq") => (Kind::Resident, SchemeArg::value_variants()),
            Some("mlz") => (Kind::Transport, &[SchemeArg::Lattice]),
            Some("glb" | "vrm") => (Kind::Gltf, &[SchemeArg::Parts]),
            _ => {
                let name = files::name(&self.output);
                let reason =
                    format_args!("{name}: a compressed file must end in .mlq, .mlz or .glb");
                return Err(Failure::usage(reason));
            }
        };
        let name = files::name(&self.output);
        if self.scheme.is_some_and(|scheme| !schemes.contains(&scheme)) {
            return Err(Failure::usage(format_args!(
                "{name}: this format does not support that --scheme"
            )));
        }
        if self.paper && self.scheme != Some(SchemeArg::Parts) {
            return Err(Failure::usage("--paper needs --scheme parts"));
        }
        if self.resident && kind != Kind::Gltf {
            return Err(Failure::usage("--resident needs a .glb file"));
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
        files::check_place(&self.output).map(|()| kind)
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
            Some(SchemeArg::Parts) if self.paper => Scheme::Parts(Reconstruction::Truncated),
            Some(SchemeArg::Parts) => Scheme::Parts(Reconstruction::Centred),
            Some(SchemeArg::Lattice) => Scheme::Lattice,
            Some(SchemeArg::Blocks) | None => Scheme::Blocks,
        }
    }

    /// Creates a failure that names the input.
    fn failed(&self, error: impl std::fmt::Display) -> Failure {
        Failure::at(&self.input, error)
    }

    fn json(&self, packed: &CompressedFile, time: Duration) -> Value {
        let [positions, connectivity, attributes] = packed.sizes;
        let mut json = json!({
            "file": files::name(&self.output),
            "vertices": packed.vertices,
            "faces": packed.faces,
            "bytes_positions": positions,
            "bytes_connectivity": connectivity,
            "bytes_attributes": attributes,
            "bytes_scene": packed.scene,
            "bytes_headers": packed.surface() - positions - connectivity - attributes,
            "bytes_total": packed.bytes.len(),
            "bytes_per_triangle": packed.surface() as f64 / packed.faces as f64,
            "reduction": packed.reduction(),
            "reached": packed.reached,
            "layers": packed.layers.iter().map(layer_json).collect::<Vec<_>>(),
            "encode_seconds": time.as_secs_f64(),
        });
        json[packed.pieces.0] = packed.pieces.1.into();
        json
    }

    fn text(&self, packed: &CompressedFile, time: Duration) -> String {
        let (what, pieces) = packed.pieces;
        let what = match (what, pieces) {
            ("meshes", 1) => "mesh",
            (many, 1) => many.trim_end_matches('s'),
            (many, _) => many,
        };
        let [positions, connectivity, attributes] = packed.sizes.map(count);
        let mut text = format!(
            "{}: {} in {} bytes, {:.2} per triangle; {} {what}\n\
             bytes: positions {positions} ({} less than f32), faces {connectivity}, attributes {attributes}\n",
            files::name(&self.output),
            faces(packed.faces),
            count(packed.bytes.len()),
            packed.surface() as f64 / packed.faces as f64,
            count(pieces),
            percent(100.0 * packed.reduction()),
        );
        for layer in &packed.layers {
            let (bytes, error) = (count(layer.bytes), value(layer.max_error));
            text += &format!("{}: {bytes} bytes, largest error {error}\n", layer.name);
        }
        if packed.scene > 0 {
            text += &format!("nodes, materials and images: {} bytes\n", count(packed.scene));
        }
        text + &format!("encode_seconds: {}\n", value(time.as_secs_f64()))
    }
}

impl CompressedFile {
    /// Returns the bytes of the surface: of meshes with attributes and labels.
    fn surface(&self) -> usize {
        self.bytes.len() - self.scene
    }

    fn reduction(&self) -> f64 {
        1.0 - self.sizes[0] as f64 / (12 * self.vertices) as f64
    }
}

fn layer_json(layer: &LayerReport) -> Value {
    json!({
        "name": layer.name,
        "kind": format!("{:?}", layer.kind),
        "bytes": layer.bytes,
        "max_error": layer.max_error,
    })
}

/// Lists the vertices and faces that a file leaves out of a mesh.
fn left_out(mesh: &Mesh, faces_there: usize) -> Vec<String> {
    let mut left_out = Vec::new();
    let alone = mesh.used_vertices().iter().filter(|&&used| !used).count();
    if alone > 0 {
        let some = if alone == 1 { "vertex" } else { "vertices" };
        left_out.push(format!("left out: {} unused {some}", count(alone)));
    }
    let odd = mesh.faces.len() - faces_there;
    if odd > 0 {
        left_out.push(format!("left out: {}, degenerate", faces(odd)));
    }
    left_out
}
