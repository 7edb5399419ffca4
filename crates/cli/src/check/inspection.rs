//! The report of a check, and marks for pictures of what was checked.

use meshlod::jobs::{CheckReport, CheckRequest, JobError, Watch, check_each, check_scene};
use meshlod::{Mesh, Scene};

use crate::check::marks::Marks;

/// The report of a check, with what pictures are to show.
pub struct Inspection {
    pub report: CheckReport,
    /// The mesh with marks on its faces and edges, if it is to be drawn.
    pub drawn: Option<MarkedMesh>,
}

/// A mesh with marks on its faces and edges.
pub struct MarkedMesh {
    pub mesh: Mesh,
    pub marks: Marks,
}

impl Inspection {
    /// Checks a scene; `is_drawn` asks for marks.
    pub fn of(
        scene: Scene,
        request: &CheckRequest,
        is_drawn: bool,
        watch: &dyn Watch,
    ) -> Result<Self, JobError> {
        match is_drawn {
            true => Self::marked(scene.into_mesh(), request, watch),
            false => Ok(Self { report: check_scene(scene, request, watch)?, drawn: None }),
        }
    }

    /// Checks a mesh, and marks what is found.
    pub fn marked(mesh: Mesh, request: &CheckRequest, watch: &dyn Watch) -> Result<Self, JobError> {
        let mut marks = Marks::new(&mesh);
        let report = check_each(&mesh, request, watch, &mut |owners, finding| {
            marks.add(&mesh, &owners.objects, finding);
        })?;
        Ok(Self { report, drawn: Some(MarkedMesh { mesh, marks }) })
    }
}
