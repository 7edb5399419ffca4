//! A plan that is open, for those who do many of its tasks.

use std::path::Path;
use std::time::SystemTime;

use meshlod_tiles::TilesError;
use meshlod_tiles::folder::Folder;
use meshlod_tiles::plan::{Look, Plan};
use meshlod_tiles::task::run_task;

use crate::jobs::JobError;
use crate::jobs::tiles::fault::{failure, no_plan};
use crate::jobs::tiles::hold::Hold;
use crate::jobs::tiles::method::Proven;
use crate::jobs::tiles::result::TILES;

/// Plan of tiles, read once for many tasks, as is each image of its model by the first that needs it.
///
/// Tasks are numbered from 0 on, each after those that it needs; the last one is the root. Any number
/// of processes may do them, also the same at a time: the bytes are the same.
#[derive(Debug)]
pub struct TilePlan {
    pub(super) plan: Plan,
    pub(super) folder: Folder,
    /// Materials of the model.
    look: Look,
    /// Time and length of the file of the plan when it was read.
    stamp: Option<(SystemTime, u64)>,
}

impl TilePlan {
    /// Opens the plan in a folder.
    ///
    /// # Errors
    /// A folder without a plan, a damaged one, and errors of the system.
    pub fn open(folder: &Path) -> Result<Self, JobError> {
        let folder = Folder::new(folder);
        let stamp = folder.plan_stamp();
        let plan = folder.plan().map_err(failure)?.ok_or_else(|| no_plan(&folder))?;
        let look = folder.look(&plan);
        Ok(Self { plan, folder, look, stamp })
    }

    /// Takes back the contents that a call which was ended had moved to a tileset already.
    pub(super) fn take_back(&self, out: &Path) {
        if let Ok(root) = self.plan.cell(self.tasks() - 1) {
            self.folder.take_back(root, &out.join(TILES));
        }
    }

    /// Returns false if another plan has been made in the folder since this one was opened.
    pub fn is_current(&self) -> bool {
        self.stamp.is_some() && self.stamp == self.folder.plan_stamp()
    }

    /// Returns the number of faces from which a part of the model is divided.
    pub fn tile_faces(&self) -> usize {
        self.plan.options.most_faces
    }

    /// Returns the number of tasks.
    pub fn tasks(&self) -> usize {
        self.plan.tasks.len()
    }

    /// Returns the tasks that one needs done before; none for a leaf, and beyond the last one.
    pub fn parts(&self, task: usize) -> Vec<usize> {
        if task < self.tasks() { self.plan.parts(task) } else { Vec::new() }
    }

    /// Returns true for a task that is done, whose content is as it was written.
    ///
    /// # Errors
    /// A file that is there and cannot be read.
    pub fn is_done(&self, task: usize) -> Result<bool, JobError> {
        self.stands(task, false)
    }

    /// Returns true if the files of a tile are as they were written; its mesh need be there only for
    /// a part, which another one is still to be made from.
    pub(super) fn stands(&self, task: usize, is_part: bool) -> Result<bool, JobError> {
        let found = match is_part {
            true => self.folder.done(&self.plan, task),
            false => self.folder.shown(&self.plan, task),
        };
        Ok(found.map_err(failure)?.is_some())
    }

    /// Does a task, unless it is done. Parts whose files were lost or damaged are made anew.
    ///
    /// # Errors
    /// A task that there is not or that needs another one first, files of the plan that are not as
    /// they were written, errors of the system, and a plan that is being made or finished, or was
    /// made anew.
    pub fn run(&self, task: usize) -> Result<(), JobError> {
        let _hold = Hold::shared(&self.folder)?;
        if !self.is_current() {
            let path = self.folder.path().display();
            let reason = format!("{path}: the plan has been replaced since it was opened");
            return Err(JobError::request("", reason));
        }
        self.run_in_hold(task)
    }

    /// Does a task for one who has the right to.
    pub(super) fn run_in_hold(&self, task: usize) -> Result<(), JobError> {
        self.make(task).map_err(failure)
    }

    fn make(&self, task: usize) -> Result<(), TilesError> {
        let method = Proven::new(&self.plan);
        let mut made = None;
        loop {
            let done = run_task((&self.plan, &self.look), &self.folder, task, &method);
            let Err(TilesError::DamagedTile { task: needs, .. }) = done else {
                return done.map(drop);
            };
            if self.folder.shown(&self.plan, task)?.is_some() {
                // Somebody else did it meanwhile, and removed what it is made of.
                return Ok(());
            }
            if made == Some(needs) {
                return done.map(drop);
            }
            self.folder.forget_record(self.plan.cell(needs)?);
            self.make(needs)?;
            made = Some(needs);
        }
    }

    /// Removes what is left of the parts of a task that is done: only that task needed it.
    pub fn forget_parts(&self, task: usize) {
        if let Ok(_hold) = Hold::shared(&self.folder)
            && self.is_current()
        {
            self.forget_parts_in_hold(task);
        }
    }

    /// Removes what is left of the parts of a task, for one who has the right to.
    pub(super) fn forget_parts_in_hold(&self, task: usize) {
        let cells = self.parts(task).into_iter().filter_map(|part| self.plan.cell(part).ok());
        cells.for_each(|cell| self.folder.forget_mesh(cell));
    }
}
