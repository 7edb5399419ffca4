//! Reading MTL libraries and their images.

use std::collections::{HashMap, HashSet};

use super::images::MtlImages;
use super::lines::lines;
use super::meaning::{StatedValues, meaning};
use super::statement::{split_word, word_of};
use crate::notes::Note;
use crate::scene::Image;
use crate::scene::material::{Material, MtlStatement};

/// Materials of all libraries of a file.
#[derive(Default)]
pub(crate) struct Library {
    /// Materials with the lines that define each, in the order of the libraries.
    definitions: Vec<(String, Vec<String>)>,
    /// Material by name.
    numbers: HashMap<String, usize>,
    /// Names of the requested libraries.
    asked: HashSet<String>,
    missing: Vec<String>,
    /// Libraries that are not text, with the reasons.
    unreadable: Vec<(String, String)>,
    /// Malformed statements, which are kept but ignored, with locations and reasons.
    malformed: Vec<String>,
    /// Materials with more than one definition.
    repeated: Vec<String>,
}

/// Materials and images of a scene, the material of each label, and notes on losses.
pub(crate) struct Resolved {
    pub materials: Vec<Material>,
    pub images: Vec<Image>,
    pub labels: Vec<Option<usize>>,
    pub notes: Vec<Note>,
}

impl Library {
    /// Loads the libraries of an `mtllib` line, which holds one name with blanks or several names,
    /// quoted or not. Missing files are noted; the first definition of a name wins.
    pub fn add(&mut self, names: &str, resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>) {
        if names.is_empty() || !self.asked.insert(names.to_owned()) {
            return;
        }
        if let Some(bytes) = resolve(names) {
            return self.parse(names, &bytes);
        }
        let parts = library_names(names);
        let mut missing = Vec::new();
        for &name in &parts {
            if name != names && !self.asked.insert(name.to_owned()) {
                continue;
            }
            match resolve(name).filter(|_| name != names) {
                Some(bytes) => self.parse(name, &bytes),
                None => missing.push(name.to_owned()),
            }
        }
        // If no part of a name with blanks is a file, it is more likely a single name.
        if missing.len() == parts.len() && !names.contains('"') {
            missing = vec![names.to_owned()];
        }
        self.missing.extend(missing);
    }

    /// Parses the library `name`. Malformed statements are kept and noted.
    pub fn parse(&mut self, name: &str, bytes: &[u8]) {
        let found = match lines(bytes) {
            Ok(found) => found,
            Err(error) => return self.unreadable.push((name.to_owned(), error.reason)),
        };
        let mut current: Option<(String, Vec<String>)> = None;
        let mut said = StatedValues::default();
        for line in found {
            if word_of(&line.text) == "newmtl" {
                self.define(current.take());
                let name = line.text.trim_start().get("newmtl".len()..).unwrap_or_default();
                current = Some((name.trim_ascii().to_owned(), Vec::new()));
            } else if let Some((_, definition)) = &mut current {
                if let Err(error) = said.add(&line.text, None) {
                    let place = format!("{name}, line {}: {}", line.number, error.reason);
                    self.malformed.push(place);
                }
                definition.push(line.text);
            }
        }
        self.define(current);
    }

    /// Reports whether all requested libraries have been read.
    pub fn is_complete(&self) -> bool {
        self.unread().next().is_none()
    }

    /// Lists the libraries that were not found or could not be read.
    pub fn unread(&self) -> impl Iterator<Item = &str> {
        let unreadable = self.unreadable.iter().map(|(name, _)| &**name);
        self.missing.iter().map(|name| &**name).chain(unreadable)
    }

    fn define(&mut self, material: Option<(String, Vec<String>)>) {
        let Some((name, lines)) = material else { return };
        match self.numbers.get(&name) {
            Some(&known) if self.definitions[known].1 == lines => {}
            Some(_) => self.repeated.push(name),
            None => {
                self.numbers.insert(name.clone(), self.definitions.len());
                self.definitions.push((name, lines));
            }
        }
    }

    /// Returns the lines that define a material, if it is defined.
    pub fn lines_of(&self, name: &str) -> Option<&[String]> {
        self.numbers.get(name).map(|&number| &self.definitions[number].1[..])
    }

    /// Lists the materials with the lines that define them.
    pub fn definitions(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.definitions.iter().map(|(name, lines)| (&**name, &lines[..]))
    }

