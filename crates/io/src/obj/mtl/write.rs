//! Writing MTL libraries.

use std::collections::HashSet;
use std::io::{self, Write};

use super::images::plain_slashes;
use super::meaning::meaning;
use super::properties::{PROPERTIES, color};
use super::read::Library;
use super::statement::word_of;
use crate::scene::material::{Material, MtlStatement};
use crate::scene::{Image, Scene};

/// Writes the materials of a scene as an MTL file, under the names that the OBJ writer
/// [`write`](super::super::write()) uses.
///
/// Statements from a library are written unchanged, in their order, unless the fields of the
/// material differ; missing ones follow. Images have their names in [`Scene::images`] where these
/// differ from the library's.
///
/// # Errors
/// Errors of `out`.
pub fn write(scene: &Scene, out: &mut dyn Write) -> io::Result<()> {
    write_definitions(&definitions(scene).collect::<Vec<_>>(), out)
}

/// Name of a material and the lines that define it.
pub(crate) type Definition = (String, Vec<String>);

/// Writes these materials as an MTL file.
pub(crate) fn write_definitions(definitions: &[Definition], out: &mut dyn Write) -> io::Result<()> {
    for (name, lines) in definitions {
        writeln!(out, "newmtl {name}")?;
        for line in lines {
            writeln!(out, "{line}")?;
        }
    }
    Ok(())
}

/// Returns the names and the lines of the materials of a scene.
fn definitions(scene: &Scene) -> impl Iterator<Item = Definition> {
    let is_foreign = scene.source.is_some();
    let lines = move |material| statements(material, &scene.images, is_foreign).into_iter();
    let text = |line| text_of(&line, &scene.images);
    let materials = scene.materials.iter();
    let materials = materials.map(move |material| lines(material).map(text).collect());
    names(&scene.materials).into_iter().zip(materials)
}

/// Lists the materials that have more than a name in the library of a scene.
pub(crate) fn defined(scene: &Scene) -> Vec<String> {
    let defined = definitions(scene).filter(|(_, lines)| !lines.is_empty());
    defined.map(|(name, _)| name).collect()
}

/// Reports whether libraries define the same materials as this scene, ignoring comments, blank
/// lines and materials that a missing library may define.
pub(crate) fn same_library(library: &Library, scene: &Scene) -> bool {
    let own = own_definitions(library, scene);
    library.definitions().count() == own.len() && holds(library, own.into_iter())
}

/// Returns the materials of a scene with the lines that define them, without materials that are
/// only names and may be defined by a missing library.
pub(crate) fn own_definitions(library: &Library, scene: &Scene) -> Vec<Definition> {
    let is_elsewhere = |name: &str| !library.is_complete() && library.lines_of(name).is_none();
    let own = |(name, lines): &Definition| !lines.is_empty() || !is_elsewhere(name);
    definitions(scene).filter(own).collect()
}

/// Reports whether a library defines all materials of an older one identically, so that it can
/// replace it even if other files use it.
pub(crate) fn is_superset(newer: &[u8], older: &[u8]) -> bool {
    let (Some(newer), Some(older)) = (parsed(newer), parsed(older)) else { return false };
    holds(&newer, older.definitions().map(|(name, lines)| (name.to_owned(), lines.to_vec())))
}

fn parsed(bytes: &[u8]) -> Option<Library> {
    let mut library = Library::default();
    library.parse("", bytes);
    library.is_complete().then_some(library)
}

fn holds(library: &Library, materials: impl Iterator<Item = Definition>) -> bool {
    let says = |lines: &[String]| -> Vec<String> {
        let lines = lines.iter().filter(|line| !word_of(line).is_empty());
        lines.map(|line| line.trim().to_owned()).collect()
    };
    let mut materials = materials;
    materials.all(|(name, lines)| {
        library.lines_of(&name).is_some_and(|known| says(known) == says(&lines))
    })
}

/// Returns the statements that define a material: its own, without outdated ones, and the missing
/// ones.
///
/// The colour of a material that is not from a library is always written, since readers differ in
/// the default.
fn statements(material: &Material, images: &[Image], is_foreign: bool) -> Vec<MtlStatement> {
    let mut lines = material.mtl.clone();
    lines.extend(is_foreign.then(|| color(material)));
    // Twice, as what one statement says may depend on another: a map without a factor has 1.
    for _ in 0..2 {
        let said = meaning(&lines, images);
        for property in PROPERTIES.iter().filter(|property| !(property.is_stated)(&said, material))
        {
            lines.retain(|line| !property.words.contains(&&*word_of(&line.text)));
            lines.extend((property.write)(material));
        }
    }
    lines
}

/// Returns the line of a statement, with the name of its image in the scene.
fn text_of(line: &MtlStatement, images: &[Image]) -> String {
    let Some(map) = &line.map else { return one_statement(&line.text) };
    let file = images.get(map.image).map_or(&*map.name, |image| &*image.name);
    let name = if plain_slashes(&map.name) == file { &map.name } else { file };
    one_statement(&format!("{}{name}{}", line.text, map.rest))
}

/// Replaces line ends and control characters except form feeds, which separate words. A blank keeps
/// a final backslash from continuing the line.
fn one_statement(text: &str) -> String {
    let blank = if text.ends_with('\\') { " " } else { "" };
    text.replace(['\n', '\r', '\0'], "_") + blank
}

