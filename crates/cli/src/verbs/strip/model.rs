//! `strip` of multiresolution files: the scene of one cut.

use meshlod::io::Precision;
use meshlod::jobs::{self, ExtractReport, ExtractRequest, KeptError, WrittenAs};
use meshlod::{Format, Scene};

use super::{Strip, output};
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::model_file;
use crate::text::kept_error;

/// Scene of a cut.
pub(super) struct CutScene {
    pub scene: Scene,
    pub error: KeptError,
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
        self.query.warn_of_error(&file, session);
        let hearing = Hearing::new(session, &self.input, &self.input);
        let done = jobs::extract(model_file::levels(&file)?, &self.cut_request(), &hearing);
        let (scene, report) = done.map_err(|error| hearing.failure(error))?;
        session.note(&self.input, &scene.notes)?;
        let ExtractReport { error, level_faces, .. } = report;
        let warning = kept_error::warning(&error);
        warning.into_iter().for_each(|text| session.miss(&Failure::at(&self.input, text)));
        self.query.warn_of_faces(&self.input, level_faces, "stripped", session);
        Ok(CutScene { scene, error })
    }

    fn cut_request(&self) -> ExtractRequest {
        let query = self.query.request();
        let is_written = self.out.as_deref().is_some_and(output::holds_scene);
        ExtractRequest {
            // The distance of the best mesh of some number of faces is a question for `extract`.
            verify: query.most_faces().is_none(),
            query,
            written_as: is_written
                .then_some(WrittenAs { format: Format::Glb, precision: Precision::F32 }),
            name: files::stem(&self.input),
            ..ExtractRequest::default()
        }
    }
}
