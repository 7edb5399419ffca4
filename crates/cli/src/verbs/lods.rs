//! `lods`: a chain of coarser levels, each measured against the original.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use meshlod::io::gltf::Level;
use meshlod::io::write_lods;
use meshlod::measure::Distance;
use meshlod::{Format, Options, Scene};
use serde_json::{Value, json};

use crate::amounts::{self, Size};
use crate::answer::Answer;
use crate::args::{Reading, Writing};
use crate::distance;
use crate::failure::Failure;
use crate::files;
use crate::fusing;
use crate::holding::{self, Origin};
use crate::numbers::{count, percent, value};
use crate::reduce::{self, Engine, Reduced};
use crate::session::Session;
use crate::table::aligned;
use crate::verbs::simplify::Manner;

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
        value_parser = amounts::size, allow_hyphen_values = true)]
    levels: Vec<Size>,
    #[command(flatten)]
    manner: Manner,
    /// Exit with 1 if a level is out of reach
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    writing: Writing,
}

/// A level and where it went.
struct Link {
    size: Size,
    reduced: Reduced,
    screen_coverage: f64,
    file: PathBuf,
}

/// Lines of the screen on which a level's error shall not be seen.
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
        let fused = self.manner.fusing.apply(&mut scene, session);
        let origin = Origin { scene: &scene, path: &self.input, reading: &self.reading };
        let options = self.manner.options(&origin, session)?;
        let (mut chain, time) = self.chain(&scene, fused.as_ref(), &options, session)?;
        let input_faces = chain.first().map_or(0, |link| link.reduced.report.input_faces);
        self.write(format, &mut scene, &mut chain, session)?;
        for link in chain.iter().filter(|link| !link.reduced.report.reached) {
            let reason = reduce::why_not_reached(&link.reduced.report);
            session.warn(Failure::at(&self.input, format_args!("{}: {reason}", link.size)));
        }
        if let Some(link) = chain.last() {
            self.manner.warn(&link.reduced.report, session);
        }
        let missed = chain.iter().any(|link| !link.reduced.report.reached);
        Ok(Answer {
            missed: self.strict && missed,
            ..Answer::new(
                self.json(&chain, input_faces, time),
                self.text(&chain, input_faces, time),
            )
        })
    }

    /// All levels by one run, each from the one before.
    fn chain(
        &self,
        scene: &Scene,
        fused: Option<&fusing::Done>,
        options: &Options,
        session: &Session,
    ) -> Result<(Vec<Link>, Duration), Failure> {
        let original = distance::surface_of(scene, distance::meshes(scene));
        let surface = distance::ready(&original, &self.input)
            .inspect_err(|failure| session.warn(format_args!("not measured: {failure}")))
            .ok();
        let mut engine = Engine::start(scene, options, &self.input, session)?;
        check_order(&self.levels, engine.input_faces())?;
        let mut chain: Vec<Link> = Vec::new();
        for (i, &size) in self.levels.iter().enumerate() {
            let target = size.target();
            let report = engine.run(fused.map_or(target, |fused| fused.target(target)))?;
            let meshes = engine.level();
            let measured = reduce::measure(surface.as_ref(), scene, &meshes, session);
            let finer = chain.last().map_or(1.0, |link| link.screen_coverage);
            chain.push(Link {
                size,
                reduced: Reduced { meshes, report, measured, sequence: None },
                screen_coverage: measured.as_ref().map_or(finer, screen_coverage).min(finer),
                file: self.file_of(i + 1),
            });
        }
        Ok((chain, engine.time()))
    }

    /// Where a level goes, if it has a file of its own.
    fn file_of(&self, level: usize) -> PathBuf {
        let stem = self.output.file_stem().unwrap_or_default().to_string_lossy();
        let suffix = self.output.extension().unwrap_or_default().to_string_lossy();
        self.output.with_file_name(format!("{stem}_LOD{level}.{suffix}"))
    }

    /// Writes all levels into one file, or each into its own.
    fn write(
        &self,
        format: Format,
        scene: &mut Scene,
        chain: &mut [Link],
        session: &Session,
    ) -> Result<(), Failure> {
        let meshes = |link: &mut Link| std::mem::take(&mut link.reduced.meshes);
        if !holds_levels(format) {
            for link in chain {
                reduce::replace(scene, meshes(link));
                files::write(&link.file, scene, &self.writing, session)?;
            }
            return Ok(());
        }
        session.progress.stage("writing");
        let levels: Vec<Level> = chain
            .iter_mut()
            .map(|link| {
                link.file.clone_from(&self.output);
                Level { meshes: meshes(link), screen_coverage: link.screen_coverage }
            })
            .collect();
        Ok(write_lods(&self.output, scene, &levels)?)
    }

    fn json(&self, chain: &[Link], input_faces: usize, time: Duration) -> Value {
        let level = |link: &Link| {
            let report = &link.reduced.report;
            json!({
                "size": link.size.to_string(),
                "faces": report.output_faces,
                "reached": report.reached,
                "error_estimate": report.error_estimate,
                "error_measured": link.reduced.measured.as_ref().map(distance::to_json),
                "screen_coverage": link.screen_coverage,
                "file": files::name(&link.file),
            })
        };
        let report = chain.last().map(|link| &link.reduced.report);
        json!({
            "method": report.map(|report| report.method.name()),
            "input_faces": input_faces,
            "levels": chain.iter().map(level).collect::<Vec<_>>(),
            "simplify_seconds": time.as_secs_f64(),
            "degenerate_faces": report.map(|report| report.degenerate_faces),
            "duplicate_faces": report.map(|report| report.duplicate_faces),
            "non_manifold_vertices": report.map(|report| report.non_manifold_vertices),
            "held": report.map(holding::to_json),
            "vanished": report.map(|report| report.vanished),
            "refusals": report.map(reduce::refusals_json),
        })
    }

    fn text(&self, chain: &[Link], input_faces: usize, time: Duration) -> String {
        let mut rows = vec![
            ["level", "target", "faces", "mean", "RMS", "max", "coverage"].map(String::from),
            ["LOD0", "", &count(input_faces), "", "", "", ""].map(String::from),
        ];
        for (i, link) in chain.iter().enumerate() {
            let cell = |length: fn(&Distance) -> f64| {
                let distance = link.reduced.measured.as_ref();
                distance.map_or("-".into(), |d| percent(d.percent(length(d))))
            };
            rows.push([
                format!("LOD{}", i + 1),
                link.size.to_string(),
                count(link.reduced.report.output_faces),
                cell(Distance::mean),
                cell(Distance::rms),
                cell(Distance::max),
                value(link.screen_coverage),
            ]);
        }
        let oddities = chain.last().map(|link| reduce::oddities(&link.reduced.report));
        let mut text = aligned(&rows);
        text += "mean, RMS, max: measured distance from the input, in % of the diagonal\n";
        text += "coverage: the fraction of the screen below which the level is within one pixel of the\n";
        text += &format!("input, on a screen of {SCREEN_LINES} lines\n");
        text += &oddities.unwrap_or_default();
        for file in written(chain) {
            text += &format!("{}\n", files::name(file));
        }
        text + &reduce::seconds_line(time)
    }
}

