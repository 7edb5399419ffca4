//! `check`: finds defects of a mesh and contacts between its objects.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use meshlod::Scene;
use meshlod::check::{
    BroadPhase, CheckOptions, ContactPolicy, Kind, Kinds, LockOptions, ObjectsBy,
};
use meshlod::io::write_file;
use meshlod::jobs::CheckRequest;
use meshlod::mesh::Lock;
use meshlod::scene::scene_locks;

use crate::check::inspection::Inspection;
use crate::check::lock_file::{self, FileRows};
use crate::check::sites::Sites;
use crate::check::{page, proof, report, text, tileset};
use crate::options::args::ReadArgs;
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::hearing::Hearing;
use crate::session::model_file;
use crate::session::several;
use meshlod::jobs::Grade;

/// Find defects of a mesh and contacts between its objects; exit with 3 on errors
#[derive(Args)]
pub struct Check {
    /// Meshes to read, or -; or .mlod files, and folders or archives of tiles, to prove them free of cracks
    #[arg(id = "input", value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
    /// Definition of an object
    ///
    /// With auto it is a named object if there are two or more, else a component.
    #[arg(long, value_name = "BY", default_value = "auto")]
    objects: By,
    /// Also exit with 3 on findings of this severity
    #[arg(long, value_name = "WHAT")]
    deny: Option<Deny>,
    /// Maximum number of findings listed of each kind and severity, and of pairs of objects
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = parse::whole,
        allow_negative_numbers = true)]
    limit: usize,
    /// How to find pairs of faces that may intersect; the findings are the same
    #[arg(long, alias = "net", value_name = "METHOD", default_value = "tree", hide = true)]
    broad_phase: PairSearch,
    /// Skip the search for faces that intersect, which --locks needs
    #[arg(long, conflicts_with = "locks")]
    no_intersections: bool,
    /// Write vertex locks for the places where components meet
    ///
    /// For simplify --locks and for other programs.
    #[arg(long, value_name = "FILE.json")]
    locks: Option<PathBuf>,
    /// Lock the boundary in that file too
    #[arg(long, requires = "locks")]
    lock_boundary: bool,
    /// Folder for a report page with pictures; created if missing
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadArgs,
}

#[derive(Clone, Copy, ValueEnum)]
enum By {
    Auto,
    Names,
    Components,
}

#[derive(Clone, Copy, ValueEnum)]
enum PairSearch {
    /// Bounding volume hierarchy: fast
    Tree,
    /// Octree: nine times slower
    #[value(alias = "cubes")]
    Octree,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Deny {
    Warnings,
}

impl Check {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if self.inputs.len() > 1 && (self.locks.is_some() || self.out.is_some()) {
            return Err(Failure::usage("--locks and --out are for one file at a time"));
        }
        several::answer(&self.inputs, session, |path| self.one(path, session))
    }

    fn one(&self, path: &Path, session: &Session) -> Result<Answer, Failure> {
        if model_file::is_model(path) {
            if self.locks.is_some() || self.out.is_some() {
                return Err(Failure::usage("--locks and --out need a mesh, not a .mlod file"));
            }
            return proof::prove(path, session);
        }
        if tileset::is_tileset(path) {
            if self.locks.is_some() || self.out.is_some() {
                return Err(Failure::usage("--locks and --out need a mesh, not a tileset"));
            }
            return tileset::check(path, session);
        }
        self.refuse_early(path)?;
        let scene = files::read(path, &self.reading, session)?;
        let mut written = Vec::new();
        if let Some(locks) = &self.locks {
            session.progress.stage("finding locks");
            written.push(self.write_locks(path, locks, &scene)?);
        }
        let sites = Sites::of(&scene);
        let request = CheckRequest { options: self.options(), limit: self.limit };
        let hearing = Hearing::new(session, path, path);
        let inspection = Inspection::of(scene, &request, self.out.is_some(), &hearing)
            .map_err(|error| hearing.failure(error))?;
        if let Some(folder) = &self.out {
            session.progress.stage("drawing the page");
            written.push(page::write(folder, &files::name(path), &inspection, &sites)?);
        }
        let mut json = report::json(&inspection, &sites);
        json["file"] = files::name(path).into();
        json["written"] = written.clone().into();
        let mut text = format!("{}: {}", files::name(path), text::text(&inspection, &sites));
        for file in written {
            text += &format!("{file}\n");
        }
        let denied =
            self.deny == Some(Deny::Warnings) && inspection.report.count(Grade::Warning) > 0;
        let outcome = Outcome::Found.when(inspection.report.count(Grade::Error) > 0 || denied);
        Ok(Answer { outcome, ..Answer::new(json, text) })
    }

    /// Refuses outputs that cannot be written, before any work is done.
    fn refuse_early(&self, input: &Path) -> Result<(), Failure> {
        if let Some(path) = &self.locks {
            if files::is_pipe(input) || files::is_pipe(path) {
                return Err(Failure::usage(
                    "--locks: neither file can be standard input or output",
                ));
            }
            files::check_place(path)?;
            let page = self.out.as_ref().map(|folder| folder.join("index.html"));
            let others = [Some(input), self.out.as_deref(), page.as_deref()];
            let others: Vec<&Path> = others.into_iter().flatten().collect();
            files::check_apart(path, &others)?;
        }
        self.out.as_deref().map_or(Ok(()), files::make_folder)
    }

    fn options(&self) -> CheckOptions {
        let kinds = match self.no_intersections {
            true => [Kind::SelfIntersection, Kind::Contact, Kind::Crowded]
                .into_iter()
                .fold(Kinds::ALL, Kinds::without),
            false => Kinds::ALL,
        };
        let objects = match self.objects {
            By::Auto => ObjectsBy::Auto,
            By::Names => ObjectsBy::Names,
            By::Components => ObjectsBy::Components,
        };
        let broad_phase = match self.broad_phase {
            PairSearch::Tree => BroadPhase::Tree,
            PairSearch::Octree => BroadPhase::Octree,
        };
        CheckOptions { kinds, objects, broad_phase }
    }

    fn write_locks(&self, input: &Path, path: &Path, scene: &Scene) -> Result<String, Failure> {
        let rows = FileRows::of(input, scene, self.reading.options().weld)?;
        let boundary = if self.lock_boundary { Lock::Locked } else { Lock::Free };
        let lockings =
            scene_locks(scene, &LockOptions { contacts: Some(ContactPolicy::Tie), boundary });
        let json = lock_file::to_json(input, scene, &rows, &lockings);
        write_file(path, format!("{json}\n").as_bytes())?;
        Ok(files::name(path))
    }
}
