//! The form in which a result will be written, for which a job's promises hold.

use meshlod_io::{Format, Precision, Scene};
use meshlod_simplify::Digits;

use crate::scene::digits_of;

/// Format and precision in which a scene is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct WrittenAs {
    /// Format of the file.
    pub format: Format,
    /// Precision of coordinates. With [`Precision::Auto`] a job chooses 64 bits where 32 would take
    /// part of an error that is asked for, and its report says which to write.
    pub precision: Precision,
}

impl WrittenAs {
    /// Chooses the bits that a scene needs, unless they are chosen already.
    pub(super) fn of(self, scene: &Scene) -> Self {
        let precision = self.precision.of(scene.meshes.iter().map(|mesh| &mesh.mesh));
        Self { precision, ..self }
    }

    /// Chooses 64 bits, unless they are chosen already.
    pub(super) fn precise(self) -> Self {
        match self.precision {
            Precision::Auto => Self { precision: Precision::F64, ..self },
            _ => self,
        }
    }
}

/// Returns the digits of coordinates that are written, or stay in memory.
pub(super) fn digits(written_as: Option<WrittenAs>) -> Digits {
    written_as.map_or(Digits::F64, |as_| digits_of(as_.format, as_.precision))
}
