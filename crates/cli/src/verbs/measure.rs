//! `measure`: how far two meshes are apart, and what became of area and volume.

use std::path::PathBuf;

use clap::Args;
use meshlod::Mesh;
use meshlod::measure::{area, surface_distance, volume};

use crate::answer::Answer;
use crate::args::{Reading, Sampling};
use crate::distance;
use crate::failure::Failure;
use crate::files;
use crate::numbers::{change, value};
use crate::session::Session;
use crate::table::aligned;

#[derive(Args)]
pub struct Measure {
    /// The original; forward is from here, percentages are of its diagonal
    #[arg(value_name = "A")]
    a: PathBuf,
    /// What is held against it
    #[arg(value_name = "B")]
    b: PathBuf,
    #[command(flatten)]
    sampling: Sampling,
    #[command(flatten)]
    reading: Reading,
}

impl Measure {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if files::is_pipe(&self.a) && files::is_pipe(&self.b) {
            return Err(Failure::usage("-: only one of the two can come through a pipe"));
        }
        let [a, b] = [&self.a, &self.b].map(|path| -> Result<Mesh, Failure> {
            let scene = files::read(path, &self.reading, session)?;
            Ok(distance::surface_of(&scene, distance::meshes(&scene)))
        });
        let (a, b) = (a?, b?);
        session.progress.stage("measuring");
        let surfaces = (distance::ready(&a, &self.a)?, distance::ready(&b, &self.b)?);
        let apart = surface_distance(&surfaces.0, &surfaces.1, &self.sampling.options())
            .map_err(Failure::new)?;
        let (areas, volumes) = ([area(&a), area(&b)], [volume(&a), volume(&b)]);

        let mut json = distance::to_json(&apart);
        json["area_a"] = areas[0].into();
        json["area_b"] = areas[1].into();
        json["volume_a"] = volumes[0].into();
        json["volume_b"] = volumes[1].into();
        let row = |name: &str, [a, b]: [f64; 2]| [name.into(), value(a), value(b), change(a, b)];
        let text = format!(
            "{}diagonal {}\n\n{}",
            distance::to_table(&apart),
            value(apart.diagonal),
            aligned(&[
                ["", "A", "B", "change"].map(String::from),
                row("area", areas),
                row("volume", volumes),
            ]),
        );
        Ok(Answer::new(json, text))
    }
}
