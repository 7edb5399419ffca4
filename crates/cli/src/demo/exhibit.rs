//! One sample with all its levels, files and pictures.

use std::path::Path;

use meshlod::io::{gltf, write_lods};
use meshlod::measure::DistanceOptions;
use meshlod::{Mesh, Method, Scene, WriteOptions, write};

use crate::amounts::Size;
use crate::demo::samples::Sample;
use crate::demo::{METHODS, main_method};
use crate::failure::Failure;
use crate::page::descent::{Bench, Chain, Descent, Level, Made};
use crate::page::studio::{Shots, Studio};
use crate::page::subject::Subject;
use crate::reduce;
use crate::session::Session;
use crate::verbs::lods::screen_coverage;

/// The levels of a chain, as parts of the input's faces.
const RATIOS: [f64; 4] = [0.5, 0.25, 0.1, 0.03];

/// Samples each way, beside all vertices: the mean within about 0.2 %, and a page in seconds.
pub const SAMPLES: usize = 100_000;

/// A sample, what was made of it, and where that is.
pub struct Exhibit {
    pub sample: &'static Sample,
    pub subject: Subject,
    /// One for every method.
    pub chains: Vec<Chain>,
    /// What the scene shows at the levels of the main method.
    pub shown: Vec<Mesh>,
    /// Pictures of the input.
    pub input: Shots,
    /// Pictures of the levels of the main method.
    pub shots: Vec<Shots>,
}

impl Exhibit {
    /// Makes, measures, writes and draws it.
    pub fn make(
        sample: &'static Sample,
        folder: &Path,
        session: &Session,
    ) -> Result<Self, Failure> {
        session.progress.stage(&format!("{}: making", sample.name));
        let subject = sample.subject();
        let original = subject.surface()?;
        let options = DistanceOptions { samples: SAMPLES, ..DistanceOptions::default() };
        let bench = Bench { subject: &subject, original: &original, options, session };
        let out = Out { sample, folder };
        out.write(&sample.input_file(), &subject.scene)?;
        let (mut chains, mut main) = (Vec::new(), Vec::new());
        for method in METHODS {
            let mades = out.chain(bench, method)?;
            if method == main_method() {
                out.write_lods(&subject.scene, &mades)?;
                main = mades.iter().map(|made| made.shown.clone()).collect();
            }
            let levels = mades.into_iter().map(|made| made.level).collect();
            chains.push(Chain { method, levels });
        }
        session.progress.stage(&format!("{}: drawing", sample.name));
        let studio = Studio::new(&subject, &original);
        let shots = main.iter().map(|mesh| studio.level(mesh, "")).collect::<Result<_, _>>()?;
        let input = studio.input()?;
        drop(original);
        Ok(Self { sample, subject, chains, shown: main, input, shots })
    }

    /// The chain that is drawn.
    pub fn main_chain(&self) -> &Chain {
        let main = |chain: &&Chain| chain.method == main_method();
        self.chains.iter().find(main).expect("the main method is one of the methods")
    }
}

impl Sample {
    /// The name of the input's file.
    pub fn input_file(&self) -> String {
        format!("{}.ply", self.name)
    }

    /// The name of the file with the levels of the main method, linked by `MSFT_lod`.
    pub fn lods_file(&self) -> String {
        format!("{}.glb", self.name)
    }

    fn level_file(&self, method: Method, size: Size) -> String {
        format!("{}-{}-{}.ply", self.name, method.name(), size.in_file_names())
    }
}

/// Where the files of a sample go.
struct Out<'f> {
    sample: &'static Sample,
    folder: &'f Path,
}

impl Out<'_> {
    /// All levels of a method, written.
    fn chain(&self, bench: Bench<'_>, method: Method) -> Result<Vec<Made>, Failure> {
        let what = format!("{}: {}", self.sample.name, method.name());
        let mut descent = Descent::start(bench, method, what)?;
        let level = |ratio| {
            let file = self.sample.level_file(method, Size::Ratio(ratio));
            let made = descent.go_on(Size::Ratio(ratio), file)?;
            let mut scene = bench.subject.scene.clone();
            reduce::replace(&mut scene, made.meshes.clone());
            self.write(&made.level.file, &scene)?;
            Ok(made)
        };
        RATIOS.into_iter().map(level).collect()
    }

    fn write(&self, file: &str, scene: &Scene) -> Result<(), Failure> {
        Ok(write(&self.folder.join(file), scene, &WriteOptions::default())?)
    }

    fn write_lods(&self, scene: &Scene, mades: &[Made]) -> Result<(), Failure> {
        let coverage = |level: &Level| level.measured.as_ref().map_or(1.0, screen_coverage);
        let level = |made: &Made| gltf::Level {
            meshes: made.meshes.clone(),
            screen_coverage: coverage(&made.level),
        };
        let levels: Vec<_> = mades.iter().map(level).collect();
        Ok(write_lods(&self.folder.join(self.sample.lods_file()), scene, &levels)?)
    }
}
