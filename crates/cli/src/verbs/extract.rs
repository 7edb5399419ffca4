//! `extract`: takes one mesh out of a multiresolution file.

mod report;

use std::fs::File;
use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use meshlod::multires::{Extract as MeshExtract, FileError, Level, ModelFile, Query, ViewCamera};
use meshlod::simplify::{Digits, VolumeResidual};
use meshlod::{
    CutVolumeError, Format, Mesh, ModelScene, VerifiedExtract, conserve_cut_volume, digits_of,
    extract_verified, measure_extract,
};

use crate::answer::Answer;
use crate::args::WriteArgs;
use crate::failure::Failure;
use crate::files;
use crate::kept_error::{Asked, KeptError, Known};
use crate::model_file;
use crate::model_scene;
use crate::numbers::{faces, value};
use crate::parse::{self, Bound};
use crate::query_args::{self, ErrorLimit, FocusArg, QueryRequest};
use crate::session::Session;
use crate::verbs::extract::report::{Extracted, volume_text};

/// Extract one level from a multiresolution file: fine where it is needed, coarse elsewhere. glTF
/// gets the whole scene, with nodes, materials, skins and animations, other formats its surface
#[derive(Args)]
pub struct Extract {
    /// Multiresolution file to read
    #[arg(value_name = "IN.mlod")]
    input: PathBuf,
    /// File to write, or -
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    target: ExtractTarget,
    /// Camera for errors in pixels and the focus frustum: "eye=x,y,z look=x,y,z fov=45 1920x1080",
    /// with up=x,y,z unless y is up
    #[arg(long, value_name = "CAMERA", value_parser = query_args::camera)]
    camera: Option<ViewCamera>,
    /// Region where the error counts, coarse elsewhere: point=x,y,z for the point of the surface
    /// closest to it, segment=x,y,z,x,y,z, box=x,y,z,x,y,z, sphere=x,y,z,r, ground-line=x,y,x,y and
    /// ground-box=x,y,x,y for a line and a window on a map, or frustum for what the camera sees
    /// [default: everywhere]
    #[arg(long, value_name = "FOCUS", value_parser = query_args::focus, allow_hyphen_values = true)]
    focus: Option<FocusArg>,
    /// Vertical axis of ground-line and ground-box, which take the other two axes in the order x, y,
    /// z [default: that of the heights of right triangles, otherwise y]
    #[arg(long, value_name = "AXIS", requires = "focus")]
    up: Option<VerticalAxis>,
    /// Leave out faces that do not intersect the focus; of a point leave the nearest ones
    #[arg(long, requires = "focus")]
    only: bool,
    /// Move vertices along their normals, mostly by their last digits, until closed parts have the
    /// volume of the finest cut in the file, in the precision that is written: that of the mesh, if
    /// the file was built with --exact-volume or --lossless. Reads the whole file; vertices move on
    /// top of --error, and so do those that were locked, which the file does not know
    #[arg(long, conflicts_with = "only")]
    exact_volume: bool,
    /// Trust the errors in the file: faster, and reads only what the result needs, but places can be
    /// farther off than --error, and the error of --faces is not measured
    #[arg(long)]
    unverified: bool,
    #[command(flatten)]
    writing: WriteArgs,
}

/// Vertical axis of a model.
#[derive(Clone, Copy, ValueEnum)]
enum VerticalAxis {
    X,
    Y,
    Z,
}

/// Target of the extraction: an error or a number of faces.
#[derive(Args)]
#[group(required = true, multiple = false)]
struct ExtractTarget {
    /// Largest error: 1px as the camera sees it, 0.01% of the diagonal, or 0.5 in model units; 0 for
    /// the finest level. In the focus, every point of the result is as close to the mesh, and every
    /// point of the mesh to the result, which is proven
    #[arg(long, value_name = "BOUND", value_parser = query_args::error_limit, allow_hyphen_values = true)]
    error: Option<ErrorLimit>,
    /// The best mesh of at most N faces: for the camera if there is one, else from all sides. A mesh
    /// that several nodes show counts once
    #[arg(long, value_name = "N", value_parser = parse::whole, allow_negative_numbers = true)]
    faces: Option<usize>,
}

