//! Scalars of PLY faces without another use, and their conversion to face layers.

use std::collections::BTreeMap;

use meshlod_mesh::{FaceLayer, FaceLayerKind};

use super::scalar::Scalar;

/// Scalars of the rows read so far. The triangles of a polygon share a row until the end.
#[derive(Debug, Default)]
pub(super) struct FaceScalars {
    columns: Vec<FaceColumn>,
    /// First triangle of each row, and the one after its last. Elements without scalars have no
    /// rows here.
    rows: Vec<[u32; 2]>,
}

/// Values of one property of an element.
#[derive(Debug)]
struct FaceColumn {
    name: String,
    kind: Scalar,
    /// Row of the first value.
    first_row: usize,
    values: Vec<f64>,
}

/// Limit on values per value in the file: polygons repeat theirs for every triangle. On a sphere
/// with three or more faces at each vertex, polygons have less than six corners on average, or four
/// triangles; the factor of two leaves room for handles and borders.
const MOST_REPEATS: usize = 8;

/// Number of values that is always allowed, 8 MB.
const MOST_IN_SMALL_FILES: usize = 1 << 20;

impl FaceScalars {
    /// Adds a column of the element that is about to be read; returns its index.
    pub fn add_column(&mut self, name: &str, kind: Scalar) -> usize {
        let (name, first_row) = (name.to_owned(), self.rows.len());
        self.columns.push(FaceColumn { name, kind, first_row, values: Vec::new() });
        self.columns.len() - 1
    }

    pub fn push(&mut self, column: usize, value: f64) {
        self.columns[column].values.push(value);
    }

    /// Ends the row of the triangles from `first` to `end`, in an element with columns.
    pub fn end_row(&mut self, first: usize, end: usize) {
        // Meshes whose triangles have no such number are refused once all are counted.
        self.rows.push([first as u32, end as u32]);
    }

    /// Returns the type of each property; the first element with that property wins.
    pub fn types(&self) -> BTreeMap<&str, Scalar> {
        // An element of no rows declares properties, but has nothing to keep.
        let used = self.columns.iter().filter(|column| !column.values.is_empty());
        used.rev().map(|column| (&*column.name, column.kind)).collect()
    }

    /// Returns a layer for each name, with zeros for triangles of elements without it, or `None` if
    /// polygons of many corners would expand the values beyond a small multiple of the file.
    pub fn into_layers(self, triangles: usize) -> Option<Vec<FaceLayer>> {
        let mut layers: Vec<FaceLayer> = Vec::new();
        let mut layer_of: BTreeMap<String, usize> = BTreeMap::new();
        let count = self.types().len().saturating_mul(triangles);
        let stored: usize = self.columns.iter().map(|column| column.values.len()).sum();
        if count > MOST_IN_SMALL_FILES.max(stored.saturating_mul(MOST_REPEATS)) {
            return None;
        }
        let used = self.columns.into_iter().filter(|column| !column.values.is_empty());
        for FaceColumn { name, first_row, values, .. } in used {
            let at = *layer_of.entry(name).or_insert_with_key(|name| {
                let (kind, name) = (FaceLayerKind::Other, name.clone());
                layers.push(FaceLayer { kind, name, values: vec![0.0; triangles] });
                layers.len() - 1
            });
            for (&[first, end], value) in self.rows[first_row..].iter().zip(values) {
                layers[at].values[first as usize..end as usize].fill(value);
            }
        }
        Some(layers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_have_layers_in_common() {
        let mut scalars = FaceScalars::default();
        let [a, b] = ["a", "b"].map(|name| scalars.add_column(name, Scalar::U8));
        scalars.push(a, 1.0);
        scalars.push(b, 2.0);
        scalars.end_row(0, 2);
        // Triangle 2 is of an element without scalars.
        let b = scalars.add_column("b", Scalar::F64);
        scalars.push(b, 3.0);
        scalars.end_row(3, 4);
        assert_eq!(scalars.types()["b"], Scalar::U8);
        let layers = scalars.into_layers(4).unwrap();
        let found: Vec<_> = layers.iter().map(|layer| (&*layer.name, &*layer.values)).collect();
        assert_eq!(found, [("a", &[1.0, 1.0, 0.0, 0.0][..]), ("b", &[2.0, 2.0, 0.0, 3.0])]);
    }

    #[test]
    fn values_are_a_small_multiple_of_the_file() {
        let of_polygon = |triangles: usize, rows: usize| {
            let mut scalars = FaceScalars::default();
            let column = scalars.add_column("a", Scalar::U8);
            for row in 0..rows {
                scalars.push(column, 7.0);
                scalars.end_row(row * triangles, (row + 1) * triangles);
            }
            scalars.into_layers(rows * triangles).is_some()
        };
        assert!(of_polygon(MOST_IN_SMALL_FILES, 1));
        assert!(!of_polygon(MOST_IN_SMALL_FILES + 1, 1));
        let rows = MOST_IN_SMALL_FILES / 8 + 1;
        assert!(of_polygon(8, rows) && !of_polygon(9, rows));
    }
}
