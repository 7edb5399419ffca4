//! `compress`: a mesh in few bytes, to draw from or to send.

mod resident;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use meshlod::Mesh;
use meshlod::codec::{AttributeBounds, Cells, LayerReport, Scheme, Target};
use meshlod::io::write_file;
use serde_json::{Value, json};

use crate::amounts::{self, Bound};
use crate::answer::Answer;
use crate::args::Reading;
use crate::failure::Failure;
use crate::files;
use crate::numbers::{count, faces, percent, value};
use crate::session::Session;

#[derive(Args)]
pub struct Compress {
    /// File to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write: .mlq is drawn from as it is
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    goal: Goal,
    /// How positions are told
    #[arg(long, value_name = "SCHEME", default_value = "blocks")]
    scheme: SchemeName,
    /// Parts as in the paper: vertices at the least corners of their cells, and held against truncated bits
    #[arg(long)]
    paper: bool,
    #[command(flatten)]
    attributes: AttributeGoals,
    /// Exit with 1 when the target is out of reach
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    reading: Reading,
}

/// How well, or in how little.
#[derive(Args)]
#[group(multiple = false)]
struct Goal {
    /// As well as this many bits an axis do for the whole mesh; 11 if nothing is said
    #[arg(long, value_name = "BITS", allow_negative_numbers = true)]
    bits: Option<u32>,
    /// The mean distance between the surfaces: 0.005% of the diagonal, 0.1 in model units
    #[arg(long, value_name = "BOUND", value_parser = amounts::bound, allow_hyphen_values = true)]
    error: Option<Bound>,
    /// How much less than three f32 a vertex positions take: 70%
    #[arg(long, value_name = "PART", value_parser = amounts::ratio, allow_hyphen_values = true)]
    reduction: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SchemeName {
    /// Eight bits an axis, one matrix a part; what parts share is stored in each
    Parts,
    /// Each vertex in one block, in cells that lie as the surface does
    Blocks,
    /// Each vertex in one block, on a lattice with cells of a power of two: the same for all meshes
    Lattice,
}

#[derive(Args)]
struct AttributeGoals {
    /// How far normals and tangents may turn, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = amounts::length, allow_hyphen_values = true)]
    normal_error: Option<f64>,
    /// How far texture coordinates may be off; 1 is the whole texture
    #[arg(long, value_name = "BOUND", value_parser = amounts::length, allow_hyphen_values = true)]
    uv_error: Option<f64>,
    /// How far colours may be off, from 0 to 1
    #[arg(long, value_name = "BOUND", value_parser = amounts::length, allow_hyphen_values = true)]
    color_error: Option<f64>,
}

/// A compressed file, and what is to be said of it.
struct Packed {
    bytes: Vec<u8>,
    /// Of positions, connectivity and attributes.
    sizes: [usize; 3],
    vertices: usize,
    faces: usize,
    /// Blocks or parts, and how many.
    pieces: (&'static str, usize),
    layers: Vec<LayerReport>,
    reached: bool,
}

impl Compress {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        check_output(&self.output)?;
        files::check_apart(&self.output, &[&self.input])?;
        let scene = files::read(&self.input, &self.reading, session)?;
        let mesh = scene.into_mesh();
        session.progress.stage("compressing");
        let start = Instant::now();
        let packed = self.resident(&mesh)?;
        let time = start.elapsed();
        self.warn(&mesh, &packed, session);
        session.progress.stage(&format!("writing {}", files::name(&self.output)));
        write_file(&self.output, &packed.bytes)?;
        Ok(Answer {
            missed: self.strict && !packed.reached,
            ..Answer::new(self.json(&packed, time), self.text(&packed, time))
        })
    }