impl Extract {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        files::check_apart(&self.output, &[&self.input])?;
        let start = Instant::now();
        let file = model_file::open(&self.input, session)?;
        let mut taken = self.take(&file, session)?;
        let mut time = start.elapsed();
        let mesh = taken.level.mesh();
        if mesh.faces.is_empty() {
            return Err(Failure::at(&self.input, "no face intersects the focus"));
        }
        let counts = [mesh.positions.len(), mesh.faces.len()];
        if !taken.reaches(self.target.faces) {
            let coarsest = faces(taken.whole_faces);
            let reason = format_args!(
                "--faces {} is out of reach: the coarsest level has {coarsest}, and that is what was extracted",
                self.target.faces.unwrap_or_default(),
            );
            session.warn(Failure::at(&self.input, reason));
        }
        let model = model_scene::read(&self.input, &file, session)?;
        self.warn_of_instances(&model, format, session);
        let mut scene = model.flat_scene(name(&self.input), mesh);
        let spare = taken.error.spare(taken.rounding);
        let writing = self.writing.within(spare, &scene, format).of(&scene);
        let moves = scene.rounding(format, writing.options().precision);
        if moves > spare {
            let moved = format_args!("rounding to f32 moved coordinates by up to {}", value(moves));
            session.warn(Failure::at(&self.output, moved));
            taken.error.moved += 3f64.sqrt() * moves;
        }
        let mut restored = None;
        if self.exact_volume {
            let start = Instant::now();
            let digits = digits_of(format, writing.options().precision);
            restored = self.restore_volume(&mut scene.meshes[0].mesh, &file, digits, session)?;
            taken.error.moved += restored.map_or(0.0, |restored| restored.farthest);
            time += start.elapsed();
        }
        if let Some(warning) = taken.error.warning() {
            session.warn(Failure::at(&self.input, warning));
        }
        let asked = report::Request { output: &self.output, max_faces: self.target.faces, time };
        let mut json = taken.to_json(&asked, counts);
        json["volume_residual"] = restored.map(|restored| restored.after.abs()).into();
        json["volume_moved"] = restored.map(|restored| restored.farthest).into();
        let mut text = taken.to_text(&asked, counts);
        if let Some(restored) = &restored {
            text += &volume_text(restored, taken.lossless);
        }
        let scene = model_scene::restored(&self.input, model, scene, format)?;
        json["shown_faces"] = model_scene::shown_faces(&scene).into();
        files::write(&self.output, &scene, &writing, session)?;
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn take(&self, file: &ModelFile<File>, session: &Session) -> Result<Extracted, Failure> {
        let failed = |error| match error {
            FileError::Query(error) => Failure::usage(error),
            error => Failure::at(&self.input, error),
        };
        let query = self.query(file)?;
        let (query, nearest) = file.at_surface(&query, self.target.faces).map_err(failed)?;
        let (taken, known) = self.answer(file, &query, session).map_err(failed)?;
        let (rounding, lossless, error_kind, chunks) = match file {
            ModelFile::Contractions(archive) => (
                model_file::rounding(archive),
                archive.is_lossless(),
                model_file::error_kind(archive),
                [archive.complete_chunks(), archive.chunk_count()],
            ),
            ModelFile::HeightField(field, parts) => {
                let chunks = [parts.complete, parts.all].map(|parts| parts as usize);
                (field.fit().rounded, false, "bound", chunks)
            }
        };
        Ok(Extracted {
            whole_faces: taken.level.faces.len(),
            level: self.cut_out(taken.level, &query, nearest, session)?,
            rounding,
            lossless,
            error_kind,
            error: KeptError {
                asked: match self.target.error {
                    Some(_) => Asked::of(&query.tolerance),
                    None => Asked::Faces,
                },
                known,
                is_local: self.focus.is_some() && self.target.error.is_some(),
                is_whole: chunks[0] == chunks[1],
                moved: 0.0,
                diagonal: file.diagonal(),
            },
            chunks: [taken.chunks, chunks[0], chunks[1]],
            updates: taken.updates,
            bytes: taken.bytes,
        })
    }

