//! `lods`: writes a chain of coarser levels, each measured against the original.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use meshlod::io::gltf::{Level, LodLayout};
use meshlod::io::write_file;
use meshlod::simplify::Digits;
use meshlod::{Format, Scene, Topology, digits_of, world_bounds};

use crate::options::args::{ReadArgs, WriteArgs};
use crate::options::fuse;
use crate::options::locks::InputScene;
use crate::options::parse::{self, LevelSize};
use crate::options::volume::ExactVolumeArgs;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::scene_files;
use crate::simplify_run::{self, ReadyScene, Simplified, SimplifyRun};
use crate::text::distance;
use crate::text::model_scene;
use crate::text::simplify_report;
use crate::verbs::simplify::MethodArgs;

use self::switching::Camera;

mod report;
pub mod switching;

/// Write a chain of coarser levels in one glTF or one file a level, and when to show each
#[derive(Args)]
pub struct Lods {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write; with one file a level, NAME_LOD0, NAME_LOD1, … beside it. NAME.lods.json has
    /// the measured error of each level and the distance from which it is fine enough
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
    camera: Camera,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    volume: ExactVolumeArgs,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum ChainLayout {
    /// One glTF; coarser levels are linked by MSFT_lod
    Msft,
    /// One glTF; all levels are nodes of the scene, NAME_LOD0, NAME_LOD1, …, as engines import them
    Scene,
    /// One file a level, the input being NAME_LOD0
    Files,
}

/// Level of the chain with its file.
struct LodLevel {
    size: LevelSize,
    simplified: Simplified,
    /// Largest relative deviation from the original volume, if it was restored.
    volume_residual: Option<f64>,
    screen_coverage: f64,
    /// File that holds the level; `None` if it is the same as the level before and not written.
    file: Option<PathBuf>,
}

impl Lods {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if files::is_pipe(&self.output) {
            return Err(Failure::usage("-: levels cannot go to standard output; name a file"));
        }
        let format = files::check_output(&self.output, session)?;
        let layout = self.layout(format)?;
        if layout == ChainLayout::Files {
            (0..=self.levels.len())
                .try_for_each(|i| files::check_place(&self.file_of(i, layout)))?;
        }
        files::check_place(&self.guide_file())?;
        let mut scene = files::read_surface(&self.input, &self.reading, session)?;
        let fused = self.method.constraints.fuse.apply(&mut scene, session);
        let input = InputScene { scene: &scene, path: &self.input, reading: &self.reading };
        let options = self.method.options(&input, session)?;
        let borders = self.method.constraints.topology.borders();
        let ready = ReadyScene::new(&scene, &options, borders, &self.input, session)?;
        let digits = digits_of(format, self.writing.of(&scene).options().precision);
        let (mut chain, time) =
            self.chain(&scene, &ready, fused.as_ref(), (layout, digits), session)?;
        if let Some(level) = chain.last() {
            self.method.warn(&level.simplified.report, &ready, session);
        }
        let run = (layout, time);
        let figures = self.figures(&chain, &ready, run);
        let text = self.text(&chain, &ready, run);
        let guide = self.guide(&chain, &world_bounds(&scene), layout);
        self.write(layout, &mut scene, &mut chain, session)?;
        write_file(&self.guide_file(), format!("{guide:#}\n").as_bytes())?;
        for level in &chain {
            self.warn_of(level, options.topology, session);
        }
        let missed = chain.iter().any(|level| !level.simplified.report.reached);
        let outcome = Outcome::Missed.when(session.strict && missed);
        Ok(Answer { outcome, ..Answer::new(figures, text) })
    }

    /// Warns of a target that was missed, and of a level that is not written.
    fn warn_of(&self, level: &LodLevel, topology: Topology, session: &Session) {
        let LodLevel { size, simplified, .. } = level;
        let at = |reason: &str| Failure::at(&self.input, format_args!("{size}: {reason}"));
        if !simplified.report.reached {
            session.miss(&at(&simplify_report::why_not_reached(&simplified.report, topology)));
        }
        if level.file.is_none() {
            session.warn(at("not written, since it is the same as the level before"));
        }
    }

