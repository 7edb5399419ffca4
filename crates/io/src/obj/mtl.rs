//! MTL material libraries: diffuse colour, opacity and colour texture; everything else is ignored.

use std::collections::{HashMap, HashSet};
use std::io::{self, Write};

use crate::text_cursor::TextCursor;
use crate::{FileLocation, Image, Material, ParseError, Scene};

/// Properties of a material in a library.
#[derive(Clone, Debug, PartialEq)]
struct Definition {
    color: [f32; 3],
    opacity: Option<f32>,
    /// Used only if there is no opacity: exporters that write both disagree about this one.
    transparency: f32,
    image: Option<String>,
}

impl Default for Definition {
    fn default() -> Self {
        // Default grey of the format for a material without Kd.
        Self { color: [0.8; 3], opacity: None, transparency: 0.0, image: None }
    }
}

/// Materials of all libraries of a file, by name.
#[derive(Default)]
pub(super) struct Library {
    definitions: HashMap<String, Definition>,
}

/// Materials and images of a scene, and the material of each label.
pub(super) struct Resolved {
    pub(super) materials: Vec<Material>,
    pub(super) images: Vec<Image>,
    pub(super) labels: Vec<Option<usize>>,
}

impl Library {
    /// Loads the libraries of an `mtllib` line, which is one name with blanks or several names.
    /// Missing files are ignored; the first definition of a name wins.
    pub(super) fn add(
        &mut self,
        names: &str,
        resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
    ) -> Result<(), ParseError> {
        if let Some(bytes) = resolve(names) {
            return self.parse(names, &bytes);
        }
        for name in names.split_ascii_whitespace() {
            if name != names
                && let Some(bytes) = resolve(name)
            {
                self.parse(name, &bytes)?;
            }
        }
        Ok(())
    }

    /// Parses the library `name`, adding the name to errors.
    fn parse(&mut self, name: &str, bytes: &[u8]) -> Result<(), ParseError> {
        let in_library = |error: ParseError| ParseError {
            location: FileLocation::Part(format!("{name}, {}", error.location)),
            ..error
        };
        self.parse_lines(bytes).map_err(in_library)
    }

    fn parse_lines(&mut self, bytes: &[u8]) -> Result<(), ParseError> {
        // An empty library has no materials.
        if bytes.is_empty() {
            return Ok(());
        }
        let mut text = TextCursor::new(bytes)?;
        let mut current: Option<(String, Definition)> = None;
        loop {
            let word = if text.more() { text.word() } else { b"" };
            if word == b"newmtl" {
                self.define(current.take());
                current = Some((text.name(), Definition::default()));
            } else if let Some((_, definition)) = &mut current {
                definition.set(word, &mut text)?;
            }
            if !text.next_line() {
                break;
            }
        }
        self.define(current);
        Ok(())
    }

    fn define(&mut self, material: Option<(String, Definition)>) {
        if let Some((name, definition)) = material {
            self.definitions.entry(name).or_insert(definition);
        }
    }
}

impl Definition {
    fn set(&mut self, word: &[u8], text: &mut TextCursor) -> Result<(), ParseError> {
        match word {
            // `Kd spectral` and `Kd xyz` use other colour spaces: the colour stays grey.
            b"Kd" if text.more() && !text.comes(b's') && !text.comes(b'x') => {
                let red = text.attribute("")?;
                let green = if text.more() { text.attribute("")? } else { red };
                let blue = if text.more() { text.attribute("")? } else { red };
                self.color = [red, green, blue];
            }
            b"d" => {
                if text.more() && text.comes(b'-') {
                    text.word();
                }
                self.opacity = Some(text.attribute("d needs an opacity")?);
            }
            b"Tr" => self.transparency = text.attribute("Tr needs a transparency")?,
            b"map_Kd" => self.image = image_name(&text.name()),
            _ => {}
        }
        Ok(())
    }

    fn base_color(&self) -> [f32; 4] {
        let [r, g, b] = self.color;
        [r, g, b, self.opacity.unwrap_or(1.0 - self.transparency)]
    }
}

/// Returns the file name after the options of a `map_Kd` line; it may contain blanks.
fn image_name(line: &str) -> Option<String> {
    let mut rest = line.trim_start();
    while rest.starts_with('-') {
        let (option, mut behind) = split_word(rest);
        let (least, most) = match option {
            "-mm" => (2, 2),
            "-o" | "-s" | "-t" => (1, 3),
            "-blendu" | "-blendv" | "-boost" | "-bm" | "-cc" | "-clamp" | "-imfchan"
            | "-texres" | "-type" => (1, 1),
            // Not an option but a name that begins with a dash.
            _ => break,
        };
        for count in 0..most {
            let (value, after) = split_word(behind);
            if count >= least && value.parse::<f32>().is_err() {
                break;
            }
            behind = after;
        }
        rest = behind;
    }
    (!rest.is_empty()).then(|| rest.to_owned())
}

fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// Looks up the materials with these names, except "", and their images.
///
/// A name without a definition gives a grey material; a missing image keeps its name and has no
/// bytes.
pub(super) fn materials(
    names: &[String],
    library: &Library,
    resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Resolved {
    let mut resolved = Resolved { materials: Vec::new(), images: Vec::new(), labels: Vec::new() };
    let mut image_of: HashMap<String, usize> = HashMap::new();
    for name in names {
        if name.is_empty() {
            resolved.labels.push(None);
            continue;
        }
        let definition = library.definitions.get(name).cloned().unwrap_or_default();
        let base_color = definition.base_color();
        let base_color_image = definition.image.map(|image| {
            *image_of.entry(image).or_insert_with_key(|image| {
                let bytes = resolve(image).unwrap_or_default();
                resolved.images.push(Image { name: image.replace('\\', "/"), bytes });
                resolved.images.len() - 1
            })
        });
        resolved.labels.push(Some(resolved.materials.len()));
        resolved.materials.push(Material {
            name: name.clone(),
            base_color,
            base_color_image,
            ..Material::default()
        });
    }
    resolved
}

/// Writes the materials of a scene as an MTL file, under the names that the OBJ writer
/// [`write`](super::write()) uses.
///
/// # Errors
/// Errors of `out`.
pub fn write(scene: &Scene, out: &mut dyn Write) -> io::Result<()> {
    for (name, material) in names(&scene.materials).iter().zip(&scene.materials) {
        let [r, g, b, opacity] = material.base_color;
        writeln!(out, "newmtl {name}\nKd {r} {g} {b}\nd {opacity}")?;
        if let Some(image) = material.base_color_image.and_then(|i| scene.images.get(i)) {
            writeln!(out, "map_Kd {}", one_line(&image.name))?;
        }
    }
    Ok(())
}

/// Makes the material names unique and fit for one line.
pub(super) fn names(materials: &[Material]) -> Vec<String> {
    let mut taken = HashSet::new();
    let unique = |(i, material): (usize, &Material)| {
        let mut name = one_line(&material.name);
        if name.is_empty() {
            name = format!("material_{i}");
        }
        while !taken.insert(name.clone()) {
            name = format!("{name}_{i}");
        }
        name
    };
    materials.iter().enumerate().map(unique).collect()
}

/// Trims a name and replaces its control characters.
pub(crate) fn one_line(name: &str) -> String {
    name.trim().chars().map(|c| if c.is_control() { '_' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(text: &str) -> Result<Library, ParseError> {
        let mut library = Library::default();
        library.add("a.mtl", &mut |name| (name == "a.mtl").then(|| text.as_bytes().to_vec()))?;
        Ok(library)
    }

    #[test]
    fn colour_opacity_and_image_are_read() {
        let text = "Kd 9 9 9\nnewmtl red hot\n\tKd 1 0 0 # red\n d -halo 0.25\nTr 0\nillum 2\r\n\
                    map_Kd -s 2 2 -o 0 0 0 -clamp on wood grain.png\nnewmtl b\nTr 0.25\nKd 0.5";
        let names = ["red hot", "", "b", "nowhere"].map(str::to_owned);
        let mut asked = Vec::new();
        let resolved = materials(&names, &library(text).unwrap(), &mut |name| {
            asked.push(name.to_owned());
            Some(vec![1, 2])
        });
        assert_eq!(asked, ["wood grain.png"]);
        assert_eq!(resolved.labels, [Some(0), None, Some(1), Some(2)]);
        let colors: Vec<[f32; 4]> = resolved.materials.iter().map(|m| m.base_color).collect();
        assert_eq!(colors, [[1.0, 0.0, 0.0, 0.25], [0.5, 0.5, 0.5, 0.75], [0.8, 0.8, 0.8, 1.0]]);
        assert_eq!(resolved.materials[0].base_color_image, Some(0));
        assert_eq!(
            resolved.images,
            [Image { name: "wood grain.png".to_owned(), bytes: vec![1, 2] }]
        );
    }

    #[test]
    fn an_image_that_is_missing_keeps_its_name() {
        let library = library("newmtl a\nmap_Kd maps\\a.png\n").unwrap();
        let resolved = materials(&["a".to_owned()], &library, &mut |_| None);
        assert_eq!(resolved.images, [Image { name: "maps/a.png".to_owned(), bytes: Vec::new() }]);
    }

    #[test]
    fn errors_name_the_library_and_its_line() {
        let error = library("newmtl a\n\nKd 0,8 0,8 0,8\n").err().unwrap();
        assert_eq!(error.to_string(), "a.mtl, line 3: \"0,8\" is not a number");
    }

    #[test]
    fn a_line_may_name_several_libraries() {
        let mut library = Library::default();
        let file = |name: &str| {
            name.strip_suffix(".mtl")
                .filter(|name| !name.contains(' '))
                .map(|name| format!("newmtl {name}").into_bytes())
        };
        library.add("a.mtl gone b.mtl", &mut |name| file(name)).unwrap();
        let mut names: Vec<&String> = library.definitions.keys().collect();
        names.sort();
        assert_eq!(names, ["a", "b"]);
    }

    #[test]
    fn written_names_differ_and_fit_a_line() {
        let named = ["", "a", "a", "b\nc", "a_2"]
            .map(|name| Material { name: name.to_owned(), ..Material::default() });
        assert_eq!(names(&named), ["material_0", "a", "a_2", "b_c", "a_2_4"]);
    }
}
