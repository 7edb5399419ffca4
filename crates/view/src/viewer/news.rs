//! News: the results of jobs, taken in.

use std::sync::Arc;
use std::time::Duration;

use super::document::{Document, DocumentId, DocumentLevel, ShownSide};
use super::jobs::JobKind;
use super::load;
use super::state::ViewerState;
use super::work::{Comparison, MadeLevel, News, NormalsState};
use crate::stage::{Loaded, Subject};
use crate::{Transition, view_camera};

/// Time in which vertices move to their new positions.
const MOTION: Duration = Duration::from_millis(250);

impl ViewerState {
    /// Takes the news of jobs since the last frame.
    pub fn take_news(&mut self) {
        while let Some((_, outcome)) = self.jobs.poll() {
            match outcome {
                Ok(Some(news)) => self.take(news),
                Ok(None) => {}
                Err(problem) => self.complain(problem),
            }
        }
    }

    fn take(&mut self, news: News) {
        match news {
            News::Opened(loaded, subject, state) => self.opened(loaded, subject, state),
            News::Simplified(id, level) => self.simplified(id, *level),
            News::Compared(id, comparison) => self.compared(id, *comparison),
            News::Checked(id, checked) => {
                let (report, places) = *checked;
                if let Some(document) = self.by_id(id) {
                    document.findings.unfolded =
                        report.summary.found().map(|(kind, _)| kind).next();
                    document.findings.report = Some(report);
                    document.findings.places = places;
                    document.findings.selected = None;
                }
            }
            News::Colored(id, subject) => {
                if self.stage.subject(id).is_some() {
                    self.stage.replace(id, subject);
                    self.changes += 1;
                }
            }
            News::Saved(path) => self.notify(format!("Saved {}", path.display())),
        }
    }

    fn opened(&mut self, loaded: Arc<Loaded>, subject: Subject, state: NormalsState) {
        self.load_ms = Some(loaded.time.as_secs_f64() * 1e3);
        for warning in &loaded.warnings {
            self.complain(format!("{}: {warning}", loaded.name()));
        }
        let (id, original) = (self.next_document_id(), self.stage.add(subject));
        let document = Document::new(id, Arc::clone(&loaded), original);
        self.documents.push(document);
        // The files of the command line arrive in any order: the first one named stays in front.
        let first = self.options.files.first();
        let is_first = first.is_some_and(|first| *first == loaded.path);
        let is_dropped = !self.options.files.contains(&loaded.path);
        if self.documents.len() == 1 || is_first || is_dropped {
            self.active = self.documents.len() - 1;
            self.show_document();
            self.stage.rig.frame(&loaded.bounds, self.stage.aspect(self.size));
        }
        self.note_open_files();
        if state == NormalsState::Rough {
            self.rough.push((original, loaded));
        }
    }

    /// Starts to refine the normals of subjects that are on the screen by now.
    pub fn refine_normals(&mut self) {
        for (id, loaded) in std::mem::take(&mut self.rough) {
            let renderer = self.renderer();
            self.jobs.start(JobKind::Refine, "Finding creases", move |watch| {
                load::refine(id, &loaded, &renderer, watch)
            });
        }
    }

    fn simplified(&mut self, id: DocumentId, made: MadeLevel) {
        let subject = self.stage.add(made.subject);
        let Some(document) = self.by_id(id) else { return self.stage.remove(subject) };
        let level = DocumentLevel {
            loaded: made.loaded,
            subject,
            method: made.report.method,
            seconds: made.seconds,
            error_estimate: made.report.error_estimate,
            reached: made.report.reached,
            distance: None,
        };
        let old = document.level.replace(level);
        if document.mode == ShownSide::Original {
            document.mode = ShownSide::Both;
        }
        if let Some(old) = old {
            self.stage.remove(old.subject);
        }
        let aspect = self.stage.aspect(self.size);
        self.show_document();
        if self.stage.aspect(self.size) != aspect {
            self.frame_all();
        }
    }

    fn compared(&mut self, id: DocumentId, comparison: Comparison) {
        let level_id = comparison.level;
        let document = self.by_id(id);
        let level = document.and_then(|document| document.level.as_mut());
        // Another level may have been made meanwhile.
        let Some(level) = level.filter(|level| level.subject == level_id) else { return };
        level.distance = Some(comparison.distance);
        for (id, subject) in comparison.subjects {
            self.stage.replace(id, subject);
        }
        self.changes += 1;
    }

    /// Sends the current query to the cut of the active document, and applies its changes.
    pub fn follow_cuts(&mut self, seconds: f32) {
        let (camera, target) = (self.stage.rig.camera(), self.stage.rig.pose().target);
        let size = self.stage.slot_size(self.size).map(|side| side.max(1));
        let Some(document) = self.documents.get_mut(self.active) else { return };
        let diagonal = document.loaded.bounds.diagonal();
        let (original, name) = (document.original, document.loaded.name());
        let Some(cut) = &mut document.cut else { return };
        let Some(Subject::Levels(levels)) = self.stage.subject_mut(original) else { return };
        if !cut.is_held && cut.frozen.is_none() {
            cut.center = target;
        }
        let wish = cut.wish(view_camera(&cut.frozen.unwrap_or(camera), size), diagonal);
        if cut.asked.is_none_or(|asked| !wish.is_like(&asked)) {
            cut.asked = Some(wish);
            levels.ask(wish.query());
        }
        levels.set_motion(cut.moves.then_some(MOTION));
        levels.transition =
            if cut.dissolves { Transition::Dithered } else { Transition::Immediate };
        let has_changed = levels.poll(seconds);
        if levels.is_changing() {
            self.jobs.waker().request_repaint();
        }
        match has_changed {
            Ok(true) => {
                self.changes += 1;
                self.jobs.waker().request_repaint();
            }
            Ok(false) => {}
            Err(error) => self.complain(format!("{name}: {error}")),
        }
    }

    fn by_id(&mut self, id: DocumentId) -> Option<&mut Document> {
        self.documents.iter_mut().find(|document| document.id == id)
    }
}
