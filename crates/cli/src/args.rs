//! What may be written on the command line, but for the options of single verbs.

use clap::{Args, Parser, Subcommand, ValueEnum};
use meshlod::io::{Precision, Weld};
use meshlod::picture::{UpAxis, View};
use meshlod::{Format, ReadOptions, Scene, WriteOptions};

use crate::amounts::{self, Look};
use crate::answer::Answer;
use crate::compare::Compare;
use crate::demo::Demo;
use crate::failure::Failure;
use crate::session::Session;
use crate::verbs::{
    build, check, compress, decompress, extract, info, lods, measure, render, repair, replay,
    sample, simplify, strip,
};

/// Level of detail for triangle meshes.
///
/// The suffix selects the format: .ply .obj .stl .off .smf .gltf .glb. A path of - means standard
/// input or output, with the format given by --format.
#[derive(Parser)]
#[command(name = "meshlod", version, max_term_width = 100)]
pub struct Cli {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub verb: Verb,
}

/// Options of every verb.
#[derive(Args)]
pub struct Global {
    /// Print one JSON object to standard output and nothing else; messages go to standard error
    #[arg(long, global = true)]
    pub json: bool,
    /// Number of threads [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = amounts::threads,
        allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Format of standard input and output (-), as a suffix: ply, glb, …
    #[arg(long, global = true, value_name = "SUFFIX", value_parser = amounts::format)]
    pub format: Option<Format>,
}

/// What to do.
#[derive(Subcommand)]
pub enum Verb {
    /// Print what a file contains: counts, bounds, area, volume, closed or open
    Info(info::Info),
    /// Find defects of a mesh and contacts between its objects; exit with 1 on errors
    Check(check::Check),
    /// Repair the defects that can be repaired safely, and report every step
    Repair(repair::Repair),
    /// Reduce a mesh to fewer faces
    Simplify(simplify::Simplify),
    /// Restore any level recorded by simplify --sequence
    Replay(replay::Replay),
    /// Write a chain of coarser levels, as glTF with MSFT_lod or one file per level
    Lods(lods::Lods),
    /// Write all levels of a mesh to one multiresolution file (.mlod)
    Build(build::Build),
    /// Extract one mesh from a multiresolution file: fine where it is needed, coarse elsewhere
    Extract(extract::Extract),
    /// Convert a mesh and its levels to triangle strips, and count the vertices they send
    Strip(strip::Strip),
    /// Compress a mesh for rendering or transmission
    Compress(compress::Compress),
    /// Decode a compressed file (.mlq or .mlz) to a mesh
    Decompress(decompress::Decompress),
    /// Run all methods on one mesh: a table, and a page with pictures and error heat maps
    Compare(Compare),
    /// Measure the distance between two meshes, both ways
    Measure(measure::Measure),
    /// Write a procedural mesh of any size
    Sample(sample::Sample),
    /// Render a picture of a mesh
    Render(render::Render),
    /// Simplify sample meshes by several methods, and write a report page with pictures
    Demo(Demo),
}

impl Verb {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        match self {
            Self::Info(verb) => verb.run(session),
            Self::Check(verb) => verb.run(session),
            Self::Repair(verb) => verb.run(session),
            Self::Simplify(verb) => verb.run(session),
            Self::Replay(verb) => verb.run(session),
            Self::Lods(verb) => verb.run(session),
            Self::Build(verb) => verb.run(session),
            Self::Extract(verb) => verb.run(session),
            Self::Strip(verb) => verb.run(session),
            Self::Compress(verb) => verb.run(session),
            Self::Decompress(verb) => verb.run(session),
            Self::Compare(verb) => verb.run(session),
            Self::Measure(verb) => verb.run(session),
            Self::Sample(verb) => verb.run(session),
            Self::Render(verb) => verb.run(session),
            Self::Demo(verb) => verb.run(session),
        }
    }
}

/// Options of every verb that reads meshes.
#[derive(Args)]
pub struct Reading {
    /// Do not weld vertices at identical positions when reading glTF and STL
    #[arg(long, conflicts_with = "weld")]
    no_weld: bool,
    /// Weld vertices within EPS of each other, in model units
    #[arg(long, value_name = "EPS", value_parser = amounts::length,
        allow_negative_numbers = true)]
    weld: Option<f64>,
}

