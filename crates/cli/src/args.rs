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
/// Formats go by suffix: .ply .obj .stl .off .smf .gltf .glb; - is standard input or output.
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
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// Threads to work with [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = amounts::threads,
        allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// The format of -, as a suffix: ply, glb, …
    #[arg(long, global = true, value_name = "SUFFIX", value_parser = amounts::format)]
    pub format: Option<Format>,
}

/// What to do.
#[derive(Subcommand)]
pub enum Verb {
    /// Say what is in a file: counts, bounds, area, volume, closed or not
    Info(info::Info),
    /// Say what is wrong with a mesh and where its objects meet; exit 1 for errors
    Check(check::Check),
    /// Mend what can be mended safely, and say what was done
    Repair(repair::Repair),
    /// Make a mesh coarser
    Simplify(simplify::Simplify),
    /// Give back any level that simplify --sequence has kept
    Replay(replay::Replay),
    /// Make a chain of coarser levels, as glTF with MSFT_lod or one file each
    Lods(lods::Lods),
    /// Write all levels of a mesh into one multiresolution file
    Build(build::Build),
    /// Take one mesh out of a multiresolution file: fine where it is looked at, coarse elsewhere
    Extract(extract::Extract),
    /// Draw a mesh and its levels as triangle strips, and say what is sent
    Strip(strip::Strip),
    /// Write a mesh in few bytes, to draw from or to send
    Compress(compress::Compress),
    /// Give back the mesh of a compressed file
    Decompress(decompress::Decompress),
    /// Run all methods on one mesh: a table, and a page with pictures and heat maps
    Compare(Compare),
    /// Measure how far two meshes are apart, both ways
    Measure(measure::Measure),
    /// Write a procedural mesh of any size
    Sample(sample::Sample),
    /// Draw a picture
    Render(render::Render),
    /// Run the whole line on samples, and write a page of it with pictures
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
    /// Keep vertices apart that glTF and STL have apart
    #[arg(long, conflicts_with = "weld")]
    no_weld: bool,
    /// Make one vertex of those within EPS of each other, in model units
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
    /// Of coordinates in PLY, OBJ, OFF and SMF: f32 or f64; f32 if not said, but f64 where repair and extract
    /// need it
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
    /// Samples each way, beside all vertices
    #[arg(long, value_name = "N", default_value_t = 500_000, value_parser = amounts::samples,
        allow_negative_numbers = true)]
    samples: usize,
    /// What the samples are drawn by
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
    /// Where to look from: front, back, left, right, top, bottom; or the direction to look in, x,y,z
    #[arg(long, value_name = "DIR", value_parser = amounts::look, allow_hyphen_values = true)]
    view: Option<Look>,
    /// The axis that is up
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
