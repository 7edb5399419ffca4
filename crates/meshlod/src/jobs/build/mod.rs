//! `build`: all levels of a scene as the bytes of one file.

mod contractions;
mod right_triangles;
#[cfg(test)]
mod tests;

use meshlod_io::{Note, Scene};
use meshlod_mesh::{AttributeBounds, Mesh};
use meshlod_multires::{Certificate, ErrorKind, Fit};
use meshlod_simplify::{Held, Method};

use crate::jobs::faceless::refuse_points;
use crate::jobs::{JobError, Watch, cancellable};
use crate::model::{PoseCounts, SceneCounts};
use crate::{Bound, Constraints, VertexLocking};

/// Request to [`build`] all levels of a scene.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct BuildRequest {
    /// Simplification method whose contractions define the levels.
    pub method: Method,
    /// Kind of model, by which the levels are made.
    pub model: LevelModel,
    /// Order of the contractions. Right triangles are always in the order of their errors.
    pub order: LevelOrder,
    /// Whether the stored errors are estimates, measured, or proven bounds. With measured
    /// errors building takes about twice as long as with estimates. The errors of right triangles are
    /// bounds in any case.
    pub errors: ErrorKind,
    /// Largest displacement of a vertex by rounding, unless the file is lossless; by a cell or two
    /// more where a triangle would lose its area. 0 keeps the heights of right triangles.
    pub rounding: Bound,
    /// True to keep the vertices of the mesh bit for bit, so that the finest level equals the mesh.
    pub lossless: bool,
    /// True to keep the volume of closed parts exactly in the finest level, as `lossless` does, and
    /// to remark where nothing is closed.
    pub exact_volume: bool,
    /// Approximate number of vertices in a chunk, the unit of reading.
    pub in_chunk: usize,
    /// Largest errors of attributes, unless the file is lossless. That of texture coordinates holds
    /// for textures that a material repeats, too.
    pub attributes: AttributeBounds,
    /// Constraints that every level satisfies. The topology is kept whatever they say, so that no
    /// component vanishes, and tied vertices are locked.
    pub constraints: Constraints,
}

/// Kind of a model of all levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum LevelModel {
    /// Contractions of any mesh.
    #[default]
    Contractions,
    /// Hierarchy of right triangles, for a height field on a regular grid.
    RightTriangles,
}

/// Order of the contractions of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum LevelOrder {
    /// Their cost, as in [`simplify`](crate::jobs::simplify) to a number of faces.
    #[default]
    Cost,
    /// The error that they need, in steps of a factor of 1.3 from .01 to 2 % of the diagonal, then
    /// their cost. Levels within an error have a fifth to a third fewer faces; building takes about
    /// ten times as long. Methods other than `lindstrom-turk` and `qem` go by their estimates.
    Error,
}

/// File that [`build`] made, in figures.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BuildReport {
    /// Number of vertices of the merged mesh that faces use.
    pub input_vertices: usize,
    /// Number of faces of the merged mesh.
    pub input_faces: usize,
    /// Size of the file in bytes.
    pub bytes: usize,
    /// Bytes of images, nodes and materials among them.
    pub scene_bytes: usize,
    /// Bytes without those of the scene, per vertex.
    pub bytes_per_vertex: f64,
    /// Largest displacement of a vertex of the finest level by rounding, in model units.
    pub rounding: f64,
    /// Figures of the levels.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub levels: BuiltLevels,
    /// Numbers of what the scene has, if it is more than a mesh.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub scene: Option<SceneCounts>,
    /// Number of faces of the finest level, which leaves out degenerate and duplicate faces.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub faces: usize,
    /// Largest displacement of a vertex of any level by rounding, in model units.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub moved: f64,
    /// Diagonal of the finest level, in model units.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub diagonal: f64,
    /// Poses for which errors hold, beside that of the file.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub error_poses: ErrorPoses,
    /// Notes on what the file lacks of the scene.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub notes: Vec<Note>,
}