    /// Builds all levels in one run, each from the one before.
    fn chain(
        &self,
        scene: &Scene,
        ready: &ReadyScene<'_>,
        fused: Option<&fuse::FuseReport>,
        (layout, digits): (ChainLayout, Digits),
        session: &Session,
    ) -> Result<(Vec<LodLevel>, Duration), Failure> {
        let original = distance::surface_of(scene, distance::meshes(scene));
        let surface = distance::ready(&original, &self.input)
            .inspect_err(|failure| session.warn(format_args!("not measured: {failure}")))
            .ok();
        let surface = surface.as_ref().map(|surface| (surface, distance::for_chain(surface)));
        let mut run = SimplifyRun::start(ready, session)?;
        check_order(&self.levels, run.input_faces())?;
        let mut chain: Vec<LodLevel> = Vec::new();
        for (i, &size) in self.levels.iter().enumerate() {
            let target = size.target();
            let mut report = run.simplify_to(fused.map_or(target, |fused| fused.target(target)))?;
            let mut meshes = run.level(&mut report);
            let residual = self.volume.restore(&ready.scene, &mut meshes, digits, session);
            let measured = simplify_run::measure(surface, scene, &meshes, session);
            let finer = chain.last().map_or(1.0, |level| level.screen_coverage);
            let before = chain.last().map(|level| level.simplified.report.output_faces);
            // No contraction leaves the number of faces as it is.
            let is_same = match before {
                Some(before) => report.output_faces == before,
                None => report.output_faces == report.input_faces && !report.reached,
            };
            chain.push(LodLevel {
                size,
                simplified: Simplified { meshes, report, measured, sequence: None },
                volume_residual: residual,
                screen_coverage: measured
                    .as_ref()
                    .map_or(finer, |measured| self.camera.screen_coverage(measured))
                    .min(finer),
                file: (!is_same).then(|| self.file_of(i + 1, layout)),
            });
        }
        Ok((chain, run.time()))
    }

    /// Returns the layout asked for, or the usual one of the format.
    fn layout(&self, format: Format) -> Result<ChainLayout, Failure> {
        let is_gltf = model_scene::is_gltf(format);
        match self.layout {
            None if is_gltf => Ok(ChainLayout::Msft),
            None => Ok(ChainLayout::Files),
            Some(layout) if layout == ChainLayout::Files || is_gltf => Ok(layout),
            Some(layout) => Err(Failure::usage(format_args!(
                "--layout {} needs .glb or .gltf, which hold several levels",
                layout.name()
            ))),
        }
    }

    /// Returns the path of the file that says when to show each level.
    fn guide_file(&self) -> PathBuf {
        self.output.with_extension("lods.json")
    }

    /// Returns the path of the file that holds a level.
    fn file_of(&self, level: usize, layout: ChainLayout) -> PathBuf {
        if layout != ChainLayout::Files {
            return self.output.clone();
        }
        let stem = files::stem(&self.output);
        let suffix = self.output.extension().unwrap_or_default().to_string_lossy();
        self.output.with_file_name(format!("{stem}_LOD{level}.{suffix}"))
    }

    /// Writes all levels to one file, or each to its own.
    fn write(
        &self,
        layout: ChainLayout,
        scene: &mut Scene,
        chain: &mut [LodLevel],
        session: &Session,
    ) -> Result<(), Failure> {
        let meshes = |level: &mut LodLevel| std::mem::take(&mut level.simplified.meshes);
        if layout == ChainLayout::Files {
            let file = |level: &mut LodLevel| Some((level.file.clone()?, meshes(level)));
            let levels = chain.iter_mut().filter_map(file).collect();
            let first = self.file_of(0, layout);
            return scene_files::write_chain(&first, scene, levels, &self.writing, session);
        }
        let written = chain.iter_mut().filter(|level| level.file.is_some());
        let level = |level: &mut LodLevel| Level {
            meshes: meshes(level),
            screen_coverage: level.screen_coverage,
        };
        let levels: Vec<Level> = written.map(level).collect();
        let layout = match layout {
            ChainLayout::Scene => LodLayout::Siblings,
            _ => LodLayout::Linked,
        };
        scene_files::write_levels(&self.output, scene, &levels, layout, session)
    }
}

impl ChainLayout {
    fn name(self) -> &'static str {
        match self {
            Self::Msft => "msft",
            Self::Scene => "scene",
            Self::Files => "files",
        }
    }
}

/// Refuses a level that is not coarser than the one before.
fn check_order(levels: &[LevelSize], input_faces: usize) -> Result<(), Failure> {
    let faces = |size: LevelSize| match size {
        LevelSize::Faces(faces) => faces as f64,
        LevelSize::Ratio(ratio) => ratio * input_faces as f64,
    };
    match levels.windows(2).find(|pair| faces(pair[1]) >= faces(pair[0])) {
        None => Ok(()),
        Some(pair) => Err(Failure::usage(format_args!(
            "--levels: {} is not coarser than {}; list the finest first",
            pair[1], pair[0]
        ))),
    }
}
