//! `extract`: takes one mesh out of a multiresolution file.

mod report;

use std::fs::File;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use meshlod::multires::{FileError, Level, ModelFile, Query};
use meshlod::simplify::{Digits, VolumeResidual};
use meshlod::{
    CutVolumeError, Format, Mesh, ModelScene, conserve_cut_volume, digits_of, shown_rounding,
};

use crate::options::args::WriteArgs;
use crate::options::model_query::QueryArgs;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::model_file;
use crate::session::scene_files;
use crate::text::kept_error::{KeptError, PosedError};
use crate::text::model_scene;
use crate::text::numbers::value;
use report::Extracted;

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
    query: QueryArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

impl Extract {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        files::check_apart(&self.output, &[&self.input])?;
        self.query.check_target()?;
        let start = Instant::now();
        let file = model_file::open(&self.input, session)?;
        let model = model_scene::read(&self.input, &file, session)?;
        let mut taken = self.take(&file, &model, session)?;
        let mut time = start.elapsed();
        let mesh = taken.level.mesh();
        if mesh.faces.is_empty() {
            return Err(Failure::at(&self.input, "no face intersects the focus"));
        }
        let counts = [mesh.positions.len(), mesh.faces.len()];
        let reached = self.query.reaches(&self.input, taken.whole_faces, "extracted", session);
        self.warn_of_moved_meshes(&model, format, session);
        let mut scene = model.flat_scene(files::stem(&self.input), mesh);
        let spare = taken.error.spare(taken.rounding);
        let writing = self.writing.within(spare, &scene, format).of(&scene);
        let precision = writing.options().precision;
        let is_taken_back = model_scene::is_gltf(format) && !model.is_unmoved();
        let mut moves = scene.rounding(format, precision);
        let mut restored = None;
        if self.exact_volume {
            let start = Instant::now();
            let digits = digits_of(format, precision);
            restored = self.restore_volume(&mut scene.meshes[0].mesh, &file, digits, session)?;
            taken.error.moved += restored.map_or(0.0, |restored| restored.farthest);
            time += start.elapsed();
        }
        model_scene::note_merged(&self.output, &model, format, session)?;
        let scene = model_scene::restored(&self.input, model, scene, format)?;
        if is_taken_back {
            moves = shown_rounding(&scene, format, precision);
        }
        taken.error.note_rounding(moves);
        let is_kept = taken.error.is_kept() != Some(false);
        if moves > spare {
            let moved = format_args!("rounding to f32 moved coordinates by up to {}", value(moves));
            let moved = Failure::at(&self.output, moved);
            if is_kept { session.warn(moved) } else { session.miss(&moved) }
        }
        if let Some(warning) = taken.error.warning() {
            session.miss(&Failure::at(&self.input, warning));
        }
        let reached = reached && is_kept;
        let shown = model_scene::shown_faces(&scene);
        let done = report::Done { output: &self.output, counts, shown, reached, restored, time };
        let (figures, text) = (taken.figures(&done), taken.to_text(&done));
        scene_files::write(&self.output, &scene, &writing, session)?;
        Ok(Answer {
            file_on_stdout: files::is_pipe(&self.output),
            outcome: Outcome::Missed.when(session.strict && !reached),
            ..Answer::new(figures, text)
        })
    }

    fn take(
        &self,
        file: &ModelFile<File>,
        model: &ModelScene,
        session: &Session,
    ) -> Result<Extracted, Failure> {
        let failed = |error: FileError| model_file::failure(&self.input, error);
        let asked = self.query.query(file)?;
        let most = self.query.target.faces;
        let (query, nearest) = model_scene::query(&self.input, (file, model), &asked, most)?;
        let (taken, known) =
            self.query.answer(file, &query, self.unverified, session).map_err(failed)?;
        let in_poses = self.in_poses((file, model), &taken.level, session).map_err(failed)?;
        let (rounding, lossless, error_kind) = match file {
            ModelFile::Contractions(archive) => (
                model_file::rounding(archive),
                archive.is_lossless(),
                model_file::error_kind(archive),
            ),
            ModelFile::HeightField(field, _) => (field.fit().rounded, false, "bound"),
        };
        let [there, all] = file.pieces();
        Ok(Extracted {
            whole_faces: taken.level.faces.len(),
            level: self.cut_out(taken.level, &query, nearest, session)?,
            rounding,
            lossless,
            error_kind,
            error: KeptError { in_poses, ..self.query.kept_error(file, &asked, known) },
            chunks: [taken.chunks, there, all],
            updates: taken.updates,
            bytes: taken.bytes,
        })
    }

    /// Returns the error of a cut in the poses in which errors were measured, by what the file says.
    fn in_poses(
        &self,
        (file, model): (&ModelFile<File>, &ModelScene),
        level: &Level,
        session: &Session,
    ) -> Result<Option<PosedError>, FileError> {
        let (ModelFile::Contractions(archive), Some(poses)) = (file, model.poses()) else {
            return Ok(None);
        };
        let [there, all] = file.pieces();
        if self.unverified || self.query.is_local() || there < all {
            return Ok(Some(PosedError { poses, stored: None }));
        }
        session.progress.stage("reading errors in poses");
        let rounding = if archive.is_lossless() { 0.0 } else { archive.rounding() };
        let stored = archive.error_of(level)? + rounding;
        Ok(Some(PosedError { poses, stored: Some(stored) }))
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

    /// Warns of what does not hold in a mesh's own space.
    fn warn_of_moved_meshes(&self, model: &ModelScene, format: Format, session: &Session) {
        if self.exact_volume && model_scene::is_gltf(format) && !model.is_unmoved() {
            session.warn(
                "--exact-volume: nodes move, turn or scale meshes, whose coordinates are rounded again",
            );
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
                let has_focus = self.query.focus.is_some() && nearest.is_none();
                let missed = || level.where_asked(query).map(|near| near.faces.is_empty());
                if has_focus && missed().map_err(Failure::usage)? {
                    session.warn(Failure::at(
                        &self.input,
                        "no face intersects the focus, so all are as coarse as the file has them; info shows the bounds",
                    ));
                }
                Ok(level)
            }
            Some(point) => level.nearest(point).map_err(Failure::usage),
            None => level.where_asked(query).map_err(Failure::usage),
        }
    }
}
