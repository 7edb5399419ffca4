//! `strip`: triangle strips of a mesh at any level, and what they send.

mod output;
mod table;
mod verify;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use meshlod::Mesh;
use meshlod::mesh::{Connectivity, VertexId};
use meshlod::strip::{
    self, Difference, Effort, Filter, MergeTree, SkipStrip, StripStatistics, Strips,
};
use serde_json::{Value, json};

use crate::amounts::{self, Size};
use crate::answer::Answer;
use crate::args::Reading;
use crate::failure::Failure;
use crate::files;
use crate::session::Session;

#[derive(Args)]
pub struct Strip {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Level sizes: 10% or 0.1 of the faces, or a number of faces
    #[arg(long, visible_alias = "level", value_name = "SIZES", value_delimiter = ',',
        default_value = "100%", value_parser = amounts::size, allow_hyphen_values = true)]
    levels: Vec<Size>,
    /// Carry the strips of the whole mesh down to each level and shorten them by this filter
    /// [default: each level gets strips of its own]
    #[arg(long, value_name = "FILTER")]
    filter: Option<Shortened>,
    /// Quality of the strips of the mesh or of a level
    #[arg(long, value_name = "QUALITY", default_value = "fast")]
    quality: Quality,
    /// Effort of --quality best and --filter repair
    #[arg(long, value_name = "EFFORT", default_value = "thorough")]
    effort: Tried,
    /// File to write: .gltf for the levels as meshes of strips, finest first, linked by MSFT_lod; .json
    /// for lists of vertices
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Compare the triangles drawn with the faces of an independently simplified level; exit with 1 if
    /// they differ
    #[arg(long)]
    verify: bool,
    /// Exit with 1 if a level is out of reach
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shortened {
    /// No shortening: each vertex is sent as the vertex it was contracted to
    None,
    /// Simple triangle strip scanner
    Stss,
    /// Degenerate-triangle-free filter
    Dtff,
    /// The strips of dtff, improved where the level changed
    Repair,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Quality {
    /// One pass
    Fast,
    /// As few vertices as the search finds
    Best,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Tried {
    /// Fast enough for levels that change often
    Quick,
    /// For levels that are made once and kept
    Thorough,
}

/// The strips of a level.
struct Level {
    size: Size,
    reached: bool,
    triangles: usize,
    strips: Strips,
    sent: StripStatistics,
    time: Duration,
    difference: Option<Difference>,
}

/// What all levels come from.
struct Origin {
    mesh: Mesh,
    tree: MergeTree,
    simplify_time: Duration,
    /// The strips that filters shorten.
    skip: Option<SkipStrip>,
    strip_time: Duration,
}

impl Strip {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if let Some(out) = &self.out {
            output::check(out, &self.input)?;
        }
        let mesh = files::read(&self.input, &self.reading, session)?.into_mesh();
        check_sizes(&self.levels, mesh.faces.len())?;
        let mut origin = self.origin(mesh, session)?;
        let mut levels = Vec::new();
        for &size in &self.levels {
            session.progress.stage(&format!("stripping {size}"));
            levels.push(self.level(&mut origin, size));
        }
        if self.verify {
            session.progress.stage("verifying");
            verify::compare(&origin.mesh, origin.tree.faces(), &mut levels)
                .map_err(|error| Failure::at(&self.input, error))?;
        }
        for level in levels.iter().filter(|level| !level.reached) {
            let reason = format_args!("{}: no further contraction is possible", level.size);
            session.warn(Failure::at(&self.input, reason));
        }
        if let Some(out) = &self.out {
            session.progress.stage(&format!("writing {}", files::name(out)));
            output::write(out, &origin.mesh.positions, &levels)?;
        }
        let missed = self.strict && levels.iter().any(|level| !level.reached);
        let wrong = levels.iter().any(|level| level.is_wrong());
        if wrong {
            session.warn(Failure::at(&self.input, "the strips do not draw the faces of the level"));
        }
        Ok(Answer {
            missed: missed || wrong,
            ..Answer::new(self.json(&origin, &levels), self.text(&origin, &levels))
        })
    }

    /// The mesh with the contractions to its coarsest level, and its strips if levels are made of them.
    fn origin(&self, mesh: Mesh, session: &Session) -> Result<Origin, Failure> {
        let whole = MergeTree::new(&mesh);
        let targets = self.levels.iter().map(|size| size.target());
        let coarsest = targets.clone().map(|target| target.faces_of(mesh.faces.len())).min();
        let is_coarser = coarsest.is_some_and(|faces| faces < whole.faces().len());
        let (tree, simplify_time) = if is_coarser {
            session.progress.stage("simplifying");
            let target = meshlod::Target::Faces(coarsest.unwrap_or(0));
            let start = Instant::now();
            let tree = MergeTree::record(&mesh, target);
            (tree.map_err(|error| Failure::at(&self.input, error))?, start.elapsed())
        } else {
            (whole, Duration::ZERO)
        };
        session.progress.stage("stripping");
        let start = Instant::now();
        let skip = self.filter.map(|_| SkipStrip::new(tree.clone(), self.stripify(tree.faces())));
        Ok(Origin { mesh, tree, simplify_time, skip, strip_time: start.elapsed() })
    }

    fn level(&self, origin: &mut Origin, size: Size) -> Level {
        let Origin { mesh, tree, skip, .. } = origin;
        let faces = size.target().faces_of(mesh.faces.len());
        let contractions = tree.contractions_to(faces);
        let own = skip.is_none().then(|| tree.level(contractions));
        let start = Instant::now();
        let strips = match (skip, self.filter) {
            (Some(skip), Some(filter)) => {
                skip.set_level(contractions);
                match filter {
                    Shortened::None => skip.display(Filter::None),
                    Shortened::Stss => skip.display(Filter::Stss),
                    Shortened::Dtff => skip.display(Filter::Dtff),
                    Shortened::Repair => skip.repaired(self.effort.into()),
                }
            }
            _ => self.stripify(&own.unwrap_or_default()),
        };
        let time = start.elapsed();
        let triangles = tree.faces_left(contractions);
        let sent = StripStatistics::new(&strips);
        let reached = triangles <= faces;
        Level { size, reached, triangles, strips, sent, time, difference: None }
    }

    fn stripify(&self, faces: &[[VertexId; 3]]) -> Strips {
        let quality = match (self.quality, self.effort) {
            (Quality::Fast, _) => strip::Quality::Fast,
            (Quality::Best, Tried::Quick) => strip::Quality::QUICK,
            (Quality::Best, Tried::Thorough) => strip::Quality::THOROUGH,
        };
        strip::stripify(faces, &strip::Options { quality, ..strip::Options::default() })
    }

    fn json(&self, origin: &Origin, levels: &[Level]) -> Value {
        let connectivity = Connectivity::new(&origin.mesh.faces, origin.mesh.positions.len());
        let degenerate = connectivity.degenerate_faces();
        let left_out = origin.mesh.faces.len() - origin.tree.faces().len();
        let name = |value: &dyn Fn() -> Option<clap::builder::PossibleValue>| {
            value().map(|value| value.get_name().to_owned())
        };
        json!({
            "file": files::name(&self.input),
            "input_faces": origin.mesh.faces.len(),
            "degenerate_faces": degenerate,
            "duplicate_faces": left_out - degenerate,
            "non_manifold_edges": connectivity.non_manifold_edges(),
            "inconsistent_edges": connectivity.inconsistent_edges(),
            "filter": name(&|| self.filter.as_ref()?.to_possible_value()),
            "quality": name(&|| self.quality.to_possible_value()),
            "effort": name(&|| self.effort.to_possible_value()),
            "levels": levels.iter().map(Level::json).collect::<Vec<_>>(),
            "simplify_seconds": origin.simplify_time.as_secs_f64(),
            "strip_seconds": origin.skip.as_ref().map(|_| origin.strip_time.as_secs_f64()),
            "verified": self.verify.then(|| !levels.iter().any(Level::is_wrong)),
            "out": self.out.as_deref().map(files::name),
        })
    }
}

impl Level {
    fn is_wrong(&self) -> bool {
        self.difference.is_some_and(|difference| difference != Difference::default())
    }

    fn json(&self) -> Value {
        let Self { sent, difference, .. } = self;
        json!({
            "size": self.size.to_string(),
            "reached": self.reached,
            "triangles": self.triangles,
            "vertices_sent": sent.vertices_sent,
            "indices_with_restart": sent.indices_with_restart,
            "strips": sent.strips,
            "swaps": sent.swaps,
            "acmr16": sent.acmr16,
            "acmr32": sent.acmr32,
            "seconds": self.time.as_secs_f64(),
            "missing": difference.map(|difference| difference.missing),
            "extra": difference.map(|difference| difference.extra),
        })
    }
}

impl From<Tried> for Effort {
    fn from(tried: Tried) -> Self {
        match tried {
            Tried::Quick => Self::Quick,
            Tried::Thorough => Self::Thorough,
        }
    }
}

/// Refuses levels that are none.
fn check_sizes(sizes: &[Size], faces: usize) -> Result<(), Failure> {
    let is_level = |size: &&Size| match size {
        Size::Faces(count) => (1..=faces).contains(count),
        Size::Ratio(ratio) => *ratio > 0.0,
    };
    match sizes.iter().find(|size| !is_level(size)) {
        None => Ok(()),
        Some(size) => Err(Failure::usage(format_args!(
            "--levels: {size} is out of range; use more than 0% and up to 100%, or 1 to {faces} faces"
        ))),
    }
}
