//! Lengths that an option asks for, in model units, relative to the diagonal or in a unit.

use std::path::Path;

use meshlod::scene::world_bounds;
use meshlod::{Format, Scene};

use crate::options::parse::{self, Bound};
use crate::options::{doubt, number};
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::value;

/// Length that an option asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Tolerance {
    /// Length in model units, or relative to the diagonal.
    Bound(Bound),
    /// Length in a unit, for files that have one.
    Metric { text: String, metres: f64 },
}

impl Tolerance {
    /// Parses a length: `0.5` in model units, `0.1%` of the diagonal, or `1mm`.
    pub fn parse(text: &str) -> Result<Self, String> {
        match number::metres(text) {
            Some(metres) => Ok(Self::Metric { text: text.into(), metres }),
            None => parse::bound(text).map(Self::Bound),
        }
    }

    /// Returns the length in the units of a file: those of glTF are metres.
    ///
    /// # Errors
    /// If it has a unit and the file has none.
    pub fn bound(&self, option: &str, input: &Path, session: &Session) -> Result<Bound, Failure> {
        let is_metric = files::format_of(input, session).is_some_and(Format::is_gltf);
        self.bound_if(is_metric, option, input)
    }

    /// Returns the length in the units of a scene that was read: those of glTF are metres.
    ///
    /// # Errors
    /// If it has a unit and the scene has none.
    pub fn bound_in(&self, scene: &Scene, option: &str, input: &Path) -> Result<Bound, Failure> {
        self.bound_if(scene.source.is_some(), option, input)
    }

    fn bound_if(&self, is_metric: bool, option: &str, input: &Path) -> Result<Bound, Failure> {
        match self {
            Self::Bound(bound) => Ok(*bound),
            Self::Metric { metres, .. } if is_metric => Ok(Bound::Length(*metres)),
            Self::Metric { text, metres } => Err(Failure::usage(format_args!(
                "{option} {text}: {} has no unit; give {} if it is in metres, {} if it is in \
                 millimetres, or a percentage of its diagonal, such as 0.1%",
                files::name(input),
                value(*metres),
                value(1e3 * metres),
            ))
            .about(input)),
        }
    }

    /// Warns if the length leaves little of a model and its unit may be missing.
    pub fn doubt(&self, option: &str, input: &Path, scene: &Scene, session: &Session) {
        if let Self::Bound(bound) = self {
            let diagonal = world_bounds(scene).diagonal();
            session.doubt(input, doubt::of_bound(option, *bound, diagonal));
        }
    }
}