/// Whether one file holds all levels.
fn holds_levels(format: Format) -> bool {
    matches!(format, Format::Glb | Format::Gltf)
}

/// Refuses a level that is not coarser than the one before.
fn check_order(levels: &[Size], input_faces: usize) -> Result<(), Failure> {
    let faces = |size: Size| match size {
        Size::Faces(faces) => faces as f64,
        Size::Ratio(ratio) => ratio * input_faces as f64,
    };
    match levels.windows(2).find(|pair| faces(pair[1]) >= faces(pair[0])) {
        None => Ok(()),
        Some(pair) => Err(Failure::usage(format_args!(
            "--levels: {} is not coarser than {}; list the finest first",
            pair[1], pair[0]
        ))),
    }
}

/// The part of the screen's area below which a level is within a pixel of the original.
pub fn screen_coverage(distance: &Distance) -> f64 {
    let most_pixels = distance.diagonal / distance.max();
    let coverage = (most_pixels / SCREEN_LINES).powi(2);
    if coverage.is_finite() { coverage.min(1.0) } else { 1.0 }
}

/// Each file once.
fn written(chain: &[Link]) -> Vec<&Path> {
    let mut files: Vec<&Path> = chain.iter().map(|link| &*link.file).collect();
    files.dedup();
    files
}
