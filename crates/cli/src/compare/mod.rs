//! `compare`: runs every method on one mesh and writes a table, files, and a page with pictures.
//!
//! [`comparison`] builds and measures the levels, and [`output`] writes them; [`verdict`] says
//! which method did best, and [`page`] and [`summary`] show the same figures on a page and on the
//! terminal. [`front`] chooses the side that the pictures show.

mod comparison;
mod front;
mod output;
mod page;
mod section;
mod summary;
mod verdict;

use std::path::PathBuf;

use clap::Args;
use meshlod::io::write_file;
use meshlod::picture::View;
use meshlod::scene::single_sided_materials;
use meshlod::{Method, Options};

use crate::options::args::{ReadArgs, SamplingArgs, ViewArgs};
use crate::options::constraints::ConstraintArgs;
use crate::options::fuse::FuseReport;
use crate::options::locks::InputScene;
use crate::options::parse::{self, LevelSize};
use crate::page::style::{self, OwnedPaint, SubjectStyle};
use crate::page::subject::Subject;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use comparison::Comparison;
use output::Output;

/// Run all methods on one mesh: a table, and a page with pictures and error heat maps
#[derive(Args)]
pub struct Compare {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// Folder to write to; created if missing
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Methods to compare [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<Method>,
    /// Draw no pictures: the page has figures only
    #[arg(long)]
    no_pictures: bool,
    #[command(flatten)]
    sizes: Sizes,
    #[command(flatten)]
    constraints: ConstraintArgs,
    #[command(flatten)]
    viewpoint: ViewArgs,
    #[command(flatten)]
    sampling: SamplingArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

/// Sizes of the levels.
#[derive(Args)]
#[command(next_help_heading = "Targets, one of")]
#[group(required = true, multiple = false)]
struct Sizes {
    /// Target ratios of the faces: 10%,1%
    #[arg(short, long, value_name = "RATIOS", value_delimiter = ',', value_parser = parse::ratio_of_faces,
        allow_hyphen_values = true)]
    ratio: Vec<f64>,
    /// Target numbers of faces: 5000,500
    #[arg(short, long, value_name = "NUMBERS", value_delimiter = ',', value_parser = parse::faces,
        allow_negative_numbers = true)]
    faces: Vec<usize>,
}

impl Sizes {
    /// Returns the sizes without duplicates, finest first.
    fn sorted(&self) -> Vec<LevelSize> {
        let mut ratios = self.ratio.clone();
        ratios.sort_by(|a, b| b.total_cmp(a));
        ratios.dedup();
        let mut faces = self.faces.clone();
        faces.sort_unstable_by(|a, b| b.cmp(a));
        faces.dedup();
        ratios
            .into_iter()
            .map(LevelSize::Ratio)
            .chain(faces.into_iter().map(LevelSize::Faces))
            .collect()
    }
}

impl Compare {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_folder(&self.out)?;
        let (subject, output, fused) = self.read(session)?;
        let base = self.base_options(&subject, session)?;
        let original = subject.surface()?;
        files::make_folder(&self.out)?;
        let comparison = Comparison {
            subject: &subject,
            original: &original,
            options: self.sampling.options(),
            sizes: self.sizes.sorted(),
            methods: self.methods(),
            pictures: !self.no_pictures,
            constraints: &self.constraints,
            fused: fused.as_ref(),
            base: &base,
        };
        let outcome = comparison.run(&output, session)?;

        session.progress.stage("writing the page");
        let json = summary::json(&comparison, &outcome, &output);
        write_file(&self.out.join("compare.json"), format!("{json:#}\n").as_bytes())?;
        let page = page::page(&comparison, &outcome).into_string();
        write_file(&self.out.join("index.html"), page.as_bytes())?;
        outcome.warn(&subject.name, self.constraints.topology.kind(), session);
        Ok(Answer::new(json, summary::text(&comparison, &outcome, &output)))
    }

    fn read(&self, session: &Session) -> Result<(Subject, Output, Option<FuseReport>), Failure> {
        let mut scene = files::read_surface(&self.input, &self.reading, session)?;
        let fused = self.constraints.fuse.apply(&mut scene, session);
        let output = Output::new(&self.out, &self.input, &scene, session);
        let materials = style::materials(&scene, &self.input, session);
        let asked = self.viewpoint.view();
        let name = files::name(&self.input);
        let title = self.input.file_name().unwrap_or_default().to_string_lossy();
        let single_sided = single_sided_materials(&scene);
        let style = |mesh: &_| {
            let View { direction, up, .. } = match self.no_pictures || self.viewpoint.is_given() {
                true => asked,
                false => front::facing(mesh, asked),
            };
            let paint = OwnedPaint::comparison(mesh, materials);
            SubjectStyle { single_sided, ..SubjectStyle::new(paint, mesh, direction, up) }
        };
        Ok((Subject::new([&name, &title], scene, style), output, fused))
    }

    /// Returns the options that all methods share.
    fn base_options(&self, subject: &Subject, session: &Session) -> Result<Options, Failure> {
        let input = InputScene { scene: &subject.scene, path: &self.input, reading: &self.reading };
        self.constraints.apply(Options::default(), &input, session)
    }

    /// Returns the methods without duplicates, in the order of [`Method::ALL`].
    fn methods(&self) -> Vec<Method> {
        let wanted = |method: &Method| self.methods.is_empty() || self.methods.contains(method);
        Method::ALL.into_iter().filter(wanted).collect()
    }
}
