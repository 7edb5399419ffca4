//! `strip`: converts levels of a mesh to triangle strips and counts what they send.

mod follow;
mod model;
mod options;
mod output;
mod report;
mod table;
mod verify;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use meshlod::mesh::VertexId;
use meshlod::strip::{
    self, Difference, Filter, MergeTree, SkipStrip, StripOptions, StripStatistics, Strips,
};
use meshlod::{Options, Scene, SimplifyError};

use crate::options::args::ReadArgs;
use crate::options::constraints::{ConstraintArgs, FlatInput};
use crate::options::model_query::QueryArgs;
use crate::options::parse::{self, LevelSize};
use crate::options::query_args::{self, ErrorLimit};
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::text::kept_error;
use crate::text::model_scene;
use crate::text::numbers;
use options::{EffortArg, FilterArg, QualityArg};
use output::StripOutput;

/// Convert a mesh and its levels, or a cut of a multiresolution file, to triangle strips, and count
/// the vertices they send
#[derive(Args)]
pub struct Strip {
    /// Mesh to read, or -; or an .mlod file to take a cut from
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Follow the cuts of an .mlod file at these errors in turn, repair strips and index buffers
    /// where one differs from the last, and list each: 1%,0.1%,1%
    #[arg(long, value_name = "BOUNDS", value_delimiter = ',', value_parser = query_args::error_limit,
        allow_hyphen_values = true, conflicts_with_all = ["error", "faces", "levels", "filter", "out",
        "strict"])]
    follow: Vec<ErrorLimit>,
    /// Level sizes: 10% or 0.1 of the faces, or a number of faces
    #[arg(long, visible_alias = "level", value_name = "SIZES", value_delimiter = ',',
        default_value = "100%", value_parser = parse::size, allow_hyphen_values = true)]
    levels: Vec<LevelSize>,
    /// Carry the strips of the whole mesh down to each level and shorten them by this filter
    /// [default: each level gets strips of its own]
    #[arg(long, value_name = "FILTER")]
    filter: Option<FilterArg>,
    /// Quality of the strips of the mesh or of a level
    #[arg(long, value_name = "QUALITY", default_value = "fast")]
    quality: QualityArg,
    /// Effort of --quality best and --filter repair
    #[arg(long, value_name = "EFFORT", default_value = "thorough")]
    effort: EffortArg,
    /// File to write: .glb or .gltf for the scene with strips for faces, finest level first, linked
    /// by MSFT_lod; .json for lists of vertices
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Compare the triangles drawn, and without --follow their attributes and materials, with those of
    /// the level, which is simplified a second time for that, or of the cut; exit with 3 if they differ
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    query: QueryArgs,
    #[command(flatten)]
    constraints: ConstraintArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

/// Multiple of the faces of meshes from which on a scene that shows them is warned of.
const MANY_COPIES: usize = 2;

/// Strips of a level with their statistics.
struct StrippedLevel {
    size: LevelSize,
    reached: bool,
    triangles: usize,
    strips: Strips,
    sent: StripStatistics,
    time: Duration,
    difference: Option<Difference>,
}

/// Mesh and contractions that all levels come from.
struct StripSource {
    input: FlatInput,
    tree: MergeTree,
    simplify_time: Duration,
    /// Strips of the whole mesh that filters shorten.
    skip: Option<SkipStrip>,
    strip_time: Duration,
}

impl Strip {
    pub fn run(mut self, session: &Session) -> Result<Answer, Failure> {
        let reason = "strips keep the topology, since all levels share the vertices of the mesh";
        self.constraints.topology.keep(reason)?;
        if let Some(out) = &self.out {
            output::check(out, &self.input)?;
        }
        let (mut error, mut reached) = (None, true);
        let read = if self.reads_model()? {
            if !self.follow.is_empty() {
                return self.run_follow(session);
            }
            let cut = self.read_cut(session)?;
            (error, reached) = (Some(cut.error), cut.reached);
            (cut.scene, None)
        } else {
            self.constraints.read_fused(&self.input, &self.reading, session)?
        };
        self.warn_of_copies(&read.0, session);
        let output = self.out.as_deref().map(|out| StripOutput::new(out, &read.0));
        let place = (&*self.input, &self.reading);
        let input = self.constraints.flatten(read, place, Options::default(), session)?;
        check_sizes(&self.levels, input.input_faces())?;
        let mut source = self.prepare(input, session)?;
        let mut levels = Vec::new();
        for &size in &self.levels {
            session.progress.stage(&format!("stripping {size}"));
            levels.push(self.level(&mut source, size));
        }
        if self.verify {
            session.progress.stage("verifying");
            verify::compare(&source.input, &source.tree, &mut levels)
                .map_err(|error| Failure::at(&self.input, error))?;
        }
        for level in levels.iter().filter(|level| !level.reached) {
            let reason = format_args!(
                "{}: no further contraction is possible at {}: strips keep the topology, so ask for more, \
                 or simplify first",
                level.size,
                numbers::faces(level.triangles)
            );
            session.miss(&Failure::at(&self.input, reason));
        }
        if let Some(output) = &output {
            output.write(&source.input, &source.tree, &levels, session)?;
        }
        let missed = !(reached && levels.iter().all(|level| level.reached));
        let is_wrong = levels.iter().any(|level| level.is_wrong());
        if is_wrong {
            session.warn(Failure::at(
                &self.input,
                "the strips do not draw the faces of the level, which is a defect of this program",
            ));
        }
        let figures = self.figures(&source, &levels, error);
        let mut text = self.text(&source, &levels);
        text += &error.as_ref().map(kept_error::to_text).unwrap_or_default();
        let outcome = match is_wrong {
            true => Outcome::Found,
            false => Outcome::Missed.when(session.strict && missed),
        };
        Ok(Answer { outcome, ..Answer::new(figures, text) })
    }

