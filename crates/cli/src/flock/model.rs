//! Model of the members, with its materials and axes.

use std::path::{Path, PathBuf};

use clap::Args;
use meshlod::flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod::mesh::{Borders, ConditionOptions, Locks, Search, condition};
use meshlod::{Mesh, Method};

use crate::flock::axes::{self, Forward, SignedAxis};
use crate::flock::sample_fish::textured_fish;
use crate::options::args::ReadArgs;
use crate::options::parse;
use crate::page::style::{self, OwnedPaint};
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::count;

/// Options for the model of the members.
#[derive(Args)]
pub struct ModelArgs {
    /// Model of the members, or - [default: the sample fish]
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Way the model swims: +x, -x, +y, -y, +z, -z or auto
    ///
    /// With auto it is +z, as in glTF (-y if z is up); but a model that is half as long again along
    /// the other horizontal axis swims along that one, with its bulkier end first.
    #[arg(long, value_name = "AXIS", default_value = "auto", value_parser = axes::forward,
        allow_hyphen_values = true)]
    pub forward: Forward,
    /// Way that is up for the model
    #[arg(long, value_name = "AXIS", default_value = "+y", value_parser = axes::axis,
        allow_hyphen_values = true)]
    pub up: SignedAxis,
    /// Simplification method of the levels
    #[arg(long, value_name = "NAME", default_value = Method::default().name(),
        help = parse::methods())]
    pub method: Method,
}

/// Model of the members, ready for its levels.
pub struct FlockModel {
    /// Path of the file, or `fish` for the sample.
    pub name: String,
    /// File of the model; `None` for the sample.
    pub file: Option<PathBuf>,
    /// The model as one mesh, conditioned.
    pub mesh: Mesh,
    pub look: Look,
    /// Number of faces in the file.
    pub faces: usize,
    pub forward: SignedAxis,
    /// True if the forward axis was not given.
    pub is_guessed: bool,
    pub up: SignedAxis,
}

/// Greatest number of faces of a model: its levels for all directions take about a kilobyte a face.
const MAX_FACES: usize = 1_000_000;

impl FlockModel {
    /// Reads the model, or generates the sample.
    pub fn load(args: &ModelArgs, reading: &ReadArgs, session: &Session) -> Result<Self, Failure> {
        if let Forward::Along(forward) = args.forward {
            check_axes(forward, args.up)?;
        }
        let (mesh, look) = match &args.model {
            None => textured_fish().map_err(Failure::new)?,
            Some(path) => read(path, reading, session)?,
        };
        let (forward, is_guessed) = match args.forward {
            Forward::Along(axis) => (axis, false),
            Forward::Auto => (axes::guess(&mesh, args.up), args.model.is_some()),
        };
        Ok(Self {
            name: args.model.as_deref().map_or("fish".into(), files::name),
            file: args.model.clone(),
            faces: mesh.faces.len(),
            mesh: conditioned(mesh),
            look,
            forward,
            is_guessed,
            up: args.up,
        })
    }

    /// Returns the axes of the model.
    pub fn axes(&self) -> ModelAxes {
        ModelAxes { forward: self.forward.vector(), up: self.up.vector() }
    }

    /// Builds the levels of the model.
    pub fn table(&self, method: Method) -> Result<LevelTable, Failure> {
        let options = ChainOptions { axes: self.axes(), method, ..ChainOptions::default() };
        LevelTable::new(&self.mesh, &self.look, &options)
            .map_err(|error| Failure::at(Path::new(&self.name), error))
    }
}

/// Fails if both axes are along one line.
fn check_axes(forward: SignedAxis, up: SignedAxis) -> Result<(), Failure> {
    match forward.index == up.index {
        false => Ok(()),
        true => Err(Failure::usage(format_args!(
            "--forward {forward} and --up {up} must be along two axes"
        ))),
    }
}

/// Reads a scene as one mesh with its materials.
fn read(path: &Path, reading: &ReadArgs, session: &Session) -> Result<(Mesh, Look), Failure> {
    let scene = files::read_surface(path, reading, session)?;
    let paint = OwnedPaint::of(&scene, style::materials(&scene, path, session));
    let mesh = scene.into_mesh();
    match mesh.faces.len() {
        faces if faces > MAX_FACES => Err(Failure::at(
            path,
            format_args!(
                "a model can have {} faces, not {}; simplify it first",
                count(MAX_FACES),
                count(faces)
            ),
        )),
        _ => {
            let materials = match paint {
                OwnedPaint::Materials(materials) => Some(materials),
                _ => None,
            };
            Ok((mesh, Look { materials }))
        }
    }
}

/// Sews borders that lie on each other and splits non-manifold vertices.
fn conditioned(mesh: Mesh) -> Mesh {
    let options =
        ConditionOptions { search: Search::All, borders: Borders::Stitch, lock_boundary: false };
    let changed = condition(&mesh, &Locks::default(), &options);
    changed.map_or(mesh, |conditioned| conditioned.mesh)
}
