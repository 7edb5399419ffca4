//! A mesh from its blocks: borders welded, attributes joined.

use meshlod_mesh::{Attributes, Labels, Layer, Mesh, WedgeId, merge_equal_wedges};

use super::border::NODES;
use super::decode::{Lane, Sharing};
use super::layers::{BlockLayers, LayersFormat};
use super::predict::CellVec;
use super::weld_blocks::{WeldTable, key};

/// Numbers of vertices, by which blocks are welded along their borders.
pub(super) struct VertexNumbers {
    welds: WeldTable,
    pub(super) vertices: u32,
    sharing: Vec<Sharing>,
    /// Number of each vertex of a block.
    numbers: Box<[u32; NODES]>,
}

impl VertexNumbers {
    pub(super) fn new(welds: usize) -> Self {
        let numbers: Box<[u32]> = vec![0; NODES].into();
        Self {
            welds: WeldTable::new(welds),
            vertices: 0,
            sharing: Vec::new(),
            numbers: numbers.try_into().expect("as many as there are"),
        }
    }

    /// Adds a block: calls `place` for each new vertex, and appends its faces.
    #[inline(never)]
    pub(super) fn add(
        &mut self,
        lane: &Lane,
        mut place: impl FnMut(CellVec),
        faces: &mut Vec<[u32; 3]>,
    ) {
        lane.sharing(&mut self.sharing);
        for ((cell, &sharing), number_of) in lane.cells().zip(&self.sharing).zip(&mut *self.numbers)
        {
            let number = match sharing {
                Sharing::Inside => self.vertices,
                Sharing::Shared(tag) => *self.welds.find_or_insert(key(cell), tag, self.vertices),
            };
            if number == self.vertices {
                self.vertices += 1;
                place(cell);
            }
            *number_of = number;
        }
        let numbers = &self.numbers;
        let number = |v: u16| numbers[usize::from(v) % NODES];
        faces.extend(lane.faces().iter().map(|&[a, b, c]| [number(a), number(b), number(c)]));
    }
}

/// Attributes and labels, block after block.
#[derive(Clone, Debug)]
pub(super) struct LayersBuilder<'f> {
    format: &'f LayersFormat,
    attributes: Attributes,
    labels: [Vec<u32>; 2],
}

impl<'f> LayersBuilder<'f> {
    pub(super) fn new(format: &'f LayersFormat) -> Self {
        let layers = format.layers.iter().map(|layer| Layer {
            kind: layer.coding.kind,
            name: layer.coding.name.clone(),
            width: layer.coding.width,
            values: Vec::new(),
        });
        let attributes = Attributes { layers: layers.collect(), ..Attributes::default() };
        Self { format, attributes, labels: [Vec::new(), Vec::new()] }
    }

    /// Adds the wedges and labels of a block.
    pub(super) fn add(&mut self, block: &BlockLayers) {
        let first = self.attributes.wedge_count;
        let count = block.wedges.vertex.len();
        self.attributes.wedge_count += count;
        let corners = block.wedges.of_corner.as_chunks().0.iter();
        let wedge = |wedge: u16| WedgeId::new(first + usize::from(wedge));
        self.attributes.corners.extend(corners.map(|face: &[u16; 3]| face.map(wedge)));
        let mut numbers = Vec::new();
        let formats = self.format.layers.iter().zip(&block.layers);
        for (layer, (format, values)) in self.attributes.layers.iter_mut().zip(formats) {
            for wedge in 0..count {
                numbers.clear();
                let components = format.coding.components();
                numbers.extend(values.of(wedge, components).iter().map(|&x| x as u32));
                format.coding.values(&numbers, &mut layer.values);
            }
        }
        for (all, labels) in self.labels.iter_mut().zip(&block.labels) {
            all.extend(labels.iter().flatten());
        }
    }

    /// Gives a mesh its attributes, materials and objects. Wedges of a vertex with equal values
    /// become one, which closes what the borders of blocks have cut.
    pub(super) fn finish(self, mesh: &mut Mesh) {
        let [materials, objects] = self.labels;
        let [material_names, object_names] = &self.format.names;
        let labels = |names: &Option<Vec<String>>, of_face| {
            names.clone().map(|names| Labels { names, of_face })
        };
        mesh.materials = labels(material_names, materials);
        mesh.objects = labels(object_names, objects);
        if !self.attributes.layers.is_empty() {
            mesh.attributes = Some(self.attributes);
            merge_equal_wedges(mesh);
        }
    }
}
