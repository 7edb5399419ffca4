//! Groups of command-line options that several commands share.

use clap::{Args, ValueEnum};
use meshlod::io::{Precision, Weld};
use meshlod::jobs::WrittenAs;
use meshlod::mesh::AttributeBounds;
use meshlod::picture::{UpAxis, View};
use meshlod::{Format, ReadOptions, WriteOptions};

use crate::options::parse::{self, Suffix, ViewDirection};

/// Options of every verb.
#[derive(Clone, Args)]
#[command(next_help_heading = "Global options")]
pub struct GlobalArgs {
    /// Print one JSON object to standard output and nothing else; messages go to standard error
    #[arg(long, global = true)]
    pub json: bool,
    /// Exit with 1 if data would be lost or a target is out of reach
    ///
    /// If something of a file would be left out, nothing is written; if a target is out of reach,
    /// what comes closest to it is.
    #[arg(long, global = true)]
    pub strict: bool,
    /// Print errors only, and JSON with --json: no progress, no warnings, no summary
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Number of threads [default: one per core]
    #[arg(short = 'j', long, global = true, value_name = "N", value_parser = parse::threads,
        allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Format of - and of the files of a batch: ply, glb, …
    ///
    /// A suffix, for standard input and output and for the outputs of a batch.
    #[arg(long, global = true, value_name = "SUFFIX", value_parser = parse::suffix)]
    pub format: Option<Suffix>,
}

impl GlobalArgs {
    /// Returns these options, and of those that are not given the others.
    pub fn or(self, others: Self) -> Self {
        Self {
            json: self.json || others.json,
            strict: self.strict || others.strict,
            quiet: self.quiet || others.quiet,
            threads: self.threads.or(others.threads),
            format: self.format.or(others.format),
        }
    }
}

/// Options of every verb that reads meshes.
#[derive(Args, Default)]
#[command(next_help_heading = "Files")]
pub struct ReadArgs {
    /// Do not weld vertices at identical positions when reading glTF and STL
    #[arg(long, conflicts_with = "weld")]
    no_weld: bool,
    /// Weld vertices within EPS of each other, in model units
    #[arg(long, value_name = "EPS", value_parser = parse::length,
        allow_negative_numbers = true)]
    weld: Option<f64>,
}

impl ReadArgs {
    pub fn options(&self) -> ReadOptions {
        let weld = match self.weld {
            Some(epsilon) => Weld::Within(epsilon),
            None if self.no_weld => Weld::Off,
            None => Weld::Exact,
        };
        ReadOptions { weld }
    }

    /// Returns true if one of the options was given.
    pub fn is_given(&self) -> bool {
        self.no_weld || self.weld.is_some()
    }

    /// Returns the value of `--weld`.
    pub fn weld(&self) -> Option<f64> {
        self.weld
    }

    /// Takes the value of `--weld` for a command that welds by itself, so that reading the file
    /// does not.
    pub fn take_weld(&mut self) -> Option<f64> {
        self.weld.take()
    }
}

/// Options of every verb that writes meshes.
#[derive(Clone, Copy, Args)]
#[command(next_help_heading = "Files")]
pub struct WriteArgs {
    /// Coordinates of PLY, OBJ, OFF, SMF and text STL: f32, f64 or auto
    ///
    /// With auto they are f32 where that keeps vertices apart and moves none by more than a
    /// thousandth of the mean edge.
    #[arg(long, value_name = "TYPE", default_value = "auto")]
    precision: Precision,
}

impl WriteArgs {
    pub fn options(&self) -> WriteOptions {
        WriteOptions { precision: self.precision }
    }

    /// Returns the options for another precision.
    pub fn in_precision(self, precision: Precision) -> Self {
        Self { precision }
    }

    /// Returns what a job has to know about a file of a format.
    pub fn in_format(self, format: Format) -> WrittenAs {
        WrittenAs { format, precision: self.precision }
    }

    /// Chooses the precision in which the result of a job has to be written.
    pub fn written_as(self, as_: Option<WrittenAs>) -> Self {
        as_.map_or(self, |as_| Self { precision: as_.precision })
    }
}

/// Options for the precision of attributes.
#[derive(Args)]
#[command(next_help_heading = "Attributes")]
pub struct AttributeErrorArgs {
    /// Largest error of normals and tangents, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = parse::degrees, allow_hyphen_values = true)]
    pub normal_error: Option<f64>,
    /// Largest error of texture coordinates, where 1 is the whole texture
    #[arg(long, value_name = "BOUND", value_parser = parse::length, allow_hyphen_values = true)]
    pub uv_error: Option<f64>,
    /// Largest error of colours, from 0 to 1
    #[arg(long, value_name = "BOUND", value_parser = parse::length, allow_hyphen_values = true)]
    pub color_error: Option<f64>,
}

impl AttributeErrorArgs {
    /// Returns the bounds, with the defaults for those not given.
    pub fn bounds(&self) -> AttributeBounds {
        let default = AttributeBounds::default();
        AttributeBounds {
            direction_rad: self.normal_error.map_or(default.direction_rad, f64::to_radians),
            uv: self.uv_error.unwrap_or(default.uv),
            color: self.color_error.unwrap_or(default.color),
            ..default
        }
    }
}

/// Options for sampling a distance.
#[derive(Args)]
#[command(next_help_heading = "Distances")]
pub struct SamplingArgs {
    /// Number of samples each way, in addition to all vertices
    #[arg(long, value_name = "N", default_value_t = 500_000, value_parser = parse::samples,
        allow_negative_numbers = true)]
    samples: usize,
    /// Seed of the random samples
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    seed: u64,
}

impl SamplingArgs {
    pub fn options(&self) -> meshlod::measure::DistanceOptions {
        meshlod::measure::DistanceOptions { samples: self.samples, seed: self.seed }
    }
}

/// Options for the viewing direction.
#[derive(Args)]
#[command(next_help_heading = "Picture")]
pub struct ViewArgs {
    /// Side to look from, or the viewing direction x,y,z [default: three-quarter view]
    ///
    /// The sides are front, back, left, right, top and bottom.
    #[arg(long, value_name = "DIR", value_parser = parse::view_direction, allow_hyphen_values = true)]
    view: Option<ViewDirection>,
    /// Axis that points up
    #[arg(long, value_name = "AXIS", default_value = "y")]
    up: Axis,
}

#[derive(Clone, Copy, ValueEnum)]
enum Axis {
    Y,
    Z,
}

impl ViewArgs {
    /// Returns whether a direction is given, so that the default is not used.
    pub fn is_given(&self) -> bool {
        self.view.is_some()
    }

    /// Returns the view with the requested direction and up axis, and defaults for all else.
    pub fn view(&self) -> View {
        let up = match self.up {
            Axis::Y => UpAxis::Y,
            Axis::Z => UpAxis::Z,
        };
        let view = View::three_quarter(up);
        let direction = match (self.view, up) {
            (None, _) => view.direction,
            (Some(ViewDirection::Along(direction) | ViewDirection::From(direction)), UpAxis::Y)
            | (Some(ViewDirection::Along(direction)), UpAxis::Z) => direction,
            (Some(ViewDirection::From([x, y, z])), UpAxis::Z) => [x, -z, y],
        };
        View { direction, ..view }
    }
}
