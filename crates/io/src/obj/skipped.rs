//! Counts of the statements in an OBJ file that are not faces.

use std::collections::{BTreeMap, BTreeSet};

use crate::notes::Note;
use crate::text::cursor::text_of;

/// Parts of an OBJ file that are left out.
#[derive(Default)]
pub(super) struct Skipped {
    /// Number of lines by statement.
    statements: BTreeMap<Vec<u8>, usize>,
    /// Smoothing groups that are not numbers.
    pub smoothing: BTreeSet<String>,
    /// Names of groups in a file that has objects.
    pub groups: BTreeSet<String>,
    /// Faces of two corners or fewer.
    pub thin_faces: usize,
    /// Third texture coordinates other than 0.
    pub depths: usize,
    /// Weights of vertices other than 1.
    pub weights: usize,
    /// Opacities of vertices.
    pub opacities: usize,
    /// Numbers of attributes that are not finite.
    pub not_finite: usize,
    /// Masks of vertices in polypaint.
    pub masks: usize,
    /// Colours of polypaint that are unused, for lack of a vertex or since vertices have colours.
    pub paint: usize,
}

/// Statements of free-form curves and surfaces.
const FREE_FORM: [&[u8]; 20] = [
    b"vp", b"cstype", b"deg", b"bmat", b"step", b"curv", b"curv2", b"surf", b"parm", b"trim",
    b"hole", b"scrv", b"sp", b"end", b"con", b"bsp", b"bzp", b"cdc", b"cdp", b"res",
];

impl Skipped {
    /// Counts a statement that is not understood.
    pub fn statement(&mut self, word: &[u8]) {
        match self.statements.get_mut(word) {
            Some(count) => *count += 1,
            None => drop(self.statements.insert(word.to_vec(), 1)),
        }
    }

    /// Returns the notes; groups are left out only where objects take their place.
    pub fn notes(mut self, has_objects: bool) -> Vec<Note> {
        if !has_objects {
            self.groups.clear();
        }
        let mut of = |word: &[u8]| self.statements.remove(word).unwrap_or_default();
        let [lines, points] = [of(b"l"), of(b"p")];
        let free_form = FREE_FORM.map(&mut of).iter().sum();
        let other = self.statements.values().sum();
        let words: Vec<String> = self.statements.keys().map(|word| text_of(word)).collect();
        let note = Note::left_out;
        let mut notes = vec![
            note(lines, "line", "lines"),
            note(points, "statement of points", "statements of points"),
            note(
                free_form,
                "statement of free-form curves or surfaces",
                "statements of free-form curves or surfaces",
            )
            .remedied("export curves and surfaces as faces"),
            note(other, "other statement", "other statements").named(words),
            Note::thin_faces(self.thin_faces),
            note(
                self.smoothing.len(),
                "smoothing group that is no number",
                "smoothing groups that are no numbers",
            )
            .named(self.smoothing)
            .remedied("write `s` with a number, or `s off`"),
            note(self.groups.len(), "name of a group", "names of groups")
                .named(self.groups)
                .remedied("remove the `o` lines to keep groups instead of objects"),
            note(self.depths, "third texture coordinate", "third texture coordinates"),
            note(self.weights, "weight of a vertex", "weights of vertices"),
            note(self.opacities, "opacity of a vertex", "opacities of vertices")
                .remedied("export opacities as .ply or .glb"),
            note(self.masks, "mask of a vertex", "masks of vertices"),
            note(self.paint, "colour of polypaint", "colours of polypaint"),
            Note::not_finite(self.not_finite),
        ];
        notes.retain(|note| note.count > 0);
        notes
    }
}
