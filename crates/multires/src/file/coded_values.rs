//! Coded values of wedges, kept until the model that predicts them is assembled.

use super::layer_coding::LayerCoding;
use super::wedge_values;
use crate::implicit::Implicit;
use crate::wedges::{WedgeNumbers, WedgeValues, Wedges};

/// Rows of a file, one for each wedge, in the order of the file.
pub(super) struct CodedValues {
    pub(super) coding: Vec<LayerCoding>,
    pub(super) columns: usize,
    pub(super) rows: Vec<i32>,
}

impl CodedValues {
    /// Decodes the values of a model's wedges, which are these in the file. `has_all` tells whether no
    /// chunk before the last is missing.
    pub(super) fn restored(
        &self,
        (mt, all): (&Implicit, &Wedges),
        wedges: impl Iterator<Item = u32>,
        has_all: bool,
    ) -> Result<WedgeValues, &'static str> {
        let rows = select_rows(&self.rows, self.columns, wedges);
        let mut numbers = wedge_values::restored(mt, all, &self.coding, rows);
        for row in numbers.chunks_exact_mut(self.columns.max(1)) {
            let mut start = 0;
            for coding in &self.coding {
                let numbers = &mut row[start..start + coding.columns()];
                start += numbers.len();
                if !coding.are_finite(numbers) {
                    if has_all {
                        return Err("an attribute is not finite");
                    }
                    // It belongs to an update that lacks what it depends on, and is never shown.
                    numbers.fill(0);
                }
            }
        }
        let count = all.first(mt.node_count() as u32);
        Ok(WedgeNumbers { coding: self.coding.clone(), numbers }.packed(0..count))
    }
}

/// Returns the rows of the listed wedges.
pub(super) fn select_rows(
    rows: &[i32],
    columns: usize,
    wedges: impl Iterator<Item = u32>,
) -> Vec<i32> {
    wedges.flat_map(|wedge| &rows[wedge as usize * columns..][..columns]).copied().collect()
}
