//! Jobs that actions start.

use std::path::PathBuf;
use std::sync::Arc;

use meshlod::Target;

use super::document::{DocumentLevel, LevelGoal};
use super::jobs::JobKind;
use super::state::ViewerState;
use super::{load, work};
use crate::stage::{Coloring, Subject, SubjectId};

impl ViewerState {
    /// Opens a file in the background.
    pub fn open(&mut self, path: PathBuf) {
        let (renderer, reading) = (self.renderer(), self.options.reading);
        let label = format!("Opening {}", path.display());
        let work = move |watch: &_| load::open(&path, &reading, &renderer, watch);
        self.jobs.start(JobKind::Open, label, work);
    }

    /// Starts to simplify the active document, by its settings.
    pub fn simplify(&mut self) {
        self.jobs.cancel(JobKind::Simplify);
        self.jobs.cancel(JobKind::Compare);
        let pose = self.stage.rig.pose();
        let height = f64::from(self.size[0].min(self.size[1]).max(1));
        let pixel = 2.0 * pose.distance * (self.stage.rig.fov_rad() / 2.0).tan() / height;
        let Some(document) = self.document() else { return };
        let order = document.order;
        let target = match order.goal {
            LevelGoal::Faces => Target::Faces(order.faces),
            LevelGoal::Error => {
                Target::Error(order.error_percent / 100.0 * document.loaded.bounds.diagonal())
            }
            LevelGoal::Pixels => Target::Error(order.pixels * pixel),
        };
        let (id, loaded) = (document.id, Arc::clone(&document.loaded));
        let (renderer, method) = (self.renderer(), order.method);
        self.jobs.start(JobKind::Simplify, "Simplifying", move |watch| {
            work::simplify(id, &loaded, method, target, &renderer, watch)
        });
    }

    /// Starts to measure the distance between the active document and its level.
    pub fn compare(&mut self) {
        let Some(document) = self.document() else { return };
        let Some(DocumentLevel { loaded, subject, .. }) = &document.level else { return };
        let surface = |id: SubjectId, loaded: &Arc<_>| {
            let mesh = |subject: &Subject| subject.as_mesh().cloned();
            self.stage.subject(id).map(|subject| (id, Arc::clone(loaded), mesh(subject)))
        };
        let both = (surface(document.original, &document.loaded), surface(*subject, loaded));
        let ((Some(a), Some(b)), id) = (both, document.id) else { return };
        let renderer = self.renderer();
        self.jobs.start(JobKind::Compare, "Measuring the distance", move |watch| {
            work::compare(id, [a, b], &renderer, watch)
        });
    }

    /// Starts to check the active document.
    pub fn check(&mut self) {
        let Some(document) = self.document() else { return };
        let (id, loaded) = (document.id, Arc::clone(&document.loaded));
        self.jobs.start(JobKind::Check, "Checking", move |watch| work::check(id, &loaded, watch));
    }

    /// Starts a job for colours that the chosen colouring needs and a shown subject lacks.
    pub fn ensure_colors(&mut self) {
        let wanted = self.stage.display.coloring;
        if self.tried.first().is_some_and(|&(_, coloring)| coloring != wanted) {
            self.tried.clear();
        }
        // Each of these jobs gives back a whole subject: two at once would undo each other.
        let jobs = [JobKind::Compare, JobKind::Color, JobKind::Refine, JobKind::Simplify];
        if jobs.iter().any(|&kind| self.jobs.has(kind)) {
            return;
        }
        let Some(document) = self.document() else { return };
        if wanted == Coloring::Heat {
            let level = document.level.as_ref().filter(|level| level.distance.is_none());
            let Some(wish) = level.map(|level| (level.subject, wanted)) else { return };
            if !self.tried.contains(&wish) {
                self.tried.push(wish);
                self.compare();
            }
            return;
        }
        if !wanted.is_by_mesh_face() {
            return;
        }
        let level = document.level.as_ref().map(|level| (level.subject, Arc::clone(&level.loaded)));
        let own = [Some((document.original, Arc::clone(&document.loaded))), level];
        let shown: Vec<_> = self.stage.shown().collect();
        let lacking = own.into_iter().flatten().find_map(|(id, loaded)| {
            let subject = self.stage.subject(id).filter(|subject| !subject.has(wanted))?;
            let is_new = shown.contains(&id) && !self.tried.contains(&(id, wanted));
            let mesh = subject.as_mesh().filter(|_| is_new)?;
            Some((id, mesh.clone(), loaded))
        });
        let Some((id, mesh, loaded)) = lacking else { return };
        self.tried.push((id, wanted));
        let renderer = self.renderer();
        self.jobs.start(JobKind::Color, "Colouring", move |_| {
            work::color(id, mesh, &loaded, wanted, &renderer)
        });
    }

    /// Writes the picture to a file.
    pub fn save_picture(&mut self, path: PathBuf) {
        match self.pane.read() {
            Ok(Some(picture)) => {
                self.jobs.start(JobKind::Save, "Saving", move |_| work::save(&picture, path));
            }
            Ok(None) => {}
            Err(error) => self.complain(error.to_string()),
        }
    }
}
