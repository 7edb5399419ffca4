//! Simplified meshes, files and pictures of one sample mesh.

use std::path::Path;

use meshlod::io::{gltf, write_lods};
use meshlod::jobs::SwitchCamera;
use meshlod::measure::DistanceOptions;
use meshlod::{Borders, Mesh, Method, Options, Scene, WriteOptions, write};

use crate::demo::samples::DemoSample;
use crate::demo::{METHODS, main_method};
use crate::options::parse::LevelSize;
use crate::page::chain::{Chain, ChainBuilder, ChainSetup, Level, LevelMesh, ReadyScene};
use crate::page::renderer::{LevelPictures, SIZE, SubjectRenderer};
use crate::page::subject::Subject;
use crate::session::Session;
use crate::session::failure::Failure;

/// Levels of a chain, as ratios of the input's faces.
const RATIOS: [f64; 4] = [0.5, 0.25, 0.1, 0.03];

/// Number of random points per direction at which distances are measured, in addition to all
/// vertices: the mean is then within about 0.2 %.
pub const SAMPLES: usize = 100_000;

/// A sample mesh with its simplified levels and pictures.
pub struct SampleReport {
    pub sample: &'static DemoSample,
    pub subject: Subject,
    /// Simplified levels of the sample by each method.
    pub chains: Vec<Chain>,
    /// Simplified scenes of the main method, each flattened to one mesh.
    pub shown: Vec<Mesh>,
    /// Pictures of the full-resolution sample.
    pub input: LevelPictures,
    /// Pictures of the levels made by the main method.
    pub pictures: Vec<LevelPictures>,
}

impl SampleReport {
    /// Simplifies, measures, writes and draws one sample mesh.
    pub fn make(
        sample: &'static DemoSample,
        folder: &Path,
        session: &Session,
    ) -> Result<Self, Failure> {
        session.progress.stage(&format!("{}: making", sample.name));
        let subject = sample.subject();
        let original = subject.surface()?;
        let options = DistanceOptions { samples: SAMPLES, ..DistanceOptions::default() };
        let setup = ChainSetup { subject: &subject, original: &original, options, session };
        let out = SampleFiles { sample, folder };
        out.write(&sample.input_file(), &subject.scene)?;
        let (mut chains, mut main) = (Vec::new(), Vec::new());
        for method in METHODS {
            let levels = out.chain(setup, method)?;
            if method == main_method() {
                out.write_lods(&subject.scene, &levels)?;
                main = levels.iter().map(|made| made.shown.clone()).collect();
            }
            let levels = levels.into_iter().map(|made| made.level).collect();
            chains.push(Chain { method, levels });
        }
        session.progress.stage(&format!("{}: drawing", sample.name));
        let renderer = SubjectRenderer::new(&subject, &original, SIZE);
        let pictures =
            main.iter().map(|mesh| renderer.level(mesh, "")).collect::<Result<_, _>>()?;
        let input = renderer.input()?;
        drop(original);
        Ok(Self { sample, subject, chains, shown: main, input, pictures })
    }

    /// Returns the levels made by the method that the page shows first.
    pub fn main_chain(&self) -> &Chain {
        let main = |chain: &&Chain| chain.method == main_method();
        self.chains.iter().find(main).expect("the main method is one of the methods")
    }
}

impl DemoSample {
    /// Returns the file name of the full-resolution sample.
    pub fn input_file(&self) -> String {
        format!("{}.ply", self.name)
    }

    /// Returns the name of the file with all levels of the main method, linked by `MSFT_lod`.
    pub fn lods_file(&self) -> String {
        format!("{}.glb", self.name)
    }

    fn level_file(&self, method: Method, size: LevelSize) -> String {
        format!("{}-{}-{}.ply", self.name, method.name(), size.in_file_names())
    }
}

/// Output files of a sample.
struct SampleFiles<'f> {
    sample: &'static DemoSample,
    folder: &'f Path,
}

impl SampleFiles<'_> {
    /// Builds and writes all levels of a method.
    fn chain(&self, setup: ChainSetup<'_>, method: Method) -> Result<Vec<LevelMesh>, Failure> {
        let what = format!("{}: {}", self.sample.name, method.name());
        let options = Options { method, ..Options::default() };
        let (subject, session) = (setup.subject, setup.session);
        let ready = ReadyScene::new(subject, &options, Borders::Stitch, session)?;
        let mut builder = ChainBuilder::start(setup, &ready, what)?;
        let level = |ratio| {
            let file = self.sample.level_file(method, LevelSize::Ratio(ratio));
            let size = LevelSize::Ratio(ratio);
            let made = builder.next_level(size, size.target(), file)?;
            self.write(&made.level.file, &subject.scene_with(made.meshes.clone()))?;
            Ok(made)
        };
        RATIOS.into_iter().map(level).collect()
    }

    fn write(&self, file: &str, scene: &Scene) -> Result<(), Failure> {
        Ok(write(self.folder.join(file), scene, &WriteOptions::default())?)
    }

    fn write_lods(&self, scene: &Scene, levels: &[LevelMesh]) -> Result<(), Failure> {
        let camera = SwitchCamera::default();
        let coverage = |level: &Level| {
            level.measured.as_ref().map_or(1.0, |measured| camera.screen_coverage(measured))
        };
        let level = |made: &LevelMesh| gltf::Level {
            meshes: made.meshes.clone(),
            screen_coverage: coverage(&made.level),
        };
        let levels: Vec<_> = levels.iter().map(level).collect();
        Ok(write_lods(
            self.folder.join(self.sample.lods_file()),
            scene,
            &levels,
            gltf::LodLayout::Linked,
        )?)
    }
}
