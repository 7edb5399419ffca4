//! All methods at work on one mesh, each by itself.

use meshlod::Method;
use meshlod::measure::{DistanceOptions, Surface};
use meshlod::picture::ReferenceImages;

use crate::amounts::Size;
use crate::compare::output::Output;
use crate::failure::Failure;
use crate::page::descent::{Bench, Chain, Descent, Level};
use crate::page::studio::{Shots, Studio};
use crate::page::subject::Subject;
use crate::reduce;
use crate::session::Session;
use crate::volume::unconserved_text;

/// What is to be done.
pub struct Contest<'s> {
    pub subject: &'s Subject,
    pub original: &'s Surface<'s>,
    pub options: DistanceOptions,
    /// Finest first.
    pub sizes: Vec<Size>,
    pub methods: Vec<Method>,
    pub pictures: bool,
}

/// What came of it.
pub struct Outcome {
    /// One for every method.
    pub entries: Vec<Entry>,
    /// Of the input, where pictures are wanted.
    pub input: Option<Shots>,
}

/// What one method made of the mesh.
pub struct Entry {
    pub chain: Chain,
    /// One for every level, where pictures are wanted.
    pub shots: Vec<Shots>,
    /// Why there are no more levels.
    pub trouble: Option<Failure>,
}

/// What a run works with beside what is to be done.
struct Means<'c> {
    drawing: Option<Drawing<'c>>,
    output: &'c Output,
    session: &'c Session,
}

/// What pictures are made with, and compared.
struct Drawing<'c> {
    studio: Studio<'c>,
    portrait: ReferenceImages<'c>,
}

/// Width and height of the pictures that are compared: a sixteenth of the protocol's pixels, so
/// that a level costs a fraction of a second.
pub const COMPARED_SIDE: u32 = 256;

impl Contest<'_> {
    /// Makes, measures, draws and writes all levels. The geometry of a level is let go when that is
    /// done: the next is as large.
    ///
    /// A method that cannot is an entry with trouble. Where none can, that is a failure.
    pub fn run(&self, output: &Output, session: &Session) -> Result<Outcome, Failure> {
        let drawing = self.pictures.then(|| self.drawing()).transpose()?;
        let means = Means { drawing, output, session };
        let mut entries = Vec::new();
        for (i, &method) in self.methods.iter().enumerate() {
            let what = format!("{} ({} of {})", method.name(), i + 1, self.methods.len());
            let chain = Chain { method, levels: Vec::new() };
            let mut entry = Entry { chain, shots: Vec::new(), trouble: None };
            self.descend(&mut entry, &what, &means)?;
            entries.push(entry);
        }
        if entries.iter().all(|entry| entry.chain.levels.is_empty())
            && let Some(trouble) = entries.iter_mut().find_map(|entry| entry.trouble.take())
        {
            return Err(trouble);
        }
        let input = means.drawing.map(|drawing| drawing.studio.input()).transpose()?;
        Ok(Outcome { entries, input })
    }

    fn drawing(&self) -> Result<Drawing<'_>, Failure> {
        let Self { subject, original, .. } = self;
        let portrait =
            ReferenceImages::of_side(&subject.mesh, &subject.look.coat.paint(), COMPARED_SIDE);
        let portrait =
            portrait.map_err(|error| Failure::new(format_args!("{}: {error}", subject.name)))?;
        Ok(Drawing { studio: Studio::new(subject, original), portrait })
    }

    /// Takes a method from size to size. Fails only where a picture or a file does.
    fn descend(&self, entry: &mut Entry, what: &str, means: &Means<'_>) -> Result<(), Failure> {
        let Self { subject, original, options, .. } = *self;
        let Means { drawing, output, session } = means;
        let method = entry.chain.method;
        let bench = Bench { subject, original, options, session };
        let mut descent = match Descent::start(bench, method, what.into()) {
            Ok(descent) => descent,
            Err(trouble) => {
                entry.trouble = Some(trouble);
                return Ok(());
            }
        };
        for &size in &self.sizes {
            let mut made = match descent.go_on(size, output.file(method, size)) {
                Ok(made) => made,
                Err(trouble) => {
                    entry.trouble = Some(trouble);
                    return Ok(());
                }
            };
            if let Some(Drawing { studio, portrait }) = drawing {
                session.progress.stage(&format!("{what}: drawing"));
                entry.shots.push(studio.level(&made.shown, method.name())?);
                let seen = portrait.error_of(&made.shown).map_err(Failure::new)?;
                made.level.flip = Some(seen.flip);
            }
            session.progress.stage(&format!("{what}: writing"));
            let mut scene = subject.scene.clone();
            reduce::replace(&mut scene, made.meshes);
            output.write(&made.level.file, &scene)?;
            entry.chain.levels.push(made.level);
        }
        Ok(())
    }
}

impl Outcome {
    /// The levels of one size, with the entries that have it.
    pub fn at(&self, size: usize) -> impl Iterator<Item = (&Entry, &Level)> + Clone {
        self.entries.iter().filter_map(move |entry| Some((entry, entry.chain.levels.get(size)?)))
    }

    /// Methods that conserve the volume and what they could not conserve at a size, and where.
    pub fn unconserved(&self, size: usize) -> Vec<(Method, String)> {
        let line = |(entry, level): (&Entry, &Level)| {
            let method = entry.chain.method;
            Some((method, unconserved_text(method, &level.report.volume)?))
        };
        self.at(size).filter_map(line).collect()
    }

    /// Says what did not go as wanted.
    pub fn warn(&self, name: &str, session: &Session) {
        for Entry { chain, trouble, .. } in &self.entries {
            let method = chain.method.name();
            for level in chain.levels.iter().filter(|level| !level.report.reached) {
                let reason = reduce::why_not_reached(&level.report);
                session.warn(format_args!("{name}: {method}, {}: {reason}", level.size));
            }
            if let Some(trouble) = trouble {
                session.warn(format_args!("{method}: {trouble}"));
            }
        }
    }
}
