//! Request for tiles.

use meshlod_tiles::plan::TileOptions;

use crate::jobs::JobError;
use crate::jobs::tiles::placement::{Globe, Up};

/// Least number of faces of a tile that can be asked for.
const LEAST_FACES: usize = 100;

/// Greatest number.
const MOST_FACES: usize = 1 << 32;

/// Bytes of memory a face that a tile in the making takes, with those that it is made of.
const BYTES_OF_FACE: usize = 4 * 1200;

/// Request of [`tiles`](crate::jobs::tiles()).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct TilesRequest {
    /// Number of faces from which a part of the model is divided.
    pub tile_faces: usize,
    /// True for contents without compression by meshopt.
    pub plain: bool,
    /// True for tiles with skirts, which hide gaps between levels.
    pub skirts: bool,
    /// Axis that points up.
    pub up: Up,
    /// Place of the model's origin on the globe, if any.
    pub globe: Option<Globe>,
    /// True for a model whose coordinates are about the middle of the earth, in metres, with x
    /// towards 0° N 0° E and z towards the north pole; not together with `globe`. `up` then has no
    /// effect.
    pub ecef: bool,
    /// Limit on the memory of all threads together, in bytes; `None` for none. It decides how many
    /// work at a time.
    pub memory: Option<usize>,
}

impl Default for TilesRequest {
    fn default() -> Self {
        Self {
            tile_faces: 50_000,
            plain: false,
            skirts: true,
            up: Up::Y,
            globe: None,
            ecef: false,
            memory: None,
        }
    }
}

impl TilesRequest {
    /// Returns what the tiles are made to be.
    pub(super) fn options(&self) -> Result<TileOptions, JobError> {
        if self.tile_faces < LEAST_FACES {
            let reason = format!("must be at least {LEAST_FACES}, not {}", self.tile_faces);
            return Err(JobError::request("tile_faces", reason));
        }
        if self.tile_faces > MOST_FACES {
            let reason = format!("must be at most {MOST_FACES}, not {}", self.tile_faces);
            return Err(JobError::request("tile_faces", reason));
        }
        if let Some(globe) = self.globe {
            let Globe { latitude, longitude, altitude } = globe;
            let is_sound =
                latitude.abs() <= 90.0 && longitude.abs() <= 360.0 && altitude.is_finite();
            if !is_sound {
                let reason = "must be a latitude within 90 degrees, a longitude and a height";
                return Err(JobError::request("globe", reason));
            }
        }
        if self.ecef && self.globe.is_some() {
            let reason = "coordinates about the middle of the earth have a place on the globe";
            return Err(JobError::request("ecef", reason));
        }
        let identity = glam::DMat4::IDENTITY.to_cols_array_2d();
        Ok(TileOptions {
            most_faces: self.tile_faces,
            meshopt: !self.plain,
            skirts: self.skirts,
            placement: self.globe.map_or(identity, Globe::frame),
            // Their axes are those of the tileset as they are.
            is_z_up: self.ecef || self.up == Up::Z,
        })
    }

    /// Returns the number of threads that the memory is enough for, at least one.
    pub(super) fn threads(&self, most: usize) -> usize {
        let each = BYTES_OF_FACE * self.tile_faces;
        self.memory.map_or(most, |memory| (memory / each).clamp(1, most))
    }
}
