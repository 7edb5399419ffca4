//! Place and axes of a tileset.

use glam::{DMat4, DVec3, DVec4};

/// Axis of a model that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Up {
    /// The y axis, as in glTF.
    #[default]
    Y,
    /// The z axis, as in most scans and maps.
    Z,
}

/// Place on the globe, by the ellipsoid of WGS 84.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Globe {
    /// Latitude, in degrees north.
    pub latitude: f64,
    /// Longitude, in degrees east.
    pub longitude: f64,
    /// Height above the ellipsoid, in metres.
    #[cfg_attr(feature = "serde", serde(default))]
    pub altitude: f64,
}

/// Half of the greatest diameter of the ellipsoid, in metres, and its flattening [WGS84].
const RADIUS: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;

impl Globe {
    /// Returns the matrix from a frame whose x points east, y north and z up, at this place, to
    /// coordinates about the middle of the earth, in metres; column-major.
    ///
    /// # References
    /// [WGS84]
    pub fn frame(self) -> [[f64; 4]; 4] {
        let (sin_lat, cos_lat) = self.latitude.to_radians().sin_cos();
        let (sin_lon, cos_lon) = self.longitude.to_radians().sin_cos();
        let squared = FLATTENING * (2.0 - FLATTENING);
        let across = RADIUS / (1.0 - squared * sin_lat * sin_lat).sqrt();
        let level = (across + self.altitude) * cos_lat;
        let height = (across * (1.0 - squared) + self.altitude) * sin_lat;
        let origin = DVec3::new(level * cos_lon, level * sin_lon, height);
        let east = DVec3::new(-sin_lon, cos_lon, 0.0);
        let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
        let axes = [east, up.cross(east), up].map(|axis| axis.extend(0.0));
        DMat4::from_cols(axes[0], axes[1], axes[2], DVec4::from((origin, 1.0))).to_cols_array_2d()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_stand_upright_on_the_ellipsoid() {
        let at = |latitude, longitude, altitude| Globe { latitude, longitude, altitude }.frame();
        let [east, north, up, place] = at(0.0, 0.0, 100.0);
        assert_eq!(place, [RADIUS + 100.0, 0.0, 0.0, 1.0]);
        assert_eq!(
            (east, north, up),
            ([0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0])
        );
        let pole = at(90.0, 0.0, 0.0)[3];
        assert!((pole[2] - 6_356_752.314_245).abs() < 1e-5 && pole[0].abs() < 1e-5);
    }
}
