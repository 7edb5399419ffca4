//! Output of verbs: numbers, tables and the lines of reports, as text and as JSON.

pub mod distance;
pub mod error_bound;
pub mod kept_error;
pub mod model_scene;
pub mod simplify_report;
pub mod stuck;
pub mod table;

pub use meshlod::numbers;
