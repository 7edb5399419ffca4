//! Numbering of the distinct texture coordinates and normals of an OBJ file.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::io;

use meshlod_mesh::{LayerKind, Mesh};

use crate::text::line_writer::LineWriter;

/// Number of each wedge's value in a layer.
pub(super) struct ValueNumbers {
    pub of_wedge: Option<Vec<u32>>,
    /// Number of the last value.
    last: u32,
}

impl ValueNumbers {
    /// Writes the distinct values of a layer, if it exists, and numbers them from `before` + 1.
    pub fn write(
        mesh: &Mesh,
        kind: LayerKind,
        word: &str,
        before: u32,
        lines: &mut LineWriter,
    ) -> io::Result<Self> {
        let layer = mesh.attributes.as_ref().and_then(|attributes| attributes.layer(kind));
        let Some(layer) = layer else { return Ok(Self { of_wedge: None, last: before }) };
        let mut numbers: HashMap<[u32; 3], u32> = HashMap::new();
        let mut of_wedge = Vec::with_capacity(layer.values.len() / layer.width);
        for values in layer.values.chunks_exact(layer.width) {
            let mut bits = [0; 3];
            for (bits, value) in bits.iter_mut().zip(values) {
                *bits = value.to_bits();
            }
            let next = before + numbers.len() as u32 + 1;
            let number = *numbers.entry(bits).or_insert(next);
            if number == next {
                lines.word(word);
                lines.attributes(values);
                lines.end()?;
            }
            of_wedge.push(number);
        }
        Ok(Self { of_wedge: Some(of_wedge), last: before + numbers.len() as u32 })
    }
}

/// Numbers of the texture coordinates; each material uses one set.
pub(super) struct UvNumbers {
    sets: BTreeMap<u8, ValueNumbers>,
    /// Set of each material label.
    of_label: Vec<u8>,
}

impl UvNumbers {
    /// Writes the texture coordinates that faces use; `of_label` gives the set of each material.
    /// Other faces use the first set, and so do materials whose set the mesh lacks.
    pub fn write(mesh: &Mesh, of_label: &[u8], lines: &mut LineWriter) -> io::Result<Self> {
        let has = |set: u8| {
            let attributes = mesh.attributes.as_ref();
            attributes.is_some_and(|attributes| attributes.layer(LayerKind::Uv(set)).is_some())
        };
        let of_label: Vec<u8> =
            of_label.iter().map(|&set| if has(set) { set } else { 0 }).collect();
        let mut numbers = Self { sets: BTreeMap::new(), of_label };
        let mut last = 0;
        for face in 0..mesh.faces.len() {
            let set = numbers.set_of(mesh, face);
            if let Entry::Vacant(free) = numbers.sets.entry(set) {
                let values = ValueNumbers::write(mesh, LayerKind::Uv(set), "vt", last, lines)?;
                last = values.last;
                free.insert(values);
            }
        }
        Ok(numbers)
    }

    fn set_of(&self, mesh: &Mesh, face: usize) -> u8 {
        let label = mesh.materials.as_ref().map(|labels| labels.of(face) as usize);
        label.and_then(|label| self.of_label.get(label).copied()).unwrap_or(0)
    }

    /// Returns the numbers that a face uses.
    pub fn of_face(&self, mesh: &Mesh, face: usize) -> &ValueNumbers {
        &self.sets[&self.set_of(mesh, face)]
    }
}