    /// Says what of the mesh is not in the file, and what it is not.
    fn warn(&self, mesh: &Mesh, packed: &Packed, session: &Session) {
        let odd = mesh.faces.len() - packed.faces;
        if odd > 0 {
            let reason = format_args!("left out: {} that repeat a corner", faces(odd));
            session.warn(Failure::at(&self.input, reason));
        }
        if mesh.materials.is_some() || mesh.objects.is_some() {
            let reason = "left out: its materials and objects; the file has one surface";
            session.warn(Failure::at(&self.input, reason));
        }
        if !packed.reached {
            let best = percent(100.0 * packed.reduction());
            let reason =
                format_args!("the mesh is too small for what is asked; the reduction is {best}");
            session.warn(Failure::at(&self.input, reason));
        }
    }

    fn target(&self, mesh: &Mesh) -> Target {
        match (self.goal.error, self.goal.reduction) {
            (Some(error), _) => Target::Error(error.length(mesh.bounds().diagonal())),
            (None, Some(part)) => Target::Reduction(part),
            (None, None) => Target::Bits(self.goal.bits.unwrap_or(11)),
        }
    }

    fn scheme(&self) -> Scheme {
        match self.scheme {
            SchemeName::Parts if self.paper => Scheme::Parts(Cells::Truncated),
            SchemeName::Parts => Scheme::Parts(Cells::Centred),
            SchemeName::Blocks => Scheme::Blocks,
            SchemeName::Lattice => Scheme::Lattice,
        }
    }

    fn json(&self, packed: &Packed, time: Duration) -> Value {
        let [positions, connectivity, attributes] = packed.sizes;
        let mut json = json!({
            "file": files::name(&self.output),
            "vertices": packed.vertices,
            "faces": packed.faces,
            "bytes_positions": positions,
            "bytes_connectivity": connectivity,
            "bytes_attributes": attributes,
            "bytes_total": packed.bytes.len(),
            "bytes_per_triangle": packed.bytes.len() as f64 / packed.faces as f64,
            "reduction": packed.reduction(),
            "reached": packed.reached,
            "layers": packed.layers.iter().map(layer_json).collect::<Vec<_>>(),
            "encode_seconds": time.as_secs_f64(),
        });
        json[packed.pieces.0] = packed.pieces.1.into();
        json
    }

    fn text(&self, packed: &Packed, time: Duration) -> String {
        let (what, pieces) = packed.pieces;
        let [positions, connectivity, attributes] = packed.sizes.map(count);
        let mut text = format!(
            "{}: {} in {} bytes, {:.2} a triangle; {} {what}\n\
             positions {positions} ({} less than f32), faces {connectivity}, attributes {attributes}\n",
            files::name(&self.output),
            faces(packed.faces),
            count(packed.bytes.len()),
            packed.bytes.len() as f64 / packed.faces as f64,
            count(pieces),
            percent(100.0 * packed.reduction()),
        );
        for layer in &packed.layers {
            let (bytes, error) = (count(layer.bytes), value(layer.max_error));
            text += &format!("{}: {bytes} bytes, off by up to {error}\n", layer.name);
        }
        text + &format!("encode_seconds: {}\n", value(time.as_secs_f64()))
    }
}

impl Packed {
    fn reduction(&self) -> f64 {
        1.0 - self.sizes[0] as f64 / (12 * self.vertices) as f64
    }
}

impl AttributeGoals {
    fn bounds(&self) -> AttributeBounds {
        let default = AttributeBounds::default();
        AttributeBounds {
            direction_rad: self.normal_error.map_or(default.direction_rad, f64::to_radians),
            uv: self.uv_error.unwrap_or(default.uv),
            color: self.color_error.unwrap_or(default.color),
            ..default
        }
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

/// Refuses a file that could not be written, before any work is done.
fn check_output(path: &Path) -> Result<(), Failure> {
    match path.extension() {
        Some(suffix) if suffix.eq_ignore_ascii_case("mlq") => files::check_place(path),
        _ => Err(Failure::usage(format_args!("{}: compressed meshes are .mlq", files::name(path)))),
    }
}
