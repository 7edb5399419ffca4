//! `lods`: writes a chain of coarser levels, each measured against the original.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use meshlod::io::gltf::Level;
use meshlod::io::write_lods;
use meshlod::measure::Distance;
use meshlod::simplify::Digits;
use meshlod::{Format, Scene, Topology, digits_of};
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::args::{ReadArgs, WriteArgs};
use crate::distance;
use crate::failure::Failure;
use crate::files;
use crate::fuse;
use crate::locks::{self, InputScene};
use crate::numbers::{count, percent, value};
use crate::parse::{self, LevelSize};
use crate::session::Session;
use crate::simplify_report;
use crate::simplify_run::{self, ReadyScene, Simplified, SimplifyRun};
use crate::table::aligned;
use crate::topology;
use crate::verbs::simplify::MethodArgs;
use crate::volume::ExactVolumeArgs;

/// Write a chain of coarser levels, as glTF with MSFT_lod or one file per level
#[derive(Args)]
pub struct Lods {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// .glb or .gltf for one file with all levels; any other suffix for NAME_LOD1, NAME_LOD2, …
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Level sizes, finest first: 50% or 0.5 of the faces, or a number of faces
    #[arg(long, value_name = "SIZES", value_delimiter = ',', default_value = "50%,25%,10%",
        value_parser = parse::size, allow_hyphen_values = true)]
    levels: Vec<LevelSize>,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    volume: ExactVolumeArgs,
    #[command(flatten)]
    reading: ReadArgs,
    #[command(flatten)]
    writing: WriteArgs,
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

/// Height of the screen, in lines, for which levels are chosen to be indistinguishable.
const SCREEN_LINES: f64 = 1080.0;

