//! Options of verbs that take a cut out of a multiresolution file, and its extraction.

use std::fs::File;
use std::path::Path;

use clap::{Args, ValueEnum};
use meshlod::multires::{Extract, FileError, ModelFile, Query, ViewCamera};
use meshlod::{VerifiedExtract, extract_verified, measure_extract};

use crate::options::parse::{self, Bound};
use crate::options::query_args::{self, ErrorLimit, FocusArg, QueryRequest};
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::model_file;
use crate::text::kept_error::{Asked, KeptError, Known};
use crate::text::numbers::faces;

/// Options of verbs that read one cut out of a multiresolution file.
#[derive(Args)]
#[command(next_help_heading = "Query of an .mlod file")]
pub struct QueryArgs {
    #[command(flatten)]
    pub target: QueryTarget,
    /// Camera for errors in pixels and the focus frustum: "eye=x,y,z look=x,y,z fov=45 1920x1080",
    /// with up=x,y,z unless y is up
    #[arg(long, value_name = "CAMERA", value_parser = query_args::camera)]
    pub camera: Option<ViewCamera>,
    /// Region where the error counts, coarse elsewhere: point=x,y,z for the point of the surface
    /// closest to it, segment=x,y,z,x,y,z, box=x,y,z,x,y,z, sphere=x,y,z,r, ground-line=x,y,x,y and
    /// ground-box=x,y,x,y for a line and a window on a map, or frustum for what the camera sees
    /// [default: everywhere]
    #[arg(long, value_name = "FOCUS", value_parser = query_args::focus, allow_hyphen_values = true)]
    pub focus: Option<FocusArg>,
    /// Vertical axis of ground-line and ground-box, which take the other two axes in the order x, y,
    /// z [default: that of the heights of right triangles, otherwise y]
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
pub struct QueryTarget {
    /// Largest error: 1px as the camera sees it, 0.01% of the diagonal of the meshes as
    /// they are stored, whatever nodes make of them, or 0.5 in model units; 0 for the finest level. In the focus, every point of the result is as close to the mesh, and every
    /// point of the mesh to the result, which is proven
    #[arg(short, long, value_name = "BOUND", value_parser = query_args::error_limit,
        allow_hyphen_values = true)]
    pub error: Option<ErrorLimit>,
    /// The best mesh of at most N faces: for the camera if there is one, else from all sides. A mesh
    /// that several nodes show counts once
    #[arg(short, long, value_name = "N", value_parser = parse::whole,
        allow_negative_numbers = true)]
    pub faces: Option<usize>,
}

impl QueryArgs {
    /// Fails unless there is an error or a number of faces to ask for.
    pub fn check_target(&self) -> Result<(), Failure> {
        match self.target.error.is_some() || self.target.faces.is_some() {
            true => Ok(()),
            false => Err(Failure::usage("a multiresolution file needs --error or --faces")),
        }
    }

    /// Returns true if any of the options was given.
    pub fn is_given(&self) -> bool {
        let Self { target: QueryTarget { error, faces }, camera, focus, up } = self;
        let is_region = camera.is_some() || focus.is_some() || up.is_some();
        error.is_some() || faces.is_some() || is_region
    }

    /// Returns true if the answer is finer in some places than in others.
    pub fn is_local(&self) -> bool {
        self.focus.is_some() || self.camera.is_some()
    }

    /// Returns the query that the options ask for.
    pub fn query(&self, file: &ModelFile<File>) -> Result<Query<'static>, Failure> {
        // A number of faces is spread as for an error of one pixel, or evenly.
        let alike = match self.camera {
            Some(_) => ErrorLimit::Pixels(1.0),
            None => ErrorLimit::Length(Bound::OfDiagonal(1.0)),
        };
        self.query_for(self.target.error.unwrap_or(alike), file)
    }

    /// Returns the query for another error than the options have.
    pub fn query_for(
        &self,
        error: ErrorLimit,
        file: &ModelFile<File>,
    ) -> Result<Query<'static>, Failure> {
        let up = self.up_axis(file)?;
        QueryRequest { error, focus: self.focus.clone(), camera: self.camera, up }
            .query(file.diagonal())
    }

    /// Returns the vertical axis for a focus on the ground.
    fn up_axis(&self, file: &ModelFile<File>) -> Result<usize, Failure> {
        let given = self.up.map(|up| up as usize);
        match (file.up(), given) {
            (Some(own), Some(given)) if own != given => Err(Failure::usage(format_args!(
                "--up: the heights of this file are along {}",
                ["x", "y", "z"][own]
            ))),
            (own, given) => Ok(own.or(given).unwrap_or(VerticalAxis::Y as usize)),
        }
    }

    /// Extracts the mesh that a query asks for, and finds out about its error.
    pub fn answer(
        &self,
        file: &ModelFile<File>,
        query: &Query<'_>,
        unverified: bool,
        session: &Session,
    ) -> Result<(Extract, Known), FileError> {
        session.progress.stage("extracting");
        match self.target.faces {
            None if unverified => Ok((file.extract(query)?, Known::Stored)),
            None => {
                let VerifiedExtract { extract, verification } = extract_verified(file, query)?;
                Ok((extract, Known::Verified(verification)))
            }
            Some(faces) => {
                let taken = file.extract_at_most(faces, query)?;
                if unverified {
                    return Ok((taken, Known::Stored));
                }
                session.progress.stage("measuring the error");
                let error = measure_extract(file, &taken.level.mesh())?;
                Ok((taken, Known::Measured(error)))
            }
        }
    }

    /// Returns true if a cut has no more faces than asked for; warns if it has more, since nothing is
    /// coarser. `done` says what is done with it.
    pub fn reaches(&self, input: &Path, found: usize, done: &str, session: &Session) -> bool {
        let Some(most) = self.target.faces.filter(|&most| found > most) else { return true };
        let found = faces(found);
        let reason = format_args!(
            "--faces {most} is out of reach: the coarsest level has {found}, and that is what was {done}"
        );
        session.miss(&Failure::at(input, reason));
        false
    }

    /// Returns what is known about the error of the mesh that a query gave.
    pub fn kept_error(&self, file: &ModelFile<File>, query: &Query<'_>, known: Known) -> KeptError {
        KeptError {
            asked: match self.target.error {
                Some(_) => Asked::of(&query.tolerance),
                None => Asked::Faces,
            },
            known,
            is_local: self.focus.is_some() && self.target.error.is_some(),
            is_whole: model_file::is_whole(file),
            moved: 0.0,
            diagonal: file.diagonal(),
            in_poses: None,
        }
    }
}
