//! Settings that the viewer remembers from one run to the next.

use serde::{Deserialize, Serialize};

use crate::stage::Display;

/// Settings that are remembered.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Settings {
    pub display: Display,
    /// Show the side panel.
    pub has_panel: bool,
    /// The z axis points up.
    pub is_z_up: bool,
    /// Field of view along the shorter side, in degrees.
    pub fov_deg: f64,
}

const KEY: &str = "settings";

impl Default for Settings {
    fn default() -> Self {
        Self { display: Display::default(), has_panel: true, is_z_up: false, fov_deg: 45.0 }
    }
}

impl Settings {
    /// Reads the settings; missing or invalid ones are the default.
    pub fn read(storage: Option<&dyn eframe::Storage>) -> Self {
        storage.and_then(|storage| eframe::get_value(storage, KEY)).unwrap_or_default()
    }

    pub fn write(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, KEY, self);
    }
}
