//! Material, group and object names of an OBJ file, each valid until the next `usemtl`, `g` or `o`.

use std::collections::HashMap;

use meshlod_mesh::Labels;

/// Labels by runs of consecutive faces.
#[derive(Default)]
pub(super) struct LabelRuns {
    /// Number of each name, by first use.
    numbers: HashMap<String, u32>,
    /// First face and name number of each run. Faces before the first run have the name "".
    runs: Vec<(usize, u32)>,
}

impl LabelRuns {
    /// Sets the name of all faces from `face` on.
    pub(super) fn set(&mut self, face: usize, name: String) {
        if self.runs.is_empty() && face > 0 {
            self.set_number(0, String::new());
        }
        // Drop a name that no face used.
        self.runs.pop_if(|&mut (start, _)| start == face);
        self.set_number(face, name);
    }

    fn set_number(&mut self, face: usize, name: String) {
        let next = self.numbers.len() as u32;
        let number = *self.numbers.entry(name).or_insert(next);
        self.runs.push((face, number));
    }

    /// Returns the names in use, in order of first use, and the label of each face; `None` if no
    /// face has a name other than "".
    pub(super) fn finish(mut self, faces: usize) -> Option<Labels> {
        self.runs.retain(|&(start, _)| start < faces);
        let mut numbered = vec![String::new(); self.numbers.len()];
        for (name, number) in self.numbers {
            numbered[number as usize] = name;
        }
        let mut labels = Labels { names: Vec::new(), of_face: Vec::with_capacity(faces) };
        let mut label_of: Vec<Option<u32>> = vec![None; numbered.len()];
        let ends = self.runs.iter().skip(1).map(|&(start, _)| start).chain([faces]);
        for (&(_, number), end) in self.runs.iter().zip(ends) {
            let label = *label_of[number as usize].get_or_insert_with(|| {
                labels.names.push(std::mem::take(&mut numbered[number as usize]));
                labels.names.len() as u32 - 1
            });
            labels.of_face.resize(end, label);
        }
        labels.names.iter().any(|name| !name.is_empty()).then_some(labels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(sets: &[(usize, &str)], faces: usize) -> Option<(Vec<String>, Vec<u32>)> {
        let mut runs = LabelRuns::default();
        for &(face, name) in sets {
            runs.set(face, name.to_owned());
        }
        runs.finish(faces).map(|labels| (labels.names, labels.of_face))
    }

    #[test]
    fn names_that_come_back_are_one_and_unused_ones_none() {
        let sets = [(0, "never"), (0, "a"), (2, "b"), (3, "a"), (4, "late")];
        assert_eq!(
            labels(&sets, 4),
            Some((vec!["a".to_owned(), "b".to_owned()], vec![0, 0, 1, 0]))
        );
    }

    #[test]
    fn faces_before_the_first_name_have_the_empty_one() {
        assert_eq!(labels(&[(1, "a")], 2), Some((vec![String::new(), "a".to_owned()], vec![0, 1])));
    }

    #[test]
    fn no_names_are_no_labels() {
        assert_eq!(labels(&[], 3), None);
        assert_eq!(labels(&[(0, ""), (3, "unused")], 3), None);
    }
}
