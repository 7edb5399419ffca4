//! Notes on losses: parts of a file that a reader left out, parts of a scene that a format cannot
//! hold.

use std::fmt;

/// Kind of difference between a file and its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoteKind {
    /// Missing on the other side.
    LeftOut,
    /// Present in another form.
    Changed,
}

impl NoteKind {
    /// Returns the word for messages: `left out` or `changed`.
    pub fn word(self) -> &'static str {
        match self {
            Self::LeftOut => "left out",
            Self::Changed => "changed",
        }
    }
}

/// Note that items of one kind were left out or changed when a file was read or written.
///
/// It is displayed as in `2 images that were not found (a.png, b.png)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Difference between the file and the scene.
    pub kind: NoteKind,
    /// Number of items.
    pub count: usize,
    /// Noun for the items, in the singular if there is one: `images that were not found`.
    pub what: String,
    /// Names of the first few items, if names help to find them.
    pub names: Vec<String>,
    /// Advice on how to avoid the loss, if any: `.glb keeps everything`.
    pub remedy: Option<String>,
    /// Noun in the plural, which identifies notes of one sort.
    many: String,
}

/// Largest number of names that a note keeps.
const MOST_NAMES: usize = 8;

impl Note {
    /// Creates a note that `count` items were left out, called `one` or, if several, `many`.
    pub fn left_out(count: usize, one: &str, many: &str) -> Self {
        Self::new(NoteKind::LeftOut, count, one, many)
    }

    /// Creates a note that `count` items were changed: `normal scaled to unit length`.
    pub fn changed(count: usize, one: &str, many: &str) -> Self {
        Self::new(NoteKind::Changed, count, one, many)
    }

    /// Creates a note on attribute values that are not finite and were read as 0.
    pub(crate) fn not_finite(count: usize) -> Self {
        Self::changed(
            count,
            "value of an attribute that is not finite read as 0",
            "values of attributes that are not finite read as 0",
        )
    }

    /// Creates a note on faces without a triangle, which were left out.
    pub(crate) fn thin_faces(count: usize) -> Self {
        Self::left_out(
            count,
            "face of fewer than three corners",
            "faces of fewer than three corners",
        )
    }

    fn new(kind: NoteKind, count: usize, one: &str, many: &str) -> Self {
        let what = if count == 1 { one } else { many };
        let (names, remedy) = (Vec::new(), None);
        Self { kind, count, what: what.to_owned(), names, remedy, many: many.to_owned() }
    }

    /// Appends a detail to the noun: how much the items changed, or why.
    pub fn detailed(mut self, detail: &str) -> Self {
        self.what += detail;
        self
    }

    /// Sets the names of the items; only the first few are kept.
    pub fn named<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.names = names.into_iter().take(MOST_NAMES).map(Into::into).collect();
        self
    }

    /// Sets the advice on how to avoid the loss.
    pub fn remedied(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }

    /// Merges notes of two parts of a whole; of two notes on the same kind of items, the one with
    /// the larger count stays.
    pub fn merge(notes: &mut Vec<Self>, further: Vec<Self>) {
        for note in further {
            let is_like = |known: &&mut Self| (known.kind, &known.many) == (note.kind, &note.many);
            match notes.iter_mut().find(is_like) {
                Some(known) if known.count >= note.count => {}
                Some(known) => *known = note,
                None => notes.push(note),
            }
        }
    }

    /// Formats the notes of one kind as a list, followed by each remedy once: `2 lines, 1 point;
    /// .glb keeps everything`. Returns `None` if there are none.
    pub fn list(notes: &[Self], kind: NoteKind) -> Option<String> {
        let of_it = || notes.iter().filter(|note| note.kind == kind);
        let texts: Vec<String> = of_it().map(Self::to_string).collect();
        let mut parts = vec![texts.join(", ")];
        for remedy in of_it().filter_map(|note| note.remedy.as_ref()) {
            if !parts[1..].contains(remedy) {
                parts.push(remedy.clone());
            }
        }
        (!texts.is_empty()).then(|| parts.join("; "))
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", grouped(self.count), self.what)?;
        if self.names.is_empty() {
            return Ok(());
        }
        let more = if self.count > self.names.len() { ", …" } else { "" };
        write!(f, " ({}{more})", self.names.join(", "))
    }
}

/// Formats a count with commas as thousands separators: 871,414.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_counts_and_names() {
        let note = |count| Note::left_out(count, "image not found", "images not found");
        assert_eq!(note(1).to_string(), "1 image not found");
        assert_eq!(
            note(2).named(["a.png", "b.png"]).to_string(),
            "2 images not found (a.png, b.png)"
        );
        let many = note(1200).named((0..1200).map(|i| i.to_string()));
        assert_eq!(many.to_string(), "1,200 images not found (0, 1, 2, 3, 4, 5, 6, 7, …)");
    }

    #[test]
    fn merged_notes_say_the_same_once() {
        let note = |count| {
            let note = Note::changed(count, "vertex rounded", "vertices rounded");
            note.detailed(&format!(" by {count} mm"))
        };
        let mut notes = vec![note(1)];
        Note::merge(&mut notes, vec![note(3), Note::left_out(1, "vertex rounded", "")]);
        Note::merge(&mut notes, vec![note(2)]);
        assert_eq!(Note::list(&notes, NoteKind::Changed).unwrap(), "3 vertices rounded by 3 mm");
        assert_eq!(notes.len(), 2);
    }

    #[test]
    fn a_remedy_stands_once_behind_its_list() {
        let note = |count, one, remedy| Note::left_out(count, one, "").remedied(remedy);
        let notes = [
            note(1, "line", "use .glb"),
            note(1, "point", "use .obj"),
            note(1, "curve", "use .glb"),
            Note::changed(1, "normal scaled", ""),
        ];
        let list = Note::list(&notes, NoteKind::LeftOut).unwrap();
        assert_eq!(list, "1 line, 1 point, 1 curve; use .glb; use .obj");
        assert_eq!(Note::list(&notes, NoteKind::Changed).unwrap(), "1 normal scaled");
    }

    #[test]
    fn lists_keep_differences_apart() {
        let notes = [
            Note::changed(3, "normal scaled", "normals scaled"),
            Note::left_out(1, "line", "lines"),
            Note::left_out(2, "point", "points"),
        ];
        assert_eq!(Note::list(&notes, NoteKind::LeftOut).unwrap(), "1 line, 2 points");
        assert_eq!(Note::list(&notes[..1], NoteKind::LeftOut), None);
    }
}
