//! Jobs: what every program asks for, each written once.
//!
//! A job takes what it works on, a request and a [`Watch`], and returns an output and a report:
//! `simplify(scene, &request, &watch) -> Result<(Scene, SimplifyReport), JobError>`. A request is
//! plain data, which the feature `serde` reads and writes; a report is what the command prints with
//! `--json`. The command, the Python package and the viewer only translate: arguments into
//! requests, reports into text.
//!
//! A job reads no file and writes none, but for `tiles`, whose model and plan are files.
//! [`AnyFile`](crate::AnyFile) opens what it works on, [`Output`](crate::Output) says where the
//! result goes and in which format.

#[cfg(feature = "multires")]
mod build;
#[cfg(feature = "check")]
mod check;
#[cfg(feature = "codec")]
mod compress;
mod convert;
#[cfg(feature = "check")]
mod copies;
mod error;
#[cfg(feature = "multires")]
mod extract;
#[cfg(feature = "check")]
mod faceless;
#[cfg(feature = "serde")]
pub mod figures;
#[cfg(feature = "picture")]
mod image_sizes;
#[cfg(feature = "check")]
mod lods;
#[cfg(feature = "multires")]
mod measure;
#[cfg(feature = "check")]
mod repair;
#[cfg(feature = "check")]
mod running;
#[cfg(feature = "check")]
mod scene_run;
#[cfg(feature = "check")]
mod simplify;
#[cfg(feature = "strip")]
mod strip;
#[cfg(feature = "check")]
mod switching;
#[cfg(feature = "tiles")]
mod tiles;
#[cfg(feature = "multires")]
mod unused;
mod watch;
#[cfg(feature = "check")]
mod written_as;

#[cfg(feature = "multires")]
pub use build::{
    BuildReport, BuildRequest, BuiltLevels, ErrorPoses, LevelModel, LevelOrder, build,
};
#[cfg(feature = "check")]
pub use check::{
    CONTACT_KINDS, CheckReport, CheckRequest, Contacts, Grade, Group, ListedFinding, ObjectPair,
    Ownership, check, check_each, check_scene, is_touch,
};
#[cfg(feature = "codec")]
pub use compress::{
    CompressReport, CompressRequest, CompressTarget, GltfPacking, Packing, PieceCount,
    PositionScheme, StripCounts, compress,
};
pub use convert::{ConvertReport, ConvertRequest, convert};
pub use error::JobError;
#[cfg(feature = "multires")]
pub use extract::{
    AskedError, ErrorLimit, ExtractReport, ExtractRequest, FocusRequest, KeptError, KnownError,
    PosedError, QueryRequest, QueryTarget, extract,
};
#[cfg(feature = "check")]
pub use faceless::refuse_points;
#[cfg(feature = "picture")]
pub use image_sizes::image_sizes;
#[cfg(feature = "check")]
pub use lods::{LodChain, LodReport, LodsReport, LodsRequest, chain_samples, lods};
#[cfg(feature = "multires")]
pub use measure::{FarthestPose, MeasureReport, MeasureRequest, measure};
#[cfg(feature = "check")]
pub use repair::{RepairRequest, SceneRepair, repair};
#[cfg(feature = "multires")]
pub(crate) use running::end_if_cancelled;
#[cfg(feature = "check")]
pub(crate) use running::{Contractions, begin, cancellable};
#[cfg(feature = "check")]
pub use simplify::{Aim, LostVolume, ProvedError, SimplifyReport, SimplifyRequest, simplify};
#[cfg(feature = "strip")]
pub use strip::{
    FollowReport, FollowRequest, FollowedCut, StripFilter, StripReport, StripRequest, Stripped,
    StrippedLevelReport, follow_strips, strip,
};
#[cfg(feature = "check")]
pub use switching::{Switch, SwitchCamera};
#[cfg(feature = "tiles")]
pub use tiles::{
    Globe, PlanFolder, TileFileError, TileFiles, TileInput, TileLevel, TileModel, TilePlan,
    TileRun, TilesReport, TilesRequest, TilesetReport, Up, assemble_tiles, check_tiles_folder,
    check_tileset, finish_tiles, plan_tiles, remove_tile_plan, run_tile_task, tile_plan_folder,
    tiles,
};
pub use watch::{About, Remark, Watch};
#[cfg(feature = "check")]
pub use written_as::WrittenAs;
