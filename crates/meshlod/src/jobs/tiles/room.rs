//! Room on the disk, which is looked at before the work begins.

use std::path::Path;

use meshlod_tiles::TilesError;
use meshlod_tiles::plan::{Look, TileOptions};
use meshlod_tiles::source::Source;
use meshlod_tiles::space::{Space, free_space};
use meshlod_tiles::survey::Survey;

use crate::jobs::tiles::fault::failure;
use crate::jobs::{About, JobError, Remark, Watch};

/// Work that needs room on the disk.
#[derive(Clone, Copy, Debug)]
pub(super) enum Room {
    /// All tasks by the threads of a process, which remove what they do not need any more.
    OfRun { threads: usize },
    /// Tasks one by one, whose files stay until the end.
    OfSteps,
}

/// Model that was surveyed, and what its tiles are made to be.
type Surveyed<'a> = (&'a Survey, (&'a dyn Source, &'a Look), &'a TileOptions);

/// Fails if a disk has less room than tiles need for certain, and remarks on it where they may fit.
pub(super) fn check_room(
    folder: &Path,
    surveyed: Surveyed<'_>,
    room: Room,
    watch: &dyn Watch,
) -> Result<(), JobError> {
    match free_space(folder) {
        Some(free) => check(folder, free, surveyed, room, watch),
        None => Ok(()),
    }
}

fn check(
    folder: &Path,
    free: u64,
    (survey, model, options): Surveyed<'_>,
    room: Room,
    watch: &dyn Watch,
) -> Result<(), JobError> {
    if free >= Space::most(survey, model) {
        return Ok(());
    }
    let space = Space::estimate(survey, model, options).map_err(failure)?;
    let needs = match room {
        Room::OfRun { threads } => space.of_run(survey, threads, options.most_faces),
        Room::OfSteps => space.of_steps(),
    };
    let error = TilesError::NoSpace { path: folder.to_owned(), needs, free };
    // The estimate may be a fifth too large.
    if free < needs - needs / 5 {
        return Err(failure(error));
    }
    if free < needs
        && let Some((_, text)) = error.place()
    {
        watch.remark(&Remark::new(About::Output, text));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;
    use meshlod_tiles::source::SceneSource;
    use std::sync::Mutex;

    use super::*;
    use crate::Scene;
    use crate::jobs::TilesRequest;

    #[derive(Default)]
    struct Remarks(Mutex<Vec<String>>);

    impl Watch for Remarks {
        fn remark(&self, remark: &Remark) {
            self.0.lock().unwrap().push(remark.text.clone());
        }
    }

    #[test]
    fn a_disk_that_is_too_small_is_told_before_the_work() {
        let source = SceneSource::new(Scene::from_mesh("knot", samples::knot(20_000)));
        let look = Look::default();
        let options = TilesRequest::default().options().unwrap();
        let survey = Survey::of(&source, options.most_faces).unwrap();
        let needs = Space::estimate(&survey, (&source, &look), &options).unwrap().of_steps();
        assert!(Space::most(&survey, (&source, &look)) > needs);
        for (free, fails, remarks) in
            [(needs / 2, true, 0), (needs - needs / 10, false, 1), (needs, false, 0)]
        {
            let watch = Remarks::default();
            let surveyed = (&survey, (&source as &dyn Source, &look), &options);
            let checked = check(Path::new("disk"), free, surveyed, Room::OfSteps, &watch);
            assert_eq!(checked.is_err(), fails, "{free}");
            assert_eq!(watch.0.lock().unwrap().len(), remarks, "{free}");
            let text = checked.err().map(|error| error.to_string());
            assert!(text.is_none_or(|text| text.contains("need about")));
        }
    }
}