    /// Extracts the mesh that a query asks for, and finds out about its error.
    fn answer(
        &self,
        file: &ModelFile<File>,
        query: &Query<'_>,
        session: &Session,
    ) -> Result<(MeshExtract, Known), FileError> {
        session.progress.stage("extracting");
        match self.target.faces {
            None if self.unverified => Ok((file.extract(query)?, Known::Stored)),
            None => {
                let VerifiedExtract { extract, verification } = extract_verified(file, query)?;
                Ok((extract, Known::Verified(verification)))
            }
            Some(faces) => {
                let taken = file.extract_at_most(faces, query)?;
                if self.unverified {
                    return Ok((taken, Known::Stored));
                }
                session.progress.stage("measuring the error");
                let error = measure_extract(file, &taken.level.mesh())?;
                Ok((taken, Known::Measured(error)))
            }
        }
    }

    /// Gives the closed parts of a cut the volume that they have in the finest cut; warns if that
    /// cannot be done.
    fn restore_volume(
        &self,
        cut: &mut Mesh,
        file: &ModelFile<File>,
        digits: Digits,
        session: &Session,
    ) -> Result<Option<VolumeResidual>, Failure> {
        session.progress.stage("restoring the volume");
        match conserve_cut_volume(cut, file, digits) {
            Ok(restored) => Ok(Some(restored)),
            Err(CutVolumeError::File(error)) => Err(Failure::at(&self.input, error)),
            Err(error) => {
                session.warn(format_args!("--exact-volume: {error}"));
                Ok(None)
            }
        }
    }

    /// Warns of what does not hold for each instance of a mesh, or not in its own space.
    fn warn_of_instances(&self, model: &ModelScene, format: Format, session: &Session) {
        if !model.is_flat() && (self.focus.is_some() || self.camera.is_some()) {
            session.warn(Failure::at(
                &self.input,
                "focus and camera count for the largest instance of each mesh; others are the same",
            ));
        }
        if self.exact_volume && model_scene::is_gltf(format) && !model.is_unmoved() {
            session.warn(
                "--exact-volume: nodes move, turn or scale meshes, whose coordinates are rounded again",
            );
        }
    }

    fn query(&self, file: &ModelFile<File>) -> Result<Query<'static>, Failure> {
        // A number of faces is spread as for an error of one pixel, or evenly.
        let alike = match self.camera {
            Some(_) => ErrorLimit::Pixels(1.0),
            None => ErrorLimit::Length(Bound::OfDiagonal(1.0)),
        };
        let error = self.target.error.unwrap_or(alike);
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

    fn cut_out(
        &self,
        level: Level,
        query: &Query<'_>,
        nearest: Option<[f64; 3]>,
        session: &Session,
    ) -> Result<Level, Failure> {
        match nearest {
            _ if !self.only => {
                let has_focus = self.focus.is_some() && nearest.is_none();
                let missed = || level.within(&query.focus).map(|near| near.faces.is_empty());
                if has_focus && missed().map_err(Failure::usage)? {
                    session.warn(Failure::at(
                        &self.input,
                        "no face intersects the focus, so all are as coarse as the file has them",
                    ));
                }
                Ok(level)
            }
            Some(point) => level.nearest(point).map_err(Failure::usage),
            None => level.within(&query.focus).map_err(Failure::usage),
        }
    }
}

/// Returns the file name without its suffix.
fn name(path: &std::path::Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