impl Reading {
    pub fn options(&self) -> ReadOptions {
        let weld = match self.weld {
            Some(epsilon) => Weld::Within(epsilon),
            None if self.no_weld => Weld::Off,
            None => Weld::Exact,
        };
        ReadOptions { weld }
    }

    /// The distance of --weld, for a verb that welds by itself: what is read then is not welded so.
    pub fn take_weld(&mut self) -> Option<f64> {
        self.weld.take()
    }
}

/// Options of every verb that writes meshes.
#[derive(Args)]
pub struct Writing {
    /// Coordinate type in PLY, OBJ, OFF and SMF: f32 or f64
    /// [default: f32; f64 where repair or extract need it]
    #[arg(long, value_name = "TYPE", value_parser = amounts::precision)]
    precision: Option<Precision>,
}

impl Writing {
    pub fn options(&self) -> WriteOptions {
        WriteOptions { precision: self.precision.unwrap_or(Precision::F32) }
    }

    /// The same, but where nothing is said as precise as it takes for whoever reads the file to find every
    /// position within `most` of where it is, in model units.
    pub fn within(mut self, most: f64, scene: &Scene, format: Format) -> Self {
        if self.moves(scene, format) > most {
            self.precision.get_or_insert(Precision::F64);
        }
        self
    }

    /// How far from where it is a coordinate is read again, at most.
    pub fn moves(&self, scene: &Scene, format: Format) -> f64 {
        let precision = self.options().precision;
        let positions = scene.meshes.iter().flat_map(|mesh| mesh.mesh.positions.as_flattened());
        let moves = positions.map(|&x| (read_again(x, precision, format) - x).abs());
        moves.fold(0.0, f64::max)
    }
}

/// What is read where a coordinate was written.
fn read_again(x: f64, precision: Precision, format: Format) -> f64 {
    let short = x as f32;
    match (format, precision) {
        (Format::Stl | Format::Gltf | Format::Glb, _) | (Format::Ply, Precision::F32) => {
            short.into()
        }
        // The shortest decimal of an `f32` is mostly another number as an `f64`.
        (Format::Obj | Format::Off | Format::Smf, Precision::F32) => {
            short.to_string().parse().unwrap_or(f64::NAN)
        }
        (_, Precision::F64) => x,
    }
}

/// How a distance is sampled.
#[derive(Args)]
pub struct Sampling {
    /// Number of samples each way, in addition to all vertices
    #[arg(long, value_name = "N", default_value_t = 500_000, value_parser = amounts::samples,
        allow_negative_numbers = true)]
    samples: usize,
    /// Seed of the random samples
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    seed: u64,
}

impl Sampling {
    pub fn options(&self) -> meshlod::measure::DistanceOptions {
        meshlod::measure::DistanceOptions { samples: self.samples, seed: self.seed }
    }
}

/// Where a mesh is seen from.
#[derive(Args)]
pub struct Viewpoint {
    /// Side to look from: front, back, left, right, top or bottom; or the viewing direction x,y,z
    /// [default: three-quarter view]
    #[arg(long, value_name = "DIR", value_parser = amounts::look, allow_hyphen_values = true)]
    view: Option<Look>,
    /// Axis that points up
    #[arg(long, value_name = "AXIS", default_value = "y")]
    up: Axis,
}

#[derive(Clone, Copy, ValueEnum)]
enum Axis {
    Y,
    Z,
}

impl Viewpoint {
    /// The direction and what is up; the rest is left as it is by default.
    pub fn view(&self) -> View {
        let up = match self.up {
            Axis::Y => UpAxis::Y,
            Axis::Z => UpAxis::Z,
        };
        let view = View::three_quarter(up);
        let direction = match (self.view, up) {
            (None, _) => view.direction,
            (Some(Look::Along(direction) | Look::From(direction)), UpAxis::Y)
            | (Some(Look::Along(direction)), UpAxis::Z) => direction,
            (Some(Look::From([x, y, z])), UpAxis::Z) => [x, -z, y],
        };
        View { direction, ..view }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }
}