/// Levels of a file in figures, by the kind of their model.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(untagged))]
pub enum BuiltLevels {
    /// Contractions of any mesh.
    Contractions {
        /// Numbers of vertices that were held.
        held: Held,
        /// Kind of the stored errors.
        error_kind: ErrorKind,
        /// Poses in which they were measured, beside that of the file.
        poses: Option<PoseCounts>,
        /// [`LevelModel::Contractions`].
        model: LevelModel,
        /// Method of the contractions.
        method: Method,
        /// Their order.
        order: LevelOrder,
        /// True if the finest level equals the mesh.
        lossless: bool,
        /// Number of refinement steps between the coarsest level and the finest.
        updates: usize,
        /// Number of faces of the coarsest level.
        base_faces: usize,
        /// Proof that no level has a crack.
        certificate: Certificate,
    },
    /// Right triangles of a height field.
    RightTriangles {
        /// [`LevelModel::RightTriangles`].
        model: LevelModel,
        /// [`ErrorKind::Bound`].
        error_kind: ErrorKind,
        /// Numbers of columns and rows of heights.
        grid: [u32; 2],
        /// Distance of the finest level from the mesh.
        fit: Fit,
    },
}

/// Poses other than that of the file for which errors hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorPoses {
    /// None.
    #[default]
    Unknown,
    /// All, since animations move meshes as they are.
    Unbent,
    /// Those in which they were measured.
    Measured(PoseCounts),
}

impl Default for BuildRequest {
    fn default() -> Self {
        Self {
            method: Method::LindstromTurk,
            model: LevelModel::default(),
            order: LevelOrder::default(),
            errors: ErrorKind::Measured,
            rounding: Bound::OfDiagonal(0.005 / 100.0),
            lossless: false,
            exact_volume: false,
            in_chunk: 4096,
            attributes: AttributeBounds::default(),
            constraints: Constraints::default(),
        }
    }
}

impl BuildRequest {
    /// Refuses what does not go with right triangles, before a scene is read.
    ///
    /// # Errors
    /// [`JobError::Request`].
    pub fn validate(&self) -> Result<(), JobError> {
        if self.model == LevelModel::Contractions {
            return Ok(());
        }
        let refused = |field, reason: &str| {
            Err(JobError::request(field, format_args!("does not go with right-triangles{reason}")))
        };
        let own = ": the errors of their levels put them in order already";
        let moves = ": their levels consist of vertices of the grid, which never move";
        let Constraints { fuse, lock_boundary, locks, .. } = &self.constraints;
        match () {
            () if self.order != LevelOrder::default() => refused("order", own),
            () if *fuse => refused("fuse", moves),
            () if *lock_boundary => refused("lock_boundary", moves),
            () if *locks != VertexLocking::None => refused("locks", moves),
            () if self.exact_volume => {
                refused("exact_volume", ": a height field encloses no volume")
            }
            () if self.lossless => refused(
                "lossless",
                ", which move vertices to a grid; a rounding of 0 keeps the heights",
            ),
            () => Ok(()),
        }
    }

    /// Returns the largest displacement of a vertex of a mesh, in model units.
    fn rounding_of(&self, mesh: &Mesh) -> f64 {
        self.rounding.length(mesh.bounds().diagonal())
    }
}

/// Builds all levels of a scene, as the bytes of a `.mlod` file, and proves that none has a crack.
///
/// Each mesh of the scene is in the levels once, as its largest instance; nodes, materials, images,
/// skins and animations lie between the chunks of the file. Of a height field only the surface is
/// kept. Measured errors hold in the pose of the file, and in up to 64 poses of its animations.
///
/// Cost: O(n log n), n = faces, and several times that for [`ErrorKind::Bound`].
/// # Errors
/// A scene that cannot be simplified, locks that do not match it, and a rounding that is negative or
/// larger than the scene.
///
/// ```
/// use meshlod::jobs::{BuildRequest, build};
/// use meshlod::{Scene, samples};
///
/// let torus = Scene::from_mesh("torus", samples::torus(3_000));
/// let faces = torus.meshes[0].mesh.faces.len();
/// let (bytes, report) = build(torus, &BuildRequest::default(), &())?;
/// assert_eq!((report.faces, report.bytes), (faces, bytes.len()));
/// # Ok::<(), meshlod::jobs::JobError>(())
/// ```
pub fn build(
    mut scene: Scene,
    request: &BuildRequest,
    watch: &dyn Watch,
) -> Result<(Vec<u8>, BuildReport), JobError> {
    request.validate()?;
    refuse_points(&scene)?;
    cancellable(|| {
        if request.constraints.fuse {
            watch.stage("fusing");
            request.constraints.fuse(&mut scene);
        }
        if matches!(request.constraints.locks, VertexLocking::Contacts(_)) {
            watch.stage("looking for contacts");
        }
        match request.model {
            LevelModel::Contractions => contractions::build(scene, request, watch),
            LevelModel::RightTriangles => right_triangles::build(scene, request),
        }
    })
}
