//! One subject with all its levels, files and pictures.

use std::path::Path;

use meshlod::io::{gltf, write_lods};
use meshlod::{Mesh, Method, Scene, WriteOptions, write};

use crate::demo::chain::{Chain, Level, Original};
use crate::demo::counts::Counts;
use crate::demo::main_method;
use crate::demo::studio::{Pictures, Studio};
use crate::demo::subjects::Subject;
use crate::failure::Failure;
use crate::session::Session;
use crate::verbs::lods::screen_coverage;

/// A subject, what was made of it, and where that is.
pub struct Exhibit {
    pub subject: &'static Subject,
    pub input: Input,
    /// One for every method.
    pub chains: Vec<Chain>,
    pub pictures: Pictures,
}

/// The mesh that all begins with.
pub struct Input {
    pub mesh: Mesh,
    pub counts: Counts,
}

impl Exhibit {
    /// Makes, measures, writes and draws it.
    pub fn make(
        subject: &'static Subject,
        folder: &Path,
        session: &Session,
    ) -> Result<Self, Failure> {
        session.progress.stage(&format!("{}: making", subject.name));
        let mesh = subject.mesh();
        let original = Original::new(subject.name, &mesh)?;
        let chain = |method| original.chain(method, session);
        let chains: Vec<Chain> =
            Method::ALL.into_iter().map(chain).collect::<Result<_, Failure>>()?;
        session.progress.stage(&format!("{}: drawing", subject.name));
        let main = main_of(&chains);
        let pictures = Studio::new(subject, &original).pictures(main)?;
        let counts = Counts::of(&mesh);
        let input = Input { mesh, counts };
        let exhibit = Self { subject, input, chains, pictures };
        session.progress.stage(&format!("{}: writing", subject.name));
        exhibit.write(folder)?;
        Ok(exhibit)
    }

    /// The chain that is drawn.
    pub fn main_chain(&self) -> &Chain {
        main_of(&self.chains)
    }

    /// The name of the input's file.
    pub fn input_file(&self) -> String {
        format!("{}.ply", self.subject.name)
    }

    /// The name of the file with the levels of the main method, linked by `MSFT_lod`.
    pub fn lods_file(&self) -> String {
        format!("{}.glb", self.subject.name)
    }

    /// The name of a level's file.
    pub fn level_file(&self, method: Method, level: &Level) -> String {
        format!("{}-{}-{}.ply", self.subject.name, method.name(), 100.0 * level.ratio)
    }

    fn write(&self, folder: &Path) -> Result<(), Failure> {
        self.write_ply(&folder.join(self.input_file()), &self.input.mesh)?;
        for chain in &self.chains {
            for level in &chain.levels {
                self.write_ply(&folder.join(self.level_file(chain.method, level)), &level.mesh)?;
            }
        }
        let level = |level: &Level| gltf::Level {
            meshes: vec![level.mesh.clone()],
            screen_coverage: screen_coverage(&level.distance),
        };
        let levels: Vec<_> = self.main_chain().levels.iter().map(level).collect();
        let scene = Scene::from_mesh(self.subject.name, self.input.mesh.clone());
        Ok(write_lods(&folder.join(self.lods_file()), &scene, &levels)?)
    }

    fn write_ply(&self, path: &Path, mesh: &Mesh) -> Result<(), Failure> {
        let scene = Scene::from_mesh(self.subject.name, mesh.clone());
        Ok(write(path, &scene, &WriteOptions::default())?)
    }
}

fn main_of(chains: &[Chain]) -> &Chain {
    let main = |chain: &&Chain| chain.method == main_method();
    chains.iter().find(main).expect("a chain was made by every method")
}