/// Makes the material names unique and fit for one line.
pub(crate) fn names(materials: &[Material]) -> Vec<String> {
    let mut taken = HashSet::new();
    let unique = |(i, material): (usize, &Material)| {
        let mut name = one_line(&material.name, str::trim);
        // Would continue the line.
        if name.ends_with('\\') {
            name.push('_');
        }
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

/// Trims a text and replaces its control characters except tabs.
pub(crate) fn one_line(text: &str, trim: fn(&str) -> &str) -> String {
    trim(text).chars().map(|c| if c.is_control() && c != '\t' { '_' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shading;
    use crate::obj::mtl::resolve_materials;

    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08\x02";

    fn read(text: &str) -> Scene {
        let mut library = Library::default();
        library.parse("a.mtl", text.as_bytes());
        let resolved = resolve_materials(&[], &library, &mut |_| Some(PNG.to_vec()));
        Scene { materials: resolved.materials, images: resolved.images, ..Scene::default() }
    }

    fn written(scene: &Scene) -> String {
        let mut out = Vec::new();
        write(scene, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    const LIBRARY: &str = "newmtl a b\n\tKd 1 0 0  # red\n# of old\n\nTr 0.25\nfoo bar\n\
        map_Kd -s 2 2 maps\\A b.png\nbump -bm 0.5 n.png\ndecal -t 0 \x0c 0 n.png\n\
        refl -type sphere n.png\n\
        newmtl empty\nnewmtl c\nKs 1 1 1\nNs 6\nKe 1 2 3\nmap_Pr -imfchan g r.png\n";

    #[test]
    fn statements_are_written_as_they_were() {
        let scene = read(LIBRARY);
        assert_eq!(written(&scene), LIBRARY);
        assert_eq!(written(&read("newmtl a\nfoo \\\\")), "newmtl a\nfoo \\ \n");
        let same = |text: &str| same_library(&parsed(text.as_bytes()).unwrap(), &scene);
        assert!(same(LIBRARY) && same(&LIBRARY.replace("# of old\n", "")));
        assert!(!same(&LIBRARY.replace("Tr 0.25", "Tr 0.5")));
        let more = |older: &str| is_superset(LIBRARY.as_bytes(), older.as_bytes());
        let part = "newmtl c\nKs 1 1 1\nNs 6\nKe 1 2 3\n\nmap_Pr -imfchan g r.png";
        assert!(more(part) && more(&format!("# head\n{part}")));
        assert!(!more("newmtl c\nKs 1 1 1\n") && !more("newmtl d\n"));
    }

    #[test]
    fn written_properties_are_read_back() {
        let scene = read(LIBRARY);
        let a = &scene.materials[0];
        assert_eq!((a.base_color, a.base_color_image), ([1.0, 0.0, 0.0, 0.75], Some(0)));
        assert_eq!((a.shading.normal_image, a.shading.normal_scale), (Some(1), 0.5));
        let c = &scene.materials[2].shading;
        assert_eq!((c.roughness, c.roughness_image, c.emission), (1.0, Some(2), [1.0, 2.0, 3.0]));
        let shiny = &read("newmtl s\nKs 1 1 1\nNs 30\n").materials[0].shading;
        assert_eq!(shiny.roughness, 0.5, "(2 / 32)^(1/4)");
        let matt = &read("newmtl s\nKs 1 1 1\nNs 30\nillum 1\n").materials[0].shading;
        assert_eq!(matt.roughness, 1.0);
    }

    #[test]
    fn a_material_that_was_changed_is_written_as_it_is_now() {
        let mut scene = read(LIBRARY);
        let material = &mut scene.materials[0];
        material.base_color = [0.0, 1.0, 0.0, 0.75];
        material.base_color_image = None;
        material.shading.normal_image = Some(0);
        scene.images[0].name = "b.png".into();
        let text = written(&scene);
        assert!(
            text.starts_with(
                "newmtl a b\n# of old\n\nTr 0.25\nfoo bar\ndecal -t 0 \x0c 0 n.png\nrefl -type"
            ),
            "{text}"
        );
        assert!(text.contains("Kd 0 1 0\nnorm -bm 0.5 b.png\nnewmtl empty"), "{text}");
    }

    #[test]
    fn materials_without_statements_get_what_they_need() {
        let shading = Shading {
            metallic: 0.5,
            metallic_image: Some(0),
            roughness: 1.0,
            roughness_image: Some(0),
            normal_image: Some(1),
            normal_scale: 2.0,
            emission: [0.0; 3],
            emission_image: Some(1),
            opacity_image: Some(0),
        };
        let image = |name: &str| Image { name: name.into(), bytes: PNG.to_vec() };
        let material = Material { name: "m".into(), shading, ..Material::default() };
        let scene = Scene {
            materials: vec![material],
            images: vec![image("a.png"), image("b.png")],
            ..Scene::default()
        };
        let text = written(&scene);
        let again = read(&text);
        assert_eq!(again.materials[0].shading, scene.materials[0].shading, "{text}");
        assert_eq!(again.materials[0].base_color, [1.0; 4]);
    }

    #[test]
    fn written_names_differ_and_fit_a_line() {
        let named = ["", "a", "a", "b\nc", "a_2", "d\\"]
            .map(|name| Material { name: name.to_owned(), ..Material::default() });
        assert_eq!(names(&named), ["material_0", "a", "a_2", "b_c", "a_2_4", "d\\_"]);
    }
}
