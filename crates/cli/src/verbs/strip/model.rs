//! `strip` of multiresolution files: the scene of one cut.

use meshlod::io::Precision;
use meshlod::multires::FileError;
use meshlod::{Format, Scene, shown_rounding};

use super::{Strip, output};
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::model_file;
use crate::text::kept_error::KeptError;
use crate::text::model_scene;

/// Scene of a cut.
pub(super) struct CutScene {
    pub scene: Scene,
    pub error: KeptError,
    /// True if it is as close or as coarse as asked.
    pub reached: bool,
}

impl Strip {
    /// Returns true if the input is a multiresolution file; refuses options of the other kind.
    pub(super) fn reads_model(&self) -> Result<bool, Failure> {
        if !model_file::is_model(&self.input) {
            return match self.query.is_given() || !self.follow.is_empty() {
                false => Ok(false),
                true => Err(Failure::usage(format_args!(
                    "{}: --error, --faces, --camera, --focus and --follow need an .mlod file, which \
                     build writes; use --levels",
                    files::name(&self.input)
                ))),
            };
        }
        if self.constraints.holds_or_fuses() {
            return Err(Failure::usage(
                "a cut is stripped as it is in the .mlod file: give locks and --fuse to build",
            ));
        }
        if self.reading.is_given() {
            return Err(Failure::usage("--weld and --no-weld are for meshes, not for .mlod files"));
        }
        Ok(true)
    }

    /// Extracts the cut that the options ask for.
    pub(super) fn read_cut(&self, session: &Session) -> Result<CutScene, Failure> {
        self.query.check_target()?;
        let file = model_file::open(&self.input, session)?;
        let failed = |error: FileError| model_file::failure(&self.input, error);
        let model = model_scene::read(&self.input, &file, session)?;
        let asked = self.query.query(&file)?;
        let most = self.query.target.faces;
        let (query, _) = model_scene::query(&self.input, (&file, &model), &asked, most)?;
        // The distance of the best mesh of some number of faces is a question for `extract`.
        let answer = self.query.answer(&file, &query, most.is_some(), session);
        let (taken, known) = answer.map_err(failed)?;
        let mut error = self.query.kept_error(&file, &asked, known);
        error.warning().into_iter().for_each(|text| session.miss(&Failure::at(&self.input, text)));
        let found = taken.level.faces.len();
        let reached = self.query.reaches(&self.input, found, "stripped", session);
        let flat = model.flat_scene(files::stem(&self.input), taken.level.mesh());
        let scene = model_scene::restored(&self.input, model, flat, Format::Glb)?;
        if self.out.as_deref().is_some_and(output::holds_scene) {
            error.note_rounding(shown_rounding(&scene, Format::Glb, Precision::F32));
        }
        let reached = reached && error.is_kept() != Some(false);
        Ok(CutScene { scene, error, reached })
    }
}
