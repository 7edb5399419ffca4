//! Version of the format and the range of its values.

/// Version of the format, in `scene.json`, `cameras.json` and `levels.json`.
pub const VERSION: u32 = 1;

/// Greatest coordinate that a recording may hold, in body lengths.
pub(super) const FARTHEST: f32 = 1e7;