impl Lods {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if files::is_pipe(&self.output) {
            return Err(Failure::usage("-: levels cannot go to standard output; name a file"));
        }
        let format = files::check_output(&self.output, session)?;
        if !holds_levels(format) {
            (1..=self.levels.len()).try_for_each(|i| files::check_place(&self.file_of(i)))?;
        }
        let mut scene = files::read(&self.input, &self.reading, session)?;
        let fused = self.method.constraints.fuse.apply(&mut scene, session);
        let input = InputScene { scene: &scene, path: &self.input, reading: &self.reading };
        let options = self.method.options(&input, session)?;
        let borders = self.method.constraints.topology.borders();
        let ready = ReadyScene::new(&scene, &options, borders, &self.input, session)?;
        let digits = digits_of(format, self.writing.of(&scene).options().precision);
        let (mut chain, time) = self.chain(&scene, &ready, fused.as_ref(), digits, session)?;
        if let Some(level) = chain.last() {
            self.method.warn(&level.simplified.report, &ready, session);
        }
        let (mut json, text) = (self.json(&chain, time), self.text(&chain, &ready, time));
        topology::add_json(&mut json, &ready.scene);
        self.write(format, &mut scene, &mut chain, session)?;
        for level in &chain {
            self.warn_of(level, options.topology, session);
        }
        let missed = chain.iter().any(|level| !level.simplified.report.reached);
        Ok(Answer { missed: session.strict && missed, ..Answer::new(json, text) })
    }

    /// Warns of a target that was missed, and of a level that is not written.
    fn warn_of(&self, level: &LodLevel, topology: Topology, session: &Session) {
        let LodLevel { size, simplified, .. } = level;
        let warn = |reason: &str| {
            session.warn(Failure::at(&self.input, format_args!("{size}: {reason}")));
        };
        if !simplified.report.reached {
            warn(&simplify_report::why_not_reached(&simplified.report, topology));
        }
        if level.file.is_none() {
            warn("not written, since it is the same as the level before");
        }
    }

    /// Builds all levels in one run, each from the one before.
    fn chain(
        &self,
        scene: &Scene,
        ready: &ReadyScene<'_>,
        fused: Option<&fuse::FuseReport>,
        digits: Digits,
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
                screen_coverage: measured.as_ref().map_or(finer, screen_coverage).min(finer),
                file: (!is_same).then(|| self.file_of(i + 1)),
            });
        }
        Ok((chain, run.time()))
    }

    /// Returns the path of the file that holds a level.
    fn file_of(&self, level: usize) -> PathBuf {
        if Format::of_path(&self.output).is_ok_and(holds_levels) {
            return self.output.clone();
        }
        let stem = self.output.file_stem().unwrap_or_default().to_string_lossy();
        let suffix = self.output.extension().unwrap_or_default().to_string_lossy();
        self.output.with_file_name(format!("{stem}_LOD{level}.{suffix}"))
    }

    /// Writes all levels to one file, or each to its own.
    fn write(
        &self,
        format: Format,
        scene: &mut Scene,
        chain: &mut [LodLevel],
        session: &Session,
    ) -> Result<(), Failure> {
        let meshes = |level: &mut LodLevel| std::mem::take(&mut level.simplified.meshes);
        let written = chain.iter_mut().filter(|level| level.file.is_some());
        if !holds_levels(format) {
            for level in written {
                simplify_run::replace(scene, meshes(level));
                if let Some(file) = &level.file {
                    files::write(file, scene, &self.writing, session)?;
                }
            }
            return Ok(());
        }
        session.progress.stage("writing");
        let level = |level: &mut LodLevel| Level {
            meshes: meshes(level),
            screen_coverage: level.screen_coverage,
        };
        let levels: Vec<Level> = written.map(level).collect();
        Ok(write_lods(&self.output, scene, &levels)?)
    }

    fn json(&self, chain: &[LodLevel], time: Duration) -> Value {
        let level = |level: &LodLevel| {
            let report = &level.simplified.report;
            json!({
                "size": level.size.to_string(),
                "faces": report.output_faces,
                "reached": report.reached,
                "error_estimate": report.error_estimate,
                "error_measured": level.simplified.measured.as_ref().map(distance::to_json),
                "volume_residual": level.volume_residual,
                "screen_coverage": level.screen_coverage,
                "file": level.file.as_deref().map(files::name),
            })
        };
        let report = chain.last().map(|level| &level.simplified.report);
        json!({
            "method": report.map(|report| report.method.name()),
            "input_faces": report.map(|report| report.input_faces),
            "levels": chain.iter().map(level).collect::<Vec<_>>(),
            "simplify_seconds": time.as_secs_f64(),
            "degenerate_faces": report.map(|report| report.degenerate_faces),
            "duplicate_faces": report.map(|report| report.duplicate_faces),
            "non_manifold_vertices": report.map(|report| report.non_manifold_vertices),
            "held": report.map(locks::to_json),
            "vanished": report.map(|report| report.vanished),
            "vanished_volume": report.map(|report| report.volume.vanished),
            "refusals": report.map(simplify_report::refusals_json),
        })
    }

    fn text(&self, chain: &[LodLevel], ready: &ReadyScene<'_>, time: Duration) -> String {
        let input_faces = chain.first().map_or(0, |level| level.simplified.report.input_faces);
        let mut rows = vec![
            ["level", "target", "faces", "mean", "RMS", "max", "coverage"].map(String::from),
            ["LOD0", "", &count(input_faces), "", "", "", ""].map(String::from),
        ];
        for (i, level) in chain.iter().enumerate() {
            let cell = |length: fn(&Distance) -> f64| {
                let distance = level.simplified.measured.as_ref();
                distance.map_or("-".into(), |d| percent(d.percent(length(d))))
            };
            rows.push([
                format!("LOD{}", i + 1),
                level.size.to_string(),
                count(level.simplified.report.output_faces),
                cell(Distance::mean),
                cell(Distance::rms),
                cell(Distance::max),
                value(level.screen_coverage),
            ]);
        }
        let notes = chain.last().map(|level| simplify_report::mesh_notes(&level.simplified.report));
        let mut text = aligned(&rows);
        text += "mean, RMS, max: measured distance from the input, in % of the diagonal\n";
        text += "coverage: the fraction of the screen below which the level is within one pixel of the\n";
        text += &format!("input, on a screen of {SCREEN_LINES} lines\n");
        text += &topology::to_text(&ready.scene);
        text += &notes.unwrap_or_default();
        for level in chain.iter().filter(|level| level.file.is_none()) {
            text += &format!("{}: not written, the same as the level before\n", level.size);
        }
        for file in written(chain) {
            text += &format!("{}\n", files::name(file));
        }
        text + &simplify_report::seconds_line(time)
    }
}

/// Returns true if one file of this format holds all levels.
fn holds_levels(format: Format) -> bool {
    matches!(format, Format::Glb | Format::Gltf)
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

/// Returns the fraction of the screen's area that a model covers when its greatest distance from
/// the original spans one pixel.
pub fn screen_coverage(distance: &Distance) -> f64 {
    let most_pixels = distance.diagonal / distance.max();
    let coverage = (most_pixels / SCREEN_LINES).powi(2);
    if coverage.is_finite() { coverage.min(1.0) } else { 1.0 }
}

/// Lists the files written, each once.
fn written(chain: &[LodLevel]) -> Vec<&Path> {
    let mut files: Vec<&Path> = chain.iter().filter_map(|level| level.file.as_deref()).collect();
    files.dedup();
    files
}
