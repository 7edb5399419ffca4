//! `build`: writes all levels of a mesh to one file.

mod report;

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use meshlod::jobs::{self, BuildRequest, LevelModel, LevelOrder};
use meshlod::multires::ErrorKind;
use meshlod::{Bound, Constraints, Method};

use crate::options::args::{AttributeErrorArgs, ReadArgs};
use crate::options::constraints::ConstraintArgs;
use crate::options::locks::InputScene;
use crate::options::parse;
use crate::options::tolerance::Tolerance;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::hearing::Hearing;
use crate::session::model_file;
use crate::session::scene_files;

/// Write all levels of a mesh or scene to one file (.mlod)
///
/// The topology is kept, and locks hold in every level: tied vertices are locked. Nodes, materials,
/// images, skins, morph targets and animations come back with extract. A mesh that several nodes
/// show is stored once, and errors hold for the largest of them. In the pose of the file they are
/// measured, proved or estimated; in up to 64 poses of its animations they are measured too, unless
/// --bounds or --estimates is given.
#[derive(Args)]
pub struct Build {
    /// Mesh or scene to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write
    #[arg(value_name = "OUT.mlod")]
    output: PathBuf,
    /// Kind of model, by which the levels are made
    #[arg(long, value_name = "MODEL", default_value = "contractions")]
    model: ModelArg,
    #[arg(long, value_name = "NAME", default_value = Method::LindstromTurk.name(),
        help = parse::methods())]
    method: Method,
    /// Order of the contractions
    #[arg(long, value_name = "ORDER", default_value = "cost")]
    order: OrderArg,
    /// Compute proven error bounds in place of measured errors
    ///
    /// Levels of the same error have two to six times as many faces. The errors of right triangles
    /// are bounds in any case.
    #[arg(long)]
    bounds: bool,
    /// Keep estimates in place of measured errors: faster
    ///
    /// Building is about twice as fast. Cuts that go by the stored errors, such as those of
    /// extract --unverified, are then off by up to three times as much.
    #[arg(long, conflicts_with = "bounds")]
    estimates: bool,
    /// Largest displacement by rounding: 0.005% or a length
    ///
    /// A length is in model units, a percentage relative to the diagonal. Vertices move by a cell
    /// or two more where a triangle would lose its area.
    #[arg(long, value_name = "BOUND", value_parser = Tolerance::parse, default_value = "0.005%",
        allow_hyphen_values = true)]
    rounding: Tolerance,
    /// Keep the vertices of the mesh bit for bit
    ///
    /// Then extract --error 0 restores all its faces. Vertices of coarser levels move by about
    /// 0.002% of the diagonal. Where a node of glTF moves, turns or scales a mesh, coordinates
    /// smaller than 2^-28 of its size or of its distance from the origin, normals, tangents and
    /// texture coordinates may differ in their last bits.
    #[arg(long, conflicts_with = "rounding")]
    lossless: bool,
    /// Keep the volume of closed parts exactly in the finest cut
    ///
    /// Like --lossless, so that extract --exact-volume can give it to any other cut.
    #[arg(long, conflicts_with = "rounding")]
    exact_volume: bool,
    /// Approximate number of vertices in a chunk
    ///
    /// A chunk is the unit of reading: smaller chunks make a larger file of which a query reads
    /// less.
    #[arg(long, value_name = "N", value_parser = parse::positive, default_value_t = 4096,
        allow_negative_numbers = true)]
    in_chunk: usize,
    #[command(flatten)]
    attributes: AttributeErrorArgs,
    #[command(flatten)]
    constraints: ConstraintArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum ModelArg {
    /// Edge contractions, for any mesh
    Contractions,
    /// Right-triangle hierarchy, for a height field on a regular grid
    RightTriangles,
}

#[derive(Clone, Copy, ValueEnum)]
enum OrderArg {
    /// Their cost: quick
    Cost,
    /// The error they need: a fifth to a third fewer faces within the same error, for about ten
    /// times the time
    Error,
}

impl Build {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        model_file::check_output(&self.output)?;
        let reason = "a multiresolution file keeps the topology, since every level must lead back to the mesh";
        self.constraints.topology.keep(reason)?;
        if self.model == ModelArg::RightTriangles && self.constraints.holds_or_fuses() {
            return Err(Failure::usage(
                "right-triangles takes neither locks nor --fuse: its levels consist of vertices of the grid, which never move",
            ));
        }
        let hearing = Hearing::new(session, &self.input, &self.output);
        let failed = |error| hearing.failure(error);
        let rounding = self.rounding.bound("--rounding", &self.input, session)?;
        self.request(rounding, Constraints::default()).validate().map_err(failed)?;
        let (scene, fused) = self.constraints.read_fused(&self.input, &self.reading, session)?;
        self.rounding.doubt("--rounding", &self.input, &scene, session);
        let input = InputScene { scene: &scene, path: &self.input, reading: &self.reading };
        // The scene is fused already.
        let constraints = Constraints { fuse: false, ..self.constraints.constraints(&input)? };
        let request = self.request(rounding, constraints);
        let start = Instant::now();
        let (bytes, report) = jobs::build(scene, &request, &hearing).map_err(failed)?;
        scene_files::write_encoded(&self.output, &report.notes, &bytes, session)?;
        let time = start.elapsed();
        let text = report::to_text(&self.output, &report, fused.as_ref(), time);
        Ok(Answer::new(report::figures(&self.output, &report, fused, time), text))
    }

    fn request(&self, rounding: Bound, constraints: Constraints) -> BuildRequest {
        BuildRequest {
            method: self.method,
            model: match self.model {
                ModelArg::Contractions => LevelModel::Contractions,
                ModelArg::RightTriangles => LevelModel::RightTriangles,
            },
            order: match self.order {
                OrderArg::Cost => LevelOrder::Cost,
                OrderArg::Error => LevelOrder::Error,
            },
            errors: match (self.bounds, self.estimates) {
                (true, _) => ErrorKind::Bound,
                (false, true) => ErrorKind::Estimate,
                (false, false) => ErrorKind::Measured,
            },
            rounding,
            lossless: self.lossless,
            exact_volume: self.exact_volume,
            in_chunk: self.in_chunk,
            attributes: self.attributes.bounds(),
            constraints,
        }
    }
}
