//! Smoothing groups of an OBJ file, each valid until the next `s`.

use meshlod_mesh::{FaceLayer, FaceLayerKind};

/// Smoothing groups by runs of consecutive faces.
#[derive(Default)]
pub(super) struct SmoothingRuns {
    /// First face and group of each run. Faces before the first run have group 0, for no group.
    runs: Vec<(usize, u32)>,
}

impl SmoothingRuns {
    /// Sets the group of all faces from `face` on; `off`, 0 and an empty name mean none.
    ///
    /// # Errors
    /// A group that is not a 32-bit number. Faces then have no group.
    pub(super) fn set(&mut self, face: usize, group: String) -> Result<(), String> {
        let number = match &*group {
            "" => Some(0),
            word if word.eq_ignore_ascii_case("off") => Some(0),
            word => word.parse().ok(),
        };
        // A group that no face used.
        self.runs.pop_if(|&mut (start, _)| start == face);
        if self.runs.last().map_or(0, |&(_, last)| last) != number.unwrap_or(0) {
            self.runs.push((face, number.unwrap_or(0)));
        }
        number.map(drop).ok_or(group)
    }

    /// Returns the groups of the faces; `None` if no face has one.
    pub(super) fn finish(mut self, faces: usize) -> Option<FaceLayer> {
        self.runs.retain(|&(start, _)| start < faces);
        if self.runs.iter().all(|&(_, group)| group == 0) {
            return None;
        }
        let mut of_face = Vec::with_capacity(faces);
        let mut group = 0.0;
        for (start, next) in self.runs {
            of_face.resize(start, group);
            group = f64::from(next);
        }
        of_face.resize(faces, group);
        let (kind, name) = (FaceLayerKind::Smoothing, "smoothing groups".to_owned());
        Some(FaceLayer { kind, name, values: of_face })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn groups(sets: &[(usize, &str)], faces: usize) -> Option<Vec<f64>> {
        let mut runs = SmoothingRuns::default();
        for &(face, group) in sets {
            let _ = runs.set(face, group.to_owned());
        }
        runs.finish(faces).map(|layer| layer.values)
    }

    #[test]
    fn a_group_holds_until_the_next() {
        let sets = [(0, "9"), (0, "off"), (1, "4"), (3, "4"), (4, "OFF"), (5, "2"), (6, "7")];
        assert_eq!(groups(&sets, 6), Some(vec![0.0, 4.0, 4.0, 4.0, 0.0, 2.0]));
    }

    #[test]
    fn no_group_is_none() {
        assert_eq!(groups(&[], 3), None);
        assert_eq!(groups(&[(0, "off"), (1, "0"), (3, "1")], 3), None);
    }

    #[test]
    fn an_invalid_group_is_an_error() {
        let mut runs = SmoothingRuns::default();
        assert_eq!(runs.set(0, "1".into()), Ok(()));
        for group in ["on", "-1", "4294967296"] {
            assert_eq!(runs.set(1, group.into()), Err(group.into()));
        }
        assert_eq!(runs.finish(2).unwrap().values, [1.0, 0.0]);
    }
}
