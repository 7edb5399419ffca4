//! `extract`: takes one mesh out of a multiresolution file.

use std::fs::File;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use meshlod::Scene;
use meshlod::multires::{
    Archive, FileError, HeightField, Level, ModelFile, Query, Rtin, RtinExtractor, ViewCamera,
};
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::args::WriteArgs;
use crate::failure::Failure;
use crate::files;
use crate::model_file;
use crate::numbers::{count, faces, plural, value};
use crate::parse::{self, Bound};
use crate::query_args::{self, ErrorLimit, FocusArg, QueryRequest};
use crate::session::Session;

/// Extract one mesh from a multiresolution file: fine where it is needed, coarse elsewhere
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
    /// Region where the error counts, coarse elsewhere: point=x,y,z, segment=x,y,z,x,y,z,
    /// box=x,y,z,x,y,z, sphere=x,y,z,r, or frustum for what the camera sees [default: everywhere]
    #[arg(long, value_name = "FOCUS", value_parser = query_args::focus, allow_hyphen_values = true)]
    focus: Option<FocusArg>,
    /// Leave out faces that do not intersect the focus
    #[arg(long, requires = "focus")]
    only: bool,
    #[command(flatten)]
    writing: WriteArgs,
}

/// Target of the extraction: an error or a number of faces.
#[derive(Args)]
#[group(required = true, multiple = false)]
struct ExtractTarget {
    /// Largest error, by the measured errors, estimates or bounds in the file: 1px as the camera sees it, 0.01% of
    /// the diagonal, or 0.5 in model units; 0 leaves out only detail that changes nothing
    #[arg(long, value_name = "BOUND", value_parser = query_args::error_limit, allow_hyphen_values = true)]
    error: Option<ErrorLimit>,
    /// The best mesh of at most N faces: for the camera if there is one, else from all sides
    #[arg(long, value_name = "N", value_parser = parse::whole, allow_negative_numbers = true)]
    faces: Option<usize>,
}

/// Extracted level with the figures on what was read.
struct Extracted {
    level: Level,
    /// Largest displacement of its vertices when the file was built.
    rounding: f64,
    lossless: bool,
    error_kind: &'static str,
    /// Chunks read, present and in total.
    chunks: [usize; 3],
    updates: usize,
    bytes: u64,
}

impl Extract {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let format = files::check_output(&self.output, session)?;
        files::check_apart(&self.output, &[&self.input])?;
        let start = Instant::now();
        let taken = match model_file::open(&self.input, session)? {
            ModelFile::Contractions(archive) => self.take_contractions(&archive)?,
            ModelFile::HeightField(field) => self.take_field(&field)?,
        };
        let time = start.elapsed();
        let mesh = taken.level.mesh();
        if mesh.faces.is_empty() {
            return Err(Failure::at(&self.input, "no face intersects the focus"));
        }
        let counts = [mesh.positions.len(), mesh.faces.len()];
        if self.target.faces.is_some_and(|most| taken.level.faces.len() > most) {
            let reason = format_args!("its coarsest level has {}", faces(counts[1]));
            session.warn(Failure::at(&self.input, reason));
        }
        let scene = Scene::from_mesh(name(&self.input), mesh);
        let (json, text) = (self.json(&taken, counts, time), self.text(&taken, counts, time));
        let writing = self.writing.within(taken.rounding, &scene, format);
        let moves = writing.moves(&scene, format);
        if moves > taken.rounding {
            let moved = format_args!("rounding to f32 moved coordinates by up to {}", value(moves));
            session.warn(Failure::at(&self.output, moved));
        }
        files::write(&self.output, &scene, &writing, session)?;
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn take_contractions(&self, archive: &Archive<File>) -> Result<Extracted, Failure> {
        let query = self.query(archive.diagonal())?;
        let taken = match self.target.faces {
            None => archive.extract(&query),
            Some(faces) => archive.extract_at_most(faces, &query),
        };
        let taken = taken.map_err(|error| match error {
            FileError::Query(error) => Failure::usage(error),
            error => Failure::at(&self.input, error),
        })?;
        Ok(Extracted {
            level: self.cut_out(taken.level, &query)?,
            rounding: model_file::rounding(archive),
            lossless: archive.is_lossless(),
            error_kind: model_file::error_kind(archive),
            chunks: [taken.chunks, archive.complete_chunks(), archive.chunk_count()],
            updates: taken.updates,
            bytes: taken.bytes,
        })
    }

    fn take_field(&self, field: &HeightField) -> Result<Extracted, Failure> {
        let query = self.query(field.bounds().diagonal())?;
        let model = Rtin::new(field);
        let level = match self.target.faces {
            None => model.level(&query),
            Some(faces) => RtinExtractor::new(&model).at_most(faces, &query).cloned(),
        };
        let level = level.map_err(Failure::usage)?;
        let bytes = std::fs::metadata(&self.input).map_or(0, |data| data.len());
        let updates = field.heights().len();
        Ok(Extracted {
            level: self.cut_out(level, &query)?,
            rounding: field.fit().rounded,
            lossless: false,
            error_kind: "bound",
            chunks: [1; 3],
            updates,
            bytes,
        })
    }

    fn query(&self, diagonal: f64) -> Result<Query<'static>, Failure> {
        // A number of faces is spread as for an error of one pixel, or evenly.
        let alike = match self.camera {
            Some(_) => ErrorLimit::Pixels(1.0),
            None => ErrorLimit::Length(Bound::OfDiagonal(1.0)),
        };
        let error = self.target.error.unwrap_or(alike);
        QueryRequest { error, focus: self.focus.clone(), camera: self.camera }.query(diagonal)
    }

    fn cut_out(&self, level: Level, query: &Query<'_>) -> Result<Level, Failure> {
        match self.only {
            true => level.within(&query.focus).map_err(Failure::usage),
            false => Ok(level),
        }
    }

    fn json(&self, taken: &Extracted, [vertices, faces]: [usize; 2], time: Duration) -> Value {
        json!({
            "file": files::name(&self.output),
            "vertices": vertices,
            "faces": faces,
            "error_kind": taken.error_kind,
            "lossless": taken.lossless,
            "chunks": taken.chunks[2],
            "chunks_there": taken.chunks[1],
            "chunks_read": taken.chunks[0],
            "updates_read": taken.updates,
            "bytes_read": taken.bytes,
            "extract_seconds": time.as_secs_f64(),
        })
    }

    fn text(&self, taken: &Extracted, [vertices, all]: [usize; 2], time: Duration) -> String {
        let [read, _, chunks] = taken.chunks;
        format!(
            "{}: {} vertices, {}\nread {read} of {chunks} chunk{}, {} bytes\nextract_seconds: {}\n",
            files::name(&self.output),
            count(vertices),
            faces(all),
            plural(chunks),
            count(taken.bytes as usize),
            value(time.as_secs_f64()),
        )
    }
}

/// Returns the file name without its suffix.
fn name(path: &std::path::Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