    /// Warns of meshes that several nodes show, since each of these gets strips of its own.
    fn warn_of_copies(&self, scene: &Scene, session: &Session) {
        let mut is_shown = vec![false; scene.meshes.len()];
        scene.instances().iter().for_each(|instance| is_shown[instance.mesh] = true);
        let own = scene.meshes.iter().zip(is_shown).filter(|(_, is_shown)| *is_shown);
        let own: usize = own.map(|(mesh, _)| mesh.mesh.faces.len()).sum();
        let shown = model_scene::shown_faces(scene);
        if own > 0 && shown >= MANY_COPIES * own {
            let reason = format_args!(
                "its nodes show {} of meshes with {}: every copy is stripped and written by itself, \
                 which takes {} times the time and bytes; strip the meshes alone to share them",
                numbers::faces(shown),
                numbers::faces(own),
                shown / own
            );
            session.warn(Failure::at(&self.input, reason));
        }
    }

    /// Records the contractions down to the coarsest level, and strips the whole mesh for a filter.
    fn prepare(&self, input: FlatInput, session: &Session) -> Result<StripSource, Failure> {
        let whole = MergeTree::new(&input.mesh);
        if whole.faces().is_empty() {
            let none = SimplifyError::AllDegenerate(input.mesh.faces.len());
            return Err(Failure::at(&self.input, none));
        }
        let coarsest = self.levels.iter().map(|&size| faces_of(size, &input)).min();
        let is_coarser = coarsest.is_some_and(|faces| faces < whole.faces().len());
        let (tree, simplify_time) = if is_coarser {
            session.progress.stage("simplifying");
            let target = meshlod::Target::Faces(coarsest.unwrap_or(0));
            let start = Instant::now();
            let tree = MergeTree::record_with(&input.mesh, target, &input.options);
            (tree.map_err(|error| Failure::at(&self.input, error))?, start.elapsed())
        } else {
            (whole, Duration::ZERO)
        };
        session.progress.stage("stripping");
        let start = Instant::now();
        let skip = self.filter.map(|_| SkipStrip::new(tree.clone(), self.stripify(tree.faces())));
        Ok(StripSource { input, tree, simplify_time, skip, strip_time: start.elapsed() })
    }

    fn level(&self, source: &mut StripSource, size: LevelSize) -> StrippedLevel {
        let StripSource { input, tree, skip, .. } = source;
        let faces = faces_of(size, input);
        let contractions = tree.contractions_to(faces);
        let own = skip.is_none().then(|| tree.level(contractions));
        let start = Instant::now();
        let strips = match (skip, self.filter) {
            (Some(skip), Some(filter)) => {
                skip.set_level(contractions);
                match filter {
                    FilterArg::None => skip.display(Filter::None),
                    FilterArg::Stss => skip.display(Filter::Stss),
                    FilterArg::Dtff => skip.display(Filter::Dtff),
                    FilterArg::Repair => skip.repaired(self.effort.into()),
                }
            }
            _ => self.stripify(&own.unwrap_or_default()),
        };
        let time = start.elapsed();
        let triangles = tree.faces_left(contractions);
        let sent = StripStatistics::new(&strips);
        let reached = triangles <= faces;
        StrippedLevel { size, reached, triangles, strips, sent, time, difference: None }
    }

    fn stripify(&self, faces: &[[VertexId; 3]]) -> Strips {
        strip::stripify(faces, &self.options())
    }

    fn options(&self) -> StripOptions<'static> {
        let quality = match (self.quality, self.effort) {
            (QualityArg::Fast, _) => strip::StripQuality::Fast,
            (QualityArg::Best, EffortArg::Quick) => strip::StripQuality::QUICK,
            (QualityArg::Best, EffortArg::Thorough) => strip::StripQuality::THOROUGH,
        };
        StripOptions { quality, ..StripOptions::default() }
    }
}

impl StrippedLevel {
    fn is_wrong(&self) -> bool {
        self.difference.is_some_and(|difference| difference != Difference::default())
    }
}

/// Returns the largest number of faces of a level.
fn faces_of(size: LevelSize, input: &FlatInput) -> usize {
    input.target(size.target()).faces_of(input.mesh.faces.len())
}

/// Refuses level sizes that are out of range.
fn check_sizes(sizes: &[LevelSize], faces: usize) -> Result<(), Failure> {
    let is_level = |size: &&LevelSize| match size {
        LevelSize::Faces(count) => (1..=faces).contains(count),
        LevelSize::Ratio(ratio) => *ratio > 0.0,
    };
    match sizes.iter().find(|size| !is_level(size)) {
        None => Ok(()),
        Some(size) => Err(Failure::usage(format_args!(
            "--levels: {size} is out of range; use more than 0% and up to 100%, or 1 to {faces} faces"
        ))),
    }
}
