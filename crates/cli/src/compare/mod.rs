//! `compare`: every method on one mesh, as a table, files, and a page with pictures.
//!
//! [`contest`] makes and measures the levels, [`output`] keeps them; [`page`] and [`summary`] tell
//! of it, from the same figures.

mod contest;
mod output;
mod page;
mod section;
mod summary;

use std::path::PathBuf;

use clap::Args;
use meshlod::Method;
use meshlod::io::write_file;
use meshlod::picture::View;

use crate::amounts::{self, Size};
use crate::answer::Answer;
use crate::args::{Reading, Sampling, Viewpoint};
use crate::failure::Failure;
use crate::files;
use crate::page::look::{self, Coat, Look};
use crate::page::subject::Subject;
use crate::session::Session;
use contest::Contest;
use output::Output;

#[derive(Args)]
pub struct Compare {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    #[command(flatten)]
    sizes: Sizes,
    /// Folder to write to; created if missing
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Methods to compare [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = amounts::method)]
    methods: Vec<Method>,
    /// Draw no pictures: the page has figures only
    #[arg(long)]
    no_pictures: bool,
    #[command(flatten)]
    viewpoint: Viewpoint,
    #[command(flatten)]
    sampling: Sampling,
    #[command(flatten)]
    reading: Reading,
}

/// How far to go.
#[derive(Args)]
#[group(required = true, multiple = false)]
struct Sizes {
    /// Target ratios of the faces: 10%,1%
    #[arg(long, value_name = "RATIOS", value_delimiter = ',', value_parser = amounts::ratio,
        allow_hyphen_values = true)]
    ratio: Vec<f64>,
    /// Target numbers of faces: 5000,500
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', value_parser = amounts::whole,
        allow_negative_numbers = true)]
    faces: Vec<usize>,
}

impl Sizes {
    /// Each once, the finest first, as one run meets them.
    fn sorted(&self) -> Vec<Size> {
        let mut ratios = self.ratio.clone();
        ratios.sort_by(|a, b| b.total_cmp(a));
        ratios.dedup();
        let mut faces = self.faces.clone();
        faces.sort_unstable_by(|a, b| b.cmp(a));
        faces.dedup();
        ratios.into_iter().map(Size::Ratio).chain(faces.into_iter().map(Size::Faces)).collect()
    }
}

impl Compare {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_folder(&self.out)?;
        let (subject, output) = self.read(session)?;
        let original = subject.surface()?;
        files::make_folder(&self.out)?;
        let contest = Contest {
            subject: &subject,
            original: &original,
            options: self.sampling.options(),
            sizes: self.sizes.sorted(),
            methods: self.methods(),
            pictures: !self.no_pictures,
        };
        let outcome = contest.run(&output, session)?;

        session.progress.stage("writing the page");
        let json = summary::json(&contest, &outcome, &output);
        write_file(&self.out.join("compare.json"), format!("{json:#}\n").as_bytes())?;
        let page = page::page(&contest, &outcome).into_string();
        write_file(&self.out.join("index.html"), page.as_bytes())?;
        outcome.warn(&subject.name, session);
        Ok(Answer::new(json, summary::text(&contest, &outcome, &output)))
    }

    fn read(&self, session: &Session) -> Result<(Subject, Output), Failure> {
        let scene = files::read(&self.input, &self.reading, session)?;
        let output = Output::new(&self.out, &self.input, &scene, session);
        let materials = look::materials(&scene, &self.input, session);
        let View { direction, up, .. } = self.viewpoint.view();
        let name = files::name(&self.input);
        let title = self.input.file_name().unwrap_or_default().to_string_lossy();
        let look = |mesh: &_| Look::new(Coat::comparison(mesh, materials), mesh, direction, up);
        Ok((Subject::new([&name, &title], scene, look), output))
    }

    /// Each once, in the order of the house.
    fn methods(&self) -> Vec<Method> {
        let wanted = |method: &Method| self.methods.is_empty() || self.methods.contains(method);
        Method::ALL.into_iter().filter(wanted).collect()
    }
}
