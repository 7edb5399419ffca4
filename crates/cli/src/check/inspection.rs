//! A mesh with the report of its check, and marks for pictures of it.

use meshlod::Mesh;
use meshlod::jobs::{CheckReport, CheckRequest, JobError, Watch, check_each};

use crate::check::marks::Marks;

/// A mesh with the report of its check.
pub struct Inspection {
    pub mesh: Mesh,
    pub report: CheckReport,
    /// Marks on the faces and edges of the mesh, if pictures are to show them.
    pub marks: Option<Marks>,
}

impl Inspection {
    /// Checks a mesh; `is_drawn` asks for marks.
    pub fn of(
        mesh: Mesh,
        request: &CheckRequest,
        is_drawn: bool,
        watch: &dyn Watch,
    ) -> Result<Self, JobError> {
        let mut marks = is_drawn.then(|| Marks::new(&mesh));
        let report = check_each(&mesh, request, watch, &mut |owners, finding| {
            if let Some(marks) = &mut marks {
                marks.add(&mesh, &owners.objects, finding);
            }
        })?;
        Ok(Self { mesh, report, marks })
    }
}
