//! Comparison of simplification methods on one mesh, each run independently.

use meshlod::measure::{DistanceOptions, PreparedSurface};
use meshlod::picture::{ReferenceImages, Style};
use meshlod::{Method, Options, Topology};

use crate::compare::output::Output;
use crate::options::constraints::ConstraintArgs;
use crate::options::fuse::FuseReport;
use crate::options::parse::LevelSize;
use crate::options::topology;
use crate::page::chain::{Chain, ChainBuilder, ChainSetup, Level, ReadyScene};
use crate::page::renderer::{LARGE, LevelPictures, SubjectRenderer};
use crate::page::subject::Subject;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::text::simplify_report;
use crate::text::stuck::Stuck;

/// A mesh, and the sizes and methods for which to compare simplifications of it.
pub struct Comparison<'s> {
    pub subject: &'s Subject,
    pub original: &'s PreparedSurface<'s>,
    pub options: DistanceOptions,
    /// Sizes to simplify to, the largest first.
    pub sizes: Vec<LevelSize>,
    pub methods: Vec<Method>,
    pub pictures: bool,
    pub constraints: &'s ConstraintArgs,
    pub fused: Option<&'s FuseReport>,
    /// Options that all methods share.
    pub base: &'s Options,
}

/// Measurements and pictures from a comparison of methods.
pub struct ComparisonResult {
    /// Simplified meshes and measurements, one entry for each method.
    pub entries: Vec<MethodResult>,
    /// Pictures of the input mesh, if requested.
    pub input: Option<LevelPictures>,
}

/// Simplified meshes that one method made, with their measurements.
pub struct MethodResult {
    pub chain: Chain,
    /// Pictures of the simplified mesh of each size, if requested.
    pub pictures: Vec<LevelPictures>,
    /// Reason why the method stopped before the last size.
    pub failure: Option<Failure>,
}

/// Renderer, output and session that all methods use.
struct RunContext<'c> {
    tools: Option<PictureTools<'c>>,
    output: &'c Output,
    session: &'c Session,
}

/// Renderer of the page's pictures, and reference images to compare with.
struct PictureTools<'c> {
    renderer: SubjectRenderer<'c>,
    reference: ReferenceImages<'c>,
}

/// Width and height in pixels of the pictures for the image error: a sixteenth of the protocol's
/// pixel count, so that a level takes a fraction of a second.
pub const COMPARED_SIDE: u32 = 256;

impl Comparison<'_> {
    /// Simplifies, measures, draws and writes all levels. The memory of a level is freed before the
    /// next is made.
    ///
    /// A method that fails becomes an entry with its failure. It is an error only if all methods
    /// fail.
    pub fn run(&self, output: &Output, session: &Session) -> Result<ComparisonResult, Failure> {
        let tools = self.pictures.then(|| self.picture_tools()).transpose()?;
        let context = RunContext { tools, output, session };
        let ready = self.ready(Method::default(), session)?;
        topology::warn(ready.scene.near_borders(), session);
        drop(ready);
        let mut entries = Vec::new();
        for (i, &method) in self.methods.iter().enumerate() {
            let what = format!("{} ({} of {})", method.name(), i + 1, self.methods.len());
            let chain = Chain { method, levels: Vec::new() };
            let mut entry = MethodResult { chain, pictures: Vec::new(), failure: None };
            self.run_method(&mut entry, &what, &context)?;
            entries.push(entry);
        }
        if entries.iter().all(|entry| entry.chain.levels.is_empty())
            && let Some(failure) = entries.iter_mut().find_map(|entry| entry.failure.take())
        {
            return Err(failure);
        }
        let input = context.tools.map(|tools| tools.renderer.input()).transpose()?;
        Ok(ComparisonResult { entries, input })
    }

    /// Returns the scene ready for a method.
    fn ready(&self, method: Method, session: &Session) -> Result<ReadyScene<'_>, Failure> {
        let Self { subject, constraints, base, .. } = self;
        let options = Options { method, ..(*base).clone() };
        ReadyScene::new(subject, &options, constraints.topology.borders(), session)
    }

    fn picture_tools(&self) -> Result<PictureTools<'_>, Failure> {
        let Self { subject, original, .. } = self;
        let style = Style {
            size: [COMPARED_SIDE; 2],
            paint: subject.style.paint.as_paint(),
            single_sided: &subject.style.single_sided,
            ..Style::comparison()
        };
        let reference = ReferenceImages::with_style(&subject.mesh, style)
            .map_err(|error| Failure::new(format_args!("{}: {error}", subject.name)))?;
        Ok(PictureTools { renderer: SubjectRenderer::new(subject, original, LARGE), reference })
    }

    /// Runs a method through all sizes. Fails only if a picture or a file does.
    fn run_method(
        &self,
        entry: &mut MethodResult,
        what: &str,
        context: &RunContext<'_>,
    ) -> Result<(), Failure> {
        let Self { subject, original, options, .. } = *self;
        let RunContext { tools, output, session } = context;
        let method = entry.chain.method;
        let setup = ChainSetup { subject, original, options, session };
        let ready = self.ready(method, session)?;
        let mut builder = match ChainBuilder::start(setup, &ready, what.into()) {
            Ok(builder) => builder,
            Err(failure) => {
                entry.failure = Some(failure);
                return Ok(());
            }
        };
        for &size in &self.sizes {
            let target = self.fused.map_or(size.target(), |fused| fused.target(size.target()));
            let mut made = match builder.next_level(size, target, output.file(method, size)) {
                Ok(made) => made,
                Err(failure) => {
                    entry.failure = Some(failure);
                    return Ok(());
                }
            };
            if let Some(PictureTools { renderer, reference }) = tools {
                session.progress.stage(&format!("{what}: drawing"));
                entry.pictures.push(renderer.level(&made.shown, method.name())?);
                let seen = reference.error_of(&made.shown).map_err(Failure::new)?;
                made.level.flip = Some(seen.flip);
            }
            session.progress.stage(&format!("{what}: writing"));
            output.write(&made.level.file, &subject.scene_with(made.meshes))?;
            entry.chain.levels.push(made.level);
        }
        Ok(())
    }
}

impl ComparisonResult {
    /// Iterates over the sizes that at least one method came to, with their indices.
    pub fn sizes<'s>(
        &self,
        sizes: &'s [LevelSize],
    ) -> impl Iterator<Item = (usize, &'s LevelSize)> {
        sizes.iter().enumerate().filter(|(index, _)| self.at(*index).next().is_some())
    }

    /// Iterates over the methods that reached one size, with their simplified meshes.
    pub fn at(&self, size: usize) -> impl Iterator<Item = (&MethodResult, &Level)> + Clone {
        self.entries.iter().filter_map(move |entry| Some((entry, entry.chain.levels.get(size)?)))
    }

    /// Prints warnings about methods that failed and targets that were missed.
    pub fn warn(&self, name: &str, topology: Topology, session: &Session) {
        for MethodResult { chain, failure, .. } in &self.entries {
            let method = chain.method.name();
            for level in chain.levels.iter().filter(|level| !level.report.reached) {
                let reason =
                    simplify_report::why_not_reached(&level.report, topology, Stuck::default());
                session.warn(format_args!("{name}: {method}, {}: {reason}", level.size));
            }
            if let Some(failure) = failure {
                session.warn(format_args!("{method}: {failure}"));
            }
        }
    }
}