    fn notes(&self, used: &[String]) -> Vec<Note> {
        let undefined =
            used.iter().filter(|name| !name.is_empty() && self.lines_of(name).is_none());
        let undefined: Vec<&String> = undefined.collect();
        // Without a library, names are all that the file has.
        let is_told = !self.definitions.is_empty() && self.is_complete();
        let count = if is_told { undefined.len() } else { 0 };
        let mut notes = vec![
            Note::left_out(
                self.missing.len(),
                "material library that was not found",
                "material libraries that were not found",
            )
            .named(self.missing.clone())
            .remedied("put it beside the model, or correct its mtllib line"),
            Note::left_out(
                self.unreadable.len(),
                "material library that cannot be read",
                "material libraries that cannot be read",
            )
            .named(self.unreadable.iter().map(|(name, reason)| format!("{name}: {reason}"))),
            Note::left_out(
                self.malformed.len(),
                "MTL statement that cannot be understood",
                "MTL statements that cannot be understood",
            )
            .named(self.malformed.clone())
            .remedied("correct the library; until then, defaults hold"),
            Note::left_out(
                count,
                "material that no library defines",
                "materials that no library defines",
            )
            .named(undefined)
            .remedied("add a newmtl of that name to a library, or correct the usemtl line"),
            Note::left_out(
                self.repeated.len(),
                "further definition of a material",
                "further definitions of materials",
            )
            .named(self.repeated.clone())
            .remedied("give each material a name of its own"),
        ];
        notes.retain(|note| note.count > 0);
        notes
    }
}

/// Splits an `mtllib` line into several names; names with blanks are in quotes.
pub(crate) fn library_names(line: &str) -> Vec<&str> {
    let mut names = Vec::new();
    let mut rest = line.trim_ascii();
    while !rest.is_empty() {
        let quoted = rest.strip_prefix('"').and_then(|rest| rest.split_once('"'));
        let (name, behind) = quoted.unwrap_or_else(|| split_word(rest));
        names.extend((!name.is_empty()).then_some(name));
        rest = behind.trim_ascii_start();
    }
    names
}

