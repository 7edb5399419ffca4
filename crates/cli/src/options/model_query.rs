//! Options of verbs that take a cut out of a multiresolution file.

use std::path::Path;

use clap::{Args, ValueEnum};
use meshlod::AnyFile;
use meshlod::jobs::{FocusRequest, QueryRequest, QueryTarget};
use meshlod::multires::{ModelFile, ViewCamera};

use crate::options::doubt;
use crate::options::parse;
use crate::options::query_args::{self, CAMERA, ErrorLimit};
use crate::session::Session;
use crate::session::failure::Failure;
use crate::text::numbers::faces;

/// Options of verbs that read one cut out of a multiresolution file.
#[derive(Args)]
#[command(next_help_heading = "Query of an .mlod file")]
pub struct QueryArgs {
    #[command(flatten)]
    pub target: QueryTargetArgs,
    /// Camera: "eye=x,y,z look=x,y,z fov=45 1920x1080"
    ///
    /// Errors in pixels and the focus `frustum` refer to it. Add up=x,y,z unless y is up.
    #[arg(long, value_name = "CAMERA", value_parser = query_args::camera)]
    pub camera: Option<ViewCamera>,
    /// Region where the error counts [default: everywhere]
    ///
    /// The level is coarse elsewhere. One of point=x,y,z for the point of the surface closest to
    /// it, segment=x,y,z,x,y,z, box=x,y,z,x,y,z, sphere=x,y,z,r, ground-line=x,y,x,y and
    /// ground-box=x,y,x,y for a line and a window on a map, or frustum for what the camera sees.
    #[arg(long, value_name = "FOCUS", value_parser = query_args::focus, allow_hyphen_values = true)]
    pub focus: Option<FocusRequest>,
    /// Vertical axis of ground-line and ground-box
    ///
    /// These take the other two axes in the order x, y, z. The default is the axis of the heights
    /// for right triangles, otherwise y.
    #[arg(long, value_name = "AXIS", requires = "focus")]
    up: Option<VerticalAxis>,
}

/// Vertical axis of a model.
#[derive(Clone, Copy, ValueEnum)]
enum VerticalAxis {
    X,
    Y,
    Z,
}

/// Target of a query: an error or a number of faces.
#[derive(Args)]
#[group(multiple = false)]
pub struct QueryTargetArgs {
    /// Largest error: 0.01%, 0.5 or 1px; 0 for the finest level
    ///
    /// 1px is a pixel of the camera, 0.01% a part of the diagonal of the meshes as they are stored,
    /// whatever nodes make of them, and 0.5 a length in model units. In the focus, every point of
    /// the result is as close to the mesh, and every point of the mesh to the result: this is
    /// proved.
    #[arg(short, long, value_name = "BOUND", value_parser = query_args::error_limit,
        allow_hyphen_values = true)]
    pub error: Option<ErrorLimit>,
    /// Largest number of faces: the best mesh within it
    ///
    /// Best for the camera if there is one, else from all sides. A mesh that several nodes show
    /// counts once.
    #[arg(short, long, value_name = "N", value_parser = parse::whole,
        allow_negative_numbers = true)]
    pub faces: Option<usize>,
}

impl QueryArgs {
    /// Fails unless there is an error or a number of faces to ask for, and a camera for pixels.
    pub fn check_target(&self) -> Result<(), Failure> {
        match (self.target.error, self.target.faces) {
            (Some(ErrorLimit::Pixels(_)), _) if self.camera.is_none() => Err(Failure::usage(
                format_args!("--error: pixels need a camera: --camera \"{CAMERA}\""),
            )),
            (Some(_), _) | (_, Some(_)) => Ok(()),
            (None, None) => Err(Failure::usage(
                "a multiresolution file needs --error or --faces, such as --error 0.1% or --faces 5k",
            )),
        }
    }

    /// Returns true if any of the options was given.
    pub fn is_given(&self) -> bool {
        let Self { target: QueryTargetArgs { error, faces }, camera, focus, up } = self;
        let is_region = camera.is_some() || focus.is_some() || up.is_some();
        error.is_some() || faces.is_some() || is_region
    }

    /// Returns the query that the options ask for.
    pub fn request(&self) -> QueryRequest {
        let target = match (self.target.error, self.target.faces) {
            (None, Some(most)) => QueryTarget::Faces(most),
            (Some(limit), _) => QueryTarget::Error(limit),
            (None, None) => QueryTarget::default(),
        };
        QueryRequest {
            target,
            focus: self.focus.clone().unwrap_or_default(),
            camera: self.camera,
            up: self.up.map(|up| up as usize),
        }
    }

    /// Returns the query for another error than the options have.
    pub fn request_for(&self, limit: ErrorLimit) -> QueryRequest {
        QueryRequest { target: QueryTarget::Error(limit), ..self.request() }
    }

    /// Warns of an error that is probably meant as a percentage.
    pub fn warn_of_error(&self, file: &AnyFile, session: &Session) {
        let Some(ErrorLimit::Length(bound)) = self.target.error else { return };
        let diagonal = file.levels().map_or(0.0, ModelFile::diagonal);
        session.doubt(file.path(), doubt::of_bound("--error", bound, diagonal));
    }

    /// Warns if a cut has more faces than asked for, since nothing is coarser. `done` says what is
    /// done with it.
    pub fn warn_of_faces(&self, input: &Path, found: usize, done: &str, session: &Session) {
        let Some(most) = self.target.faces.filter(|&most| found > most) else { return };
        let found = faces(found);
        let reason = format_args!(
            "--faces {most} is out of reach: the coarsest level has {found}, and that is what was {done}"
        );
        session.miss(&Failure::at(input, reason));
    }
}
