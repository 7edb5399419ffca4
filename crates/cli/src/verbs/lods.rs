//! `lods`: writes a chain of coarser levels, each measured against the original.

use std::path::PathBuf;

use clap::Args;
use meshlod::io::gltf::{Level, LodLayout, NeedleLevels};
use meshlod::io::{WrittenFile, write_file};
use meshlod::jobs::{self, LodChain, LodReport, LodsReport, LodsRequest};
use meshlod::measure::Distance;
use meshlod::scene::world_bounds;
use meshlod::{Format, Scene, Topology};

use crate::options::args::{ReadArgs, WriteArgs};
use crate::options::doubt;
use crate::options::finish::FinishArgs;
use crate::options::locks::InputScene;
use crate::options::method::MethodArgs;
use crate::options::parse::{self, LevelSize};
use crate::options::topology;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::scene_files;
use crate::text::simplify_report;
use crate::text::stuck::Stuck;

use self::camera::CameraArgs;
use self::layout::ChainLayout;

mod camera;
mod layout;
mod report;

/// Write a chain of coarser levels in one glTF or one file a level, and when to show each
#[derive(Args)]
pub struct Lods {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write, or a folder for one file a level
    ///
    /// With one file a level, these are NAME_LOD0, NAME_LOD1, … beside it. NAME.lods.json has the
    /// measured error of each level and the distance from which it is fine enough.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Level sizes, finest first: 50% or 0.5 of the faces, or a number of faces
    #[arg(long, value_name = "SIZES", value_delimiter = ',', default_value = "50%,25%,10%",
        value_parser = parse::size, allow_hyphen_values = true)]
    levels: Vec<LevelSize>,
    /// Place of the levels [default: msft for .glb and .gltf, else files]
    #[arg(long, value_name = "LAYOUT")]
    layout: Option<ChainLayout>,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    finish: FinishArgs,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

impl Lods {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        self.name_in_folder(session)?;
        let (format, layout) = self.check_files(session)?;
        let scene = files::read_surface(&self.input, &self.reading, session)?;
        session.doubt(&self.input, doubt::of_sizes(&self.levels, &scene));
        session.doubt(&self.input, doubt::of_whole(&self.levels));
        let request = self.request(&scene, format)?;
        let hearing = Hearing::new(session, &self.input, &self.output);
        let done = jobs::lods(scene, &request, &hearing);
        let (chain, report) = done.map_err(|error| hearing.failure(error))?;
        topology::warn(report.near_borders, session);
        let guide = self.guide(&report, &world_bounds(&chain.scene), layout);
        let coarsest = chain.levels.last().map(|level| Stuck::of(&chain.scene, &level.meshes));
        let stuck = coarsest.filter(|_| !report.run.reached).unwrap_or_default();
        let files = match layout {
            ChainLayout::Needle => self.write_needle(&chain, &report, &hearing, session)?,
            _ => self.write(layout, chain, &report, session).map(|()| Vec::new())?,
        };
        write_file(&self.guide_file(), format!("{guide:#}\n").as_bytes())?;
        for level in &report.levels {
            self.warn_of(level, request.constraints.topology, stuck, session);
        }
        let figures = self.figures(&report, layout, &files);
        Ok(Answer::new(figures, self.text(&report, layout, &files)))
    }

    /// Fails if a file cannot be written, before any work is done.
    fn check_files(&self, session: &Session) -> Result<(Format, ChainLayout), Failure> {
        if files::is_pipe(&self.output) {
            return Err(Failure::usage("-: levels cannot go to standard output; name a file"));
        }
        let format = files::check_output(&self.output, session)?;
        let layout = ChainLayout::of(self.layout, format)?;
        if layout == ChainLayout::Files {
            (0..=self.levels.len())
                .try_for_each(|i| files::check_place(&self.file_of(i, layout)))?;
        }
        if layout == ChainLayout::Needle {
            self.check_levels_folder()?;
        }
        files::check_place(&self.guide_file())?;
        Ok((format, layout))
    }

    fn request(&self, scene: &Scene, format: Format) -> Result<LodsRequest, Failure> {
        let input = InputScene { scene, path: &self.input, reading: &self.reading };
        Ok(LodsRequest {
            levels: self.levels.iter().map(|size| size.target()).collect(),
            camera: self.camera.camera(),
            method: self.method.method,
            weights: self.method.weights(),
            boundary: self.method.boundary,
            polish: self.finish.polish,
            constraints: self.method.constraints.constraints(&input)?,
            exact_volume: self.finish.exact_volume,
            measured: true,
            near_borders: true,
            written_as: Some(self.writing.in_format(format)),
        })
    }

    /// Warns of a target that was missed, and of a level that is not written.
    fn warn_of(&self, level: &LodReport, topology: Topology, stuck: Stuck, session: &Session) {
        let at = |reason: &str| Failure::at(&self.input, format_args!("{}: {reason}", level.size));
        if !level.run.reached {
            session.miss(&at(&simplify_report::why_not_reached(&level.run, topology, stuck)));
        }
        if level.is_same {
            session.warn(at("not written, since it is the same as the level before"));
        }
    }

    /// Writes the coarsest level to one file, and all others and larger images to files beside it.
    fn write_needle(
        &self,
        chain: &LodChain,
        report: &LodsReport,
        hearing: &Hearing,
        session: &Session,
    ) -> Result<Vec<WrittenFile>, Failure> {
        let images = jobs::image_sizes(&chain.scene, hearing);
        let error = |level: &LodReport| level.measured.as_ref().map(Distance::max);
        let errors: Vec<_> = report.levels.iter().map(error).collect();
        let levels = NeedleLevels { levels: &chain.levels, errors: &errors, images: &images };
        scene_files::write_needle(&self.output, &chain.scene, levels, session)
    }

    /// Writes all levels to one file, or each to its own.
    fn write(
        &self,
        layout: ChainLayout,
        mut chain: LodChain,
        report: &LodsReport,
        session: &Session,
    ) -> Result<(), Failure> {
        let of_file = chain.levels.into_iter().zip(&report.levels).enumerate();
        let written = of_file.filter(|(_, (_, report))| !report.is_same);
        if layout == ChainLayout::Files {
            let file =
                |(i, (level, _)): (usize, (Level, _))| (self.file_of(i + 1, layout), level.meshes);
            let levels = written.map(file).collect();
            let (first, writing) = (self.file_of(0, layout), &self.writing);
            return scene_files::write_chain(&first, &mut chain.scene, levels, writing, session);
        }
        let levels: Vec<Level> = written.map(|(_, (level, _))| level).collect();
        let layout = match layout {
            ChainLayout::Scene => LodLayout::Siblings,
            _ => LodLayout::Linked,
        };
        scene_files::write_levels(&self.output, &chain.scene, &levels, layout, session)
    }
}
