//! `demo`: the whole line on samples, as files and one page with pictures.
//!
//! [`subjects`] says what is shown, [`exhibit`] makes and measures it, [`studio`] draws it;
//! [`page`] and [`summary`] tell of it, from the same figures.

mod chain;
mod chart;
mod counts;
mod exhibit;
mod figures;
mod heat;
mod hero;
mod own;
mod page;
mod refine;
mod section;
mod studio;
mod subjects;
mod summary;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use meshlod::Method;
use meshlod::io::write_file;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::session::Session;
use exhibit::Exhibit;

#[derive(Args)]
pub struct Demo {
    /// Folder to write to; made where it is not there
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// All that a run made.
struct Show {
    exhibits: Vec<Exhibit>,
    /// The first subject at several levels, side by side.
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
        make_folder(&self.folder)?;
        let make = |subject| Exhibit::make(subject, &self.folder, session);
        let exhibits: Vec<Exhibit> = subjects::ALL.iter().map(make).collect::<Result<_, _>>()?;
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

fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder.exists() && !folder.is_dir() {
        return Err(Failure::at(folder, "is a file; name a folder to write to"));
    }
    fs::create_dir_all(folder).map_err(|error| Failure::at(folder, error))
}

/// The method whose levels are drawn: that of `simplify` where none is named.
fn main_method() -> Method {
    Method::default()
}
