//! `demo`: the whole line on samples, as files and one page with pictures.
//!
//! [`samples`] says what is shown, [`exhibit`] makes and measures it; [`page`] and [`summary`] tell
//! of it, from the same figures.

mod exhibit;
mod hero;
mod own;
mod page;
mod samples;
mod section;
mod summary;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use meshlod::Method;
use meshlod::io::write_file;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::files;
use crate::session::Session;
use exhibit::Exhibit;

#[derive(Args)]
pub struct Demo {
    /// Folder to write to; created if missing
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// All that a run made.
struct Show {
    exhibits: Vec<Exhibit>,
    /// The first sample at several levels, side by side.
    hero: hero::Hero,
    page: PathBuf,
    page_bytes: usize,
    seconds: f64,
}

impl Show {
    fn folder(&self) -> &Path {
        self.page.parent().unwrap_or(Path::new(""))
    }
}

impl Demo {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let start = Instant::now();
        files::make_folder(&self.folder)?;
        let make = |sample| Exhibit::make(sample, &self.folder, session);
        let exhibits: Vec<Exhibit> = samples::ALL.iter().map(make).collect::<Result<_, _>>()?;
        session.progress.stage("drawing the picture and writing the page");
        let hero = hero::Hero::make(&exhibits[0], &self.folder)?;
        let page = self.folder.join("index.html");
        let html = page::page(&exhibits, &hero).into_string();
        write_file(&page, html.as_bytes())?;
        let seconds = start.elapsed().as_secs_f64();
        let show = Show { exhibits, hero, page, page_bytes: html.len(), seconds };
        Ok(Answer::new(summary::json(&show), summary::text(&show)))
    }
}

/// The method whose levels are drawn: that of `simplify` where none is named.
fn main_method() -> Method {
    Method::default()
}

/// Methods worth a look beside each other: edges by quadrics, edges by volume, faces. More would make
/// the page slow.
const METHODS: [Method; 3] = [Method::Qem, Method::LindstromTurk, Method::LeeJang];
