//! Images referenced by MTL statements.

use std::collections::HashMap;

use super::statement::{image_names, names_image, options, word_of};
use crate::scene::Image;
use crate::scene::image_file::is_image;
use crate::scene::material::{MtlMap, MtlStatement};

/// Images loaded so far, without duplicates.
#[derive(Default)]
pub(super) struct MtlImages {
    pub list: Vec<Image>,
    /// Image by its name with slashes.
    numbers: HashMap<String, usize>,
}

impl MtlImages {
    /// Splits a line around the name of an image, if it has one, and loads the image.
    pub fn statement(
        &mut self,
        line: &str,
        resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
    ) -> MtlStatement {
        let plain = || MtlStatement { text: line.to_owned(), map: None };
        if !names_image(&word_of(line)) {
            return plain();
        }
        let (_, rest) = options(line);
        let names = image_names(rest);
        let Some(&last) = names.last() else { return plain() };
        let known = |name: &&&str| self.numbers.contains_key(&plain_slashes(name));
        let name = match names.iter().find(known) {
            Some(&name) => name,
            None => names.iter().find(|name| self.load(name, resolve)).copied().unwrap_or(last),
        };
        let file = plain_slashes(name);
        let image = *self.numbers.entry(file.clone()).or_insert_with(|| {
            self.list.push(Image { name: file, bytes: Vec::new() });
            self.list.len() - 1
        });
        // The name is part of the rest, which is the end of the line.
        let start = line.len() - rest.len() + rest.find(name).unwrap_or(0);
        let map =
            MtlMap { image, name: name.to_owned(), rest: line[start + name.len()..].to_owned() };
        MtlStatement { text: line[..start].to_owned(), map: Some(map) }
    }

    /// Loads an image by its name in the library; returns false if the file does not exist.
    fn load(&mut self, name: &str, resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>) -> bool {
        let Some(bytes) = resolve(name) else { return false };
        // As with glTF, a file from elsewhere must not make the writer copy arbitrary files.
        let bytes = if is_image(name, &bytes) { bytes } else { Vec::new() };
        self.numbers.insert(plain_slashes(name), self.list.len());
        self.list.push(Image { name: plain_slashes(name), bytes });
        true
    }
}

/// Returns a file name with slashes, as exporters on Windows write backslashes.
pub(super) fn plain_slashes(name: &str) -> String {
    let mut name = name.replace('\\', "/");
    while let Some(rest) = name.strip_prefix("./") {
        name = rest.trim_start_matches('/').to_owned();
    }
    name
}