/// Looks up the materials with these names, except "", then adds unused ones; loads all their
/// images.
///
/// A name without a definition gives a grey material. A missing or invalid image keeps its name and
/// has no bytes.
pub(crate) fn resolve_materials(
    names: &[String],
    library: &Library,
    resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Resolved {
    let mut images = MtlImages::default();
    let mut materials = Vec::new();
    let mut labels = Vec::new();
    for name in names {
        if name.is_empty() {
            labels.push(None);
            continue;
        }
        labels.push(Some(materials.len()));
        let lines = library.lines_of(name).unwrap_or_default();
        materials.push(material(name, lines, &mut images, resolve));
    }
    let used: HashSet<&str> = names.iter().map(String::as_str).collect();
    for (name, lines) in library.definitions().filter(|(name, _)| !used.contains(name)) {
        materials.push(material(name, lines, &mut images, resolve));
    }
    Resolved { materials, images: images.list, labels, notes: library.notes(names) }
}

fn material(
    name: &str,
    lines: &[String],
    images: &mut MtlImages,
    resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Material {
    let mtl: Vec<MtlStatement> = lines.iter().map(|line| images.statement(line, resolve)).collect();
    let meaning = meaning(&mtl, &images.list);
    Material {
        name: name.to_owned(),
        base_color: meaning.base_color,
        base_color_image: meaning.base_color_image,
        shading: meaning.shading,
        mtl,
        ..Material::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MtlMap;

    fn library(text: &str) -> Library {
        let mut library = Library::default();
        library.add("a.mtl", &mut |name| (name == "a.mtl").then(|| text.as_bytes().to_vec()));
        library
    }

    const PNG: &[u8] = b"\x89PNG";

    #[test]
    fn colour_opacity_and_image_are_read() {
        let text = "Kd 9 9 9\nnewmtl red hot\n\tKd 1 0 0 # red\n d -halo 0.25\nTr 0\nillum 2\r\n\
                    map_Kd -s 2 2 -o 0 0 0 -clamp on wood grain.png\nnewmtl b\nTr 0.25\nKd 0.5";
        let names = ["red hot", "", "b", "nowhere"].map(str::to_owned);
        let mut asked = Vec::new();
        let resolved = resolve_materials(&names, &library(text), &mut |name| {
            asked.push(name.to_owned());
            Some(PNG.to_vec())
        });
        assert_eq!(asked, ["wood grain.png"]);
        assert_eq!(resolved.labels, [Some(0), None, Some(1), Some(2)]);
        let colors: Vec<[f32; 4]> = resolved.materials.iter().map(|m| m.base_color).collect();
        assert_eq!(colors, [[1.0, 0.0, 0.0, 0.25], [0.5, 0.5, 0.5, 0.75], [0.8, 0.8, 0.8, 1.0]]);
        assert_eq!(resolved.materials[0].base_color_image, Some(0));
        let image = Image { name: "wood grain.png".to_owned(), bytes: PNG.to_vec() };
        assert_eq!(resolved.images, [image]);
        let notes: Vec<String> = resolved.notes.iter().map(Note::to_string).collect();
        assert_eq!(notes, ["1 material that no library defines (nowhere)"]);
    }

    #[test]
    fn a_material_that_no_face_uses_is_read_too() {
        let library = library("newmtl a\nKd 1\nnewmtl b\nKs 1\nnewmtl a\nKd 0\n");
        let resolved = resolve_materials(&["b".to_owned()], &library, &mut |_| None);
        let names: Vec<&str> = resolved.materials.iter().map(|m| &*m.name).collect();
        assert_eq!(names, ["b", "a"]);
        assert_eq!(resolved.materials[1].base_color, [1.0; 4]);
        assert_eq!(resolved.notes[0].to_string(), "1 further definition of a material (a)");
    }

    #[test]
    fn an_image_that_is_missing_or_none_keeps_its_name() {
        let library = library("newmtl a\nmap_Kd maps\\a.png\nbump .\\maps/a.png # old");
        for bytes in [None, Some(b"root:x:0:0".to_vec())] {
            let resolved = resolve_materials(&["a".to_owned()], &library, &mut |_| bytes.clone());
            let image = Image { name: "maps/a.png".to_owned(), bytes: Vec::new() };
            assert_eq!(resolved.images[0], image);
            let names: Vec<&MtlMap> =
                resolved.materials[0].mtl.iter().filter_map(|line| line.map.as_ref()).collect();
            assert_eq!(names[0].name, "maps\\a.png");
        }
        let mut file = |name: &str| (!name.contains('#')).then(|| PNG.to_vec());
        let resolved = resolve_materials(&["a".to_owned()], &library, &mut file);
        assert_eq!(resolved.images.len(), 1, "one image of two spellings");
        let last = resolved.materials[0].mtl[1].map.clone().unwrap();
        assert_eq!((&*last.name, &*last.rest), (".\\maps/a.png", " # old"));
    }

    #[test]
    fn a_malformed_statement_is_named_and_says_nothing() {
        let text = "newmtl a\n\nKd 0,8 0,8 0,8\nTr x\nKd 1 1 z\nd\n";
        let resolved = resolve_materials(&["a".to_owned()], &library(text), &mut |_| None);
        let note = &resolved.notes[0];
        assert_eq!((note.count, resolved.notes.len()), (4, 1));
        assert_eq!(note.names[0], "a.mtl, line 3: \"0,8\" is not a number");
        assert_eq!(note.names[3], "a.mtl, line 6: d needs an opacity");
        assert_eq!(resolved.materials[0].base_color, [0.8, 0.8, 0.8, 1.0]);
        let note = &library("a\0b").notes(&[])[0];
        assert!(note.names[0].starts_with("a.mtl: a zero byte"), "{note:?}");
    }

    #[test]
    fn names_of_libraries_may_be_quoted() {
        assert_eq!(library_names(" \"a b.mtl\"  c.mtl\t\"d"), ["a b.mtl", "c.mtl", "\"d"]);
        let mut library = Library::default();
        let found = |name: &str| name == "a b.mtl" || name == "c.mtl";
        let file = |name: &str| found(name).then(|| format!("newmtl {name}").into_bytes());
        library.add("\"a b.mtl\" \"not there.mtl\" c.mtl", &mut |name| file(name));
        assert_eq!(library.definitions().count(), 2);
        assert_eq!(library.missing, ["not there.mtl"]);
    }

    #[test]
    fn a_line_may_name_several_libraries() {
        let mut library = Library::default();
        let file = |name: &str| {
            name.strip_suffix(".mtl")
                .filter(|name| !name.contains(' ') && *name != "gone")
                .map(|name| format!("newmtl {name}").into_bytes())
        };
        for _ in 0..2 {
            library.add("a.mtl gone.mtl b.mtl", &mut |name| file(name));
        }
        let names: Vec<&str> = library.definitions().map(|(name, _)| name).collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(library.missing, ["gone.mtl"]);
        library.add("not there.mtl", &mut |_| None);
        assert_eq!(library.missing, ["gone.mtl", "not there.mtl"]);
        assert_eq!(library.repeated, [""; 0]);
    }
}
