//! `build`: writes all levels of a mesh to one file.

mod report;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::{Args, ValueEnum};
use meshlod::io::Note;
use meshlod::multires::{
    Archive, BuildError, Forest, HeightField, HeightPrecision, ModelFile, Recorder, Storage,
    StoredErrors,
};
use meshlod::simplify::Simplifier;
use meshlod::{
    Format, Mesh, Method, Options, PackedScene, PlacedScene, PoseCounts, Scene, SceneCounts,
    Target, model_limits,
};

use crate::options::args::{AttributeErrorArgs, ReadArgs};
use crate::options::constraints::{ConstraintArgs, FlatInput};
use crate::options::fuse;
use crate::options::parse::{self, Bound};
use crate::options::volume;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::model_file;
use crate::session::scene_files;
use crate::text::model_scene::{self, ErrorPoses};
use crate::text::numbers::{percent, value};
use crate::verbs::build::report::{Built, Levels};

/// Write all levels of a mesh or scene to one multiresolution file (.mlod). The topology is kept,
/// and locks hold in every level: tied vertices are locked. Nodes, materials, images, skins, morph
/// targets and animations come back with extract. A mesh that several nodes show is stored once, and
/// errors hold for the largest of them; in the pose of the file they are measured, proved or estimated,
/// and in up to 64 poses of its animations they are measured too, unless --bounds or --estimates is given
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
    /// Compute proven error bounds in place of measured errors: levels of the same error have two to
    /// six times as many faces. The errors of right triangles are bounds in any case
    #[arg(long)]
    bounds: bool,
    /// Keep the method's smoothed estimates in place of measured errors: two to three times faster.
    /// Cuts that go by what the file says, such as those of extract --unverified, are then off by up
    /// to three times as much
    #[arg(long, conflicts_with = "bounds")]
    estimates: bool,
    /// Largest displacement of a vertex by rounding: 0.001 in model units, or 0.005% of the
    /// diagonal; by a cell or two more where a triangle would lose its area
    #[arg(long, value_name = "BOUND", value_parser = parse::bound, default_value = "0.005%",
        allow_hyphen_values = true)]
    rounding: Bound,
    /// Keep the vertices of the mesh bit for bit, so that extract --error 0 restores all its faces;
    /// vertices of coarser levels move by about 0.002% of the diagonal. Where a node of glTF moves,
    /// turns or scales a mesh, coordinates smaller than 2^-28 of its size or of its distance from the
    /// origin, normals and tangents may differ in their last bits, and so may texture coordinates
    #[arg(long, conflicts_with = "rounding")]
    lossless: bool,
    /// Keep the volume of closed parts exactly in the finest cut, as --lossless does, so that extract
    /// --exact-volume gives it to any other cut
    #[arg(long, conflicts_with = "rounding")]
    exact_volume: bool,
    /// Approximate number of vertices in a chunk, the unit of reading: smaller chunks make a larger
    /// file of which a query reads less
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
        if self.exact_volume && self.model == ModelArg::RightTriangles {
            return Err(Failure::usage(
                "--exact-volume does not go with right-triangles: a height field encloses no volume",
            ));
        }
        if self.lossless && self.model == ModelArg::RightTriangles {
            return Err(Failure::usage(
                "--lossless does not go with right-triangles, which move vertices to a grid; use --rounding 0 to keep the heights",
            ));
        }
        let options = Options { method: self.method, ..Options::default() };
        let (scene, fused) = self.constraints.read_fused(&self.input, &self.reading, session)?;
        self.attributes.refine_for(&scene);
        let (PlacedScene { mesh, options, mut rest, counts }, mut notes) = match self.model {
            ModelArg::Contractions => {
                let notes = model_limits(&scene);
                let path = (self.input.as_path(), &self.reading);
                (self.constraints.place(scene, path, options, session)?, notes)
            }
            ModelArg::RightTriangles => self.place_field(scene, options, session)?,
        };
        self.lossless |= self.exact_volume;
        if self.exact_volume {
            volume::warn_if_open(&mesh, session);
        }
        let start = Instant::now();
        let built = match self.model {
            ModelArg::Contractions => self.contractions(&mesh, &options, rest.as_mut(), session)?,
            ModelArg::RightTriangles => self.right_triangles(&mesh)?,
        };
        notes.extend(scene_files::unused_parts(&mesh, built.faces));
        scene_files::write_encoded(&self.output, &notes, &built.bytes, session)?;
        let time = start.elapsed();
        let scene = rest.is_some().then_some(counts);
        let figures = self.figures(&mesh, &built, (fused, scene), time);
        let mut text = fuse::to_text(fused.as_ref()) + &self.text(&mesh, &built, time);
        if rest.is_some() {
            text += &model_scene::counts_text(&counts, built.poses);
        }
        Ok(Answer::new(figures, text))
    }

    fn contractions(
        &self,
        mesh: &Mesh,
        options: &Options,
        mut rest: Option<&mut PackedScene>,
        session: &Session,
    ) -> Result<Built, Failure> {
        let failed = |error: BuildError| Failure::at(&self.input, error);
        let options = Forest::options(mesh, options);
        let mut simplifier =
            Simplifier::new(mesh, &options).map_err(|error| failed(error.into()))?;
        let watch = session.progress.contractions("contracting", Some(mesh.faces.len()));
        let recorder = if self.lossless { Recorder::lossless } else { Recorder::new };
        let mut both = (recorder(&simplifier), watch);
        let report = simplifier.run(Target::Faces(0), &mut both);
        let held = report.map_err(|error| failed(error.into()))?.held;
        let mut forest = both.0.into_forest().map_err(failed)?;
        session.progress.stage("measuring errors");
        let poses = self.pose(&mut forest, mesh, rest.as_deref_mut(), session);
        if self.bounds {
            forest.measure_bounds();
        } else {
            forest.smooth_errors();
        }
        session.progress.stage("proving and packing");
        let rounding = (!self.lossless).then(|| self.rounding(mesh));
        let errors = match self.bounds || self.estimates {
            true => StoredErrors::AsRecorded,
            false => StoredErrors::Measured,
        };
        let attributes = self.attributes.bounds();
        let storage = Storage { rounding, updates_per_chunk: self.in_chunk, errors, attributes };
        let written = Archive::write(&forest, &storage);
        let (bytes, certificate) = written.map_err(|error| Failure::at(&self.input, error))?;
        let surface_bytes = bytes.len();
        let archive = Archive::open(bytes).and_then(|archive| match rest {
            Some(rest) => {
                session.progress.stage("packing images");
                let resources = rest.resources(&archive.chunk_lengths());
                archive.with_resources(&resources)
            }
            None => Ok(archive),
        });
        let archive = archive.map_err(|error| Failure::at(&self.output, error))?;
        let levels = Levels::Contractions {
            updates: archive.update_count(),
            base_faces: archive.base_faces(),
            certificate,
            error_kind: model_file::error_kind(&archive),
            held,
            poses: poses.measured(),
            model: "contractions",
            method: self.method,
            lossless: self.lossless,
        };
        Ok(Built {
            faces: forest.full_faces(),
            rounding: model_file::rounding(&archive),
            moved: model_file::rounding_text(&archive),
            bytes: archive.into_source(),
            surface_bytes,
            levels,
            poses,
        })
    }

    /// Has errors measured in the poses of the scene's animations, where they are measured and the
    /// scene has such poses. Returns the poses for which errors will hold.
    fn pose(
        &self,
        forest: &mut Forest,
        mesh: &Mesh,
        rest: Option<&mut PackedScene>,
        session: &Session,
    ) -> ErrorPoses {
        let Some(rest) = rest else { return ErrorPoses::Unknown };
        let Some(poses) = rest.poses(mesh) else { return ErrorPoses::Unknown };
        for note in &poses.notes {
            session.warn(Failure::at(&self.input, format_args!("poses: {note}")));
        }
        match poses.counts {
            PoseCounts { measured: 0, .. } if poses.notes.is_empty() => ErrorPoses::Unbent,
            PoseCounts { measured: 0, .. } => ErrorPoses::Unknown,
            _ if self.bounds || self.estimates => ErrorPoses::Unknown,
            counts => {
                rest.note_poses(counts);
                forest.pose_by(Arc::new(poses));
                ErrorPoses::Measured(counts)
            }
        }
    }

    /// Merges the scene of a height field, of which nothing but the surface is used; also returns
    /// what is left out.
    fn place_field(
        &self,
        scene: Scene,
        options: Options,
        session: &Session,
    ) -> Result<(PlacedScene, Vec<Note>), Failure> {
        // Right triangles have what STL has: a surface.
        let notes = scene.limits_of(Format::Stl);
        let path = (self.input.as_path(), &self.reading);
        let FlatInput { mesh, options, .. } =
            self.constraints.flatten(scene, path, options, session)?;
        let counts = SceneCounts::default();
        Ok((PlacedScene { mesh, options, rest: None, counts }, notes))
    }

    fn right_triangles(&self, mesh: &Mesh) -> Result<Built, Failure> {
        let failed = |error: &dyn std::fmt::Display| Failure::at(&self.input, error);
        let field = HeightField::from_mesh(mesh).map_err(|error| failed(&error))?;
        let precision = match self.rounding(mesh) {
            0.0 => HeightPrecision::Exact,
            rounding => HeightPrecision::Within(rounding),
        };
        let bytes = field.to_file(precision).map_err(|error| failed(&error))?;
        let stored = ModelFile::open(bytes.clone()).map_err(|error| failed(&error))?;
        let ModelFile::HeightField(field, _) = stored else { unreachable!("a field was written") };
        let rounding = field.fit().rounded;
        let part = percent(100.0 * rounding / mesh.bounds().diagonal());
        Ok(Built {
            surface_bytes: bytes.len(),
            bytes,
            faces: mesh.faces.len(),
            rounding,
            moved: format!("vertices moved by up to {} ({part})", value(rounding)),
            levels: Levels::RightTriangles {
                model: "right-triangles",
                error_kind: "bound",
                grid: field.size(),
                fit: field.fit(),
            },
            poses: ErrorPoses::Unknown,
        })
    }

    fn rounding(&self, mesh: &Mesh) -> f64 {
        self.rounding.length(mesh.bounds().diagonal())
    }
}
