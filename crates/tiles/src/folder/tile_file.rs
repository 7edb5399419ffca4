//! File of a tile's mesh, which the next coarser tile is made from.

use meshlod_mesh::VertexId;

use crate::layout::Layout;
use crate::samples::Samples;
use crate::tile::{TileBuilder, TileMesh};

/// Encodes a tile: counts, positions, faces, border, seams, samples, wedges and materials;
/// little-endian. Its checksum is in the record of the tile.
pub fn encode(tile: &TileMesh, layout: &Layout) -> Vec<u8> {
    let mesh = &tile.mesh;
    let wedges = mesh.attributes.as_ref().map_or(0, |attributes| attributes.wedge_count);
    let mut bytes = Vec::new();
    let samples = &tile.samples;
    let [vertices, faces] = [mesh.positions.len(), mesh.faces.len()];
    let [border, seams] = [tile.border.len(), tile.seams.len()];
    let counts = [vertices, faces, border, seams, samples.points.len(), wedges];
    let mut put = |word: u32| bytes.extend(word.to_le_bytes());
    counts.into_iter().for_each(|count| put(count as u32));
    put(u32::from(mesh.materials.is_some()));
    mesh.positions.iter().flatten().for_each(|&x| put(x as i32 as u32));
    mesh.faces.iter().flatten().for_each(|v| put(v.0));
    tile.border.iter().flatten().for_each(|v| put(v.0));
    tile.seams.iter().flatten().for_each(|&x| put(x as u32));
    put(samples.area.to_bits());
    samples.points.iter().flatten().for_each(|x| put(x.to_bits()));
    if let Some(attributes) = &mesh.attributes {
        attributes.corners.iter().flatten().for_each(|wedge| put(wedge.0));
    }
    if let Some(labels) = &mesh.materials {
        labels.of_face.iter().for_each(|&label| put(label));
    }
    if let Some(attributes) = &mesh.attributes {
        let mut values = Vec::new();
        for wedge in 0..wedges {
            values.clear();
            for layer in &attributes.layers {
                values.extend_from_slice(&layer.values[wedge * layer.width..][..layer.width]);
            }
            layout.pack(&values, &mut bytes);
        }
    }
    bytes
}

/// Decodes a tile; `None` if it is damaged.
pub fn decode(bytes: &[u8], layout: &Layout, labels: &[String]) -> Option<TileMesh> {
    let mut words = Words { bytes };
    let counts = words.take(7)?;
    let [vertices, faces, border, seams, samples, wedges] =
        [0, 1, 2, 3, 4, 5].map(|i| counts[i] as usize);
    let mut tile = TileMesh::default();
    let mut mesh = TileBuilder::new(layout.attributes(), labels).into_mesh();
    let triples = |words: Vec<u32>| words.as_chunks().0.to_vec();
    let positions: Vec<[u32; 3]> = triples(words.take(3 * vertices)?);
    mesh.positions = positions.iter().map(|at| at.map(|x| f64::from(x as i32))).collect();
    mesh.faces = triples(words.take(3 * faces)?).iter().map(|face| face.map(VertexId)).collect();
    let edges = words.take(2 * border)?;
    tile.border = edges.as_chunks().0.iter().map(|edge| edge.map(VertexId)).collect();
    let seams = triples(words.take(seams.checked_mul(3)?)?);
    tile.seams = seams.iter().map(|point| point.map(|x| x as i32)).collect();
    let area = f32::from_bits(words.take(1)?[0]);
    let points = triples(words.take(samples.checked_mul(3)?)?);
    let points = points.iter().map(|point| point.map(f32::from_bits)).collect();
    tile.samples = Samples { points, area };
    if let Some(attributes) = &mut mesh.attributes {
        let corners = triples(words.take(3 * faces)?);
        attributes.corners = corners.iter().map(|face| face.map(meshlod_mesh::WedgeId)).collect();
        attributes.wedge_count = wedges;
    }
    if counts[6] == 1 {
        mesh.materials.as_mut()?.of_face = words.take(faces)?;
    }
    if let Some(attributes) = &mut mesh.attributes {
        let mut values = Vec::new();
        for record in words.bytes.chunks_exact(layout.bytes()) {
            values.clear();
            layout.unpack(record, &mut values);
            let mut rest = &values[..];
            for layer in &mut attributes.layers {
                let (own, after) = rest.split_at(layer.width);
                layer.values.extend_from_slice(own);
                rest = after;
            }
        }
    }
    mesh.validate().ok()?;
    let is_there = |v: &VertexId| v.index() < vertices;
    tile.mesh = mesh;
    tile.border.iter().flatten().all(is_there).then_some(tile)
}

struct Words<'a> {
    bytes: &'a [u8],
}

impl Words<'_> {
    fn take(&mut self, count: usize) -> Option<Vec<u32>> {
        let (own, rest) = self.bytes.split_at_checked(count.checked_mul(4)?)?;
        self.bytes = rest;
        Some(own.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect())
    }
}
