//! Byte format of progressive meshes: the base first, then the splits.
//!
//! Little-endian. The layout is `meshlodp`, version and checksum; counts; the arrays of the mesh at
//! its base, where removed elements keep their last state; the splits; their lists. No memory is
//! reserved beyond what the bytes hold, and a mesh that is read is refined once to check it.

use meshlod_mesh::{
    Attributes, FaceId, Labels, Layer, LayerKind, Mesh, MeshError, VertexId, WedgeId,
};
use thiserror::Error;

use super::check::check;
use super::{Progressive, VertexSplit, VertexSplits};
use crate::surface::candidate_states::CandidateId;

const MAGIC: &[u8; 8] = b"meshlodp";
const VERSION: u32 = 1;
/// Offset of the checksum. It covers everything from `BODY` on.
const CHECKSUM: usize = 12;
const BODY: usize = 20;

/// Reason why the bytes of a progressive mesh cannot be decoded.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ProgressiveError {
    /// The data does not start with the magic number of the format.
    #[error("this is not a progressive mesh: it does not start with \"meshlodp\"")]
    Magic,
    /// The version of the format is not supported.
    #[error(
        "version {0} of the progressive mesh format is not supported: only version 1 can be read"
    )]
    Version(u32),
    /// The checksum does not match the data.
    #[error("the checksum does not match: the file is damaged")]
    Checksum,
    /// The data ends before the mesh is complete.
    #[error("byte {at}: the file ends within {what}")]
    Truncated {
        /// Byte offset at which the incomplete part starts.
        at: usize,
        /// Name of the part that is incomplete.
        what: &'static str,
    },
    /// Extra bytes follow the end of the mesh.
    #[error("byte {at}: data follows the end of the mesh")]
    Rest {
        /// Byte offset at which the data should end.
        at: usize,
    },
    /// A part of the data, such as a split or a layer, is invalid.
    #[error("{what} {index} is invalid: {why}")]
    Bad {
        /// Kind of the invalid part: a split, a layer, a name.
        what: &'static str,
        /// Index of the invalid part among those of its kind.
        index: usize,
        /// Explanation of why the part is invalid.
        why: &'static str,
    },
    /// The base mesh decoded from the data is invalid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl Progressive {
    /// Encodes the progressive mesh with all its levels. The decoded mesh starts at the base level,
    /// whichever is current here.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut base = self.clone();
        while base.coarsen() {}
        let mut out = Vec::new();
        out.extend_from_slice(MAGIC);
        out.extend_from_slice(&VERSION.to_le_bytes());
        out.extend_from_slice(&[0; BODY - CHECKSUM]);
        let Self { mesh, alive, splits, .. } = &base;
        let wedges = mesh.attributes.as_ref().map_or(0, |a| a.wedge_count + 1);
        for count in [mesh.positions.len(), mesh.faces.len(), wedges, splits.splits.len()] {
            put(&mut out, count as u32);
        }
        mesh.positions.iter().flatten().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
        mesh.faces.iter().flatten().for_each(|v| put(&mut out, v.0));
        out.extend(alive.iter().map(|&alive| u8::from(alive)));
        put_attributes(&mut out, mesh.attributes.as_ref());
        put_labels(&mut out, mesh.materials.as_ref());
        put_labels(&mut out, mesh.objects.as_ref());
        put_splits(&mut out, splits);
        Self::seal(&mut out);
        out
    }

    /// Corrects the checksum of bytes that a test has modified, so that [`Self::from_bytes`] reads
    /// on.
    pub fn seal(bytes: &mut [u8]) {
        if bytes.len() >= BODY {
            let sum = checksum(&bytes[BODY..]);
            bytes[CHECKSUM..BODY].copy_from_slice(&sum.to_le_bytes());
        }
    }

    /// Decodes a progressive mesh from the bytes written by [`Self::to_bytes`], with the base as
    /// its current level.
    ///
    /// Accepts arbitrary bytes. Every level of the result is a valid mesh.
    ///
    /// # Errors
    /// The bytes are of another format, incomplete, damaged or malicious.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ProgressiveError> {
        if !bytes.starts_with(MAGIC) {
            return Err(ProgressiveError::Magic);
        }
        let mut input = ByteReader { bytes, at: MAGIC.len() };
        let version = input.number("the version")?;
        if version != VERSION {
            return Err(ProgressiveError::Version(version));
        }
        let sum = u64::from_le_bytes(input.array("the checksum")?);
        if sum != checksum(&bytes[BODY..]) {
            return Err(ProgressiveError::Checksum);
        }
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = input.number("the counts")? as usize;
        }
        let [vertices, faces, wedges, splits] = counts;
        let positions = input.doubles(vertices)?;
        let faces_of: Vec<_> = input.triples(faces, "a face")?;
        let alive: Vec<bool> =
            input.take(faces, "the live faces")?.iter().map(|&b| b != 0).collect();
        let mesh = Mesh {
            positions,
            faces: faces_of.into_iter().map(|face| face.map(VertexId)).collect(),
            attributes: wedges.checked_sub(1).map(|n| input.attributes(n, faces)).transpose()?,
            materials: input.labels(faces)?,
            objects: input.labels(faces)?,
            // A stored sequence has none.
            face_layers: Vec::new(),
        };
        let splits = input.splits(splits, mesh.attributes.as_ref())?;
        if input.at != bytes.len() {
            return Err(ProgressiveError::Rest { at: input.at });
        }
        let live_faces = alive.iter().filter(|&&alive| alive).count();
        let coarsened = splits.splits.len();
        let mut read = Self { mesh, alive, live_faces, splits, coarsened };
        check(&mut read)?;
        Ok(read)
    }
}

/// FNV-1a over eight bytes at a time. It detects damage, not manipulation.
fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let words = words.iter().map(|&word| u64::from_le_bytes(word));
    let rest = rest.iter().map(|&byte| u64::from(byte));
    words.chain(rest).fold(0xCBF2_9CE4_8422_2325, |sum, word| {
        (sum ^ word).wrapping_mul(0x0000_0100_0000_01B3).rotate_left(29)
    })
}

fn put(out: &mut Vec<u8>, number: u32) {
    out.extend_from_slice(&number.to_le_bytes());
}

fn put_text(out: &mut Vec<u8>, text: &str) {
    put(out, text.len() as u32);
    out.extend_from_slice(text.as_bytes());
}

fn put_floats(out: &mut Vec<u8>, values: &[f32]) {
    values.iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
}

fn put_attributes(out: &mut Vec<u8>, attributes: Option<&Attributes>) {
    let Some(attributes) = attributes else { return };
    attributes.corners.iter().flatten().for_each(|w| put(out, w.0));
    put(out, attributes.layers.len() as u32);
    for layer in &attributes.layers {
        out.extend_from_slice(&code(layer.kind));
        put_text(out, &layer.name);
        put(out, layer.width as u32);
        put_floats(out, &layer.values);
    }
}

fn put_labels(out: &mut Vec<u8>, labels: Option<&Labels>) {
    put(out, labels.map_or(0, |labels| labels.names.len() as u32 + 1));
    if let Some(labels) = labels {
        labels.names.iter().for_each(|name| put_text(out, name));
        labels.of_face.iter().for_each(|&label| put(out, label));
    }
}

fn put_splits(out: &mut Vec<u8>, splits: &VertexSplits) {
    for (i, split) in splits.splits.iter().enumerate() {
        put(out, split.kept.0);
        put(out, split.removed.0);
        split.position.iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
        for list in [splits.moved_range(i), splits.removed_range(i), splits.blended_range(i)] {
            put(out, list.len() as u32);
        }
    }
    splits.moved.iter().for_each(|corner| put(out, corner.0));
    splits.wedges.iter().for_each(|wedge| put(out, wedge.0));
    splits.removed_faces.iter().for_each(|face| put(out, face.0));
    splits.blended.iter().for_each(|wedge| put(out, wedge.0));
    put_floats(out, &splits.values);
}

/// Encodes the kind of a layer and its set.
fn code(kind: LayerKind) -> [u8; 2] {
    match kind {
        LayerKind::Normal => [0, 0],
        LayerKind::Uv(set) => [1, set],
        LayerKind::Color(set) => [2, set],
        LayerKind::Tangent => [3, 0],
        LayerKind::Joints(set) => [4, set],
        LayerKind::Weights(set) => [5, set],
        LayerKind::Other => [6, 0],
        LayerKind::Label => [7, 0],
    }
}

fn kind([code, set]: [u8; 2]) -> Option<LayerKind> {
    Some(match code {
        0 => LayerKind::Normal,
        1 => LayerKind::Uv(set),
        2 => LayerKind::Color(set),
        3 => LayerKind::Tangent,
        4 => LayerKind::Joints(set),
        5 => LayerKind::Weights(set),
        6 => LayerKind::Other,
        7 => LayerKind::Label,
        _ => return None,
    })
}

/// Reader over bytes.
struct ByteReader<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> ByteReader<'b> {
    fn take(&mut self, count: usize, what: &'static str) -> Result<&'b [u8], ProgressiveError> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or(ProgressiveError::Truncated { at: self.at, what })?;
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], ProgressiveError> {
        Ok(self.arrays::<N>(1, what)?[0])
    }

    fn arrays<const N: usize>(
        &mut self,
        count: usize,
        what: &'static str,
    ) -> Result<&'b [[u8; N]], ProgressiveError> {
        let size = count.checked_mul(N).ok_or(ProgressiveError::Truncated { at: self.at, what })?;
        Ok(self.take(size, what)?.as_chunks().0)
    }

    fn number(&mut self, what: &'static str) -> Result<u32, ProgressiveError> {
        Ok(u32::from_le_bytes(self.array(what)?))
    }

    fn numbers(&mut self, count: usize, what: &'static str) -> Result<Vec<u32>, ProgressiveError> {
        Ok(self.arrays(count, what)?.iter().map(|&bytes| u32::from_le_bytes(bytes)).collect())
    }

    fn triples(
        &mut self,
        count: usize,
        what: &'static str,
    ) -> Result<Vec<[u32; 3]>, ProgressiveError> {
        let triple = |bytes: &[u8; 12]| {
            let parts = bytes.as_chunks::<4>().0;
            [parts[0], parts[1], parts[2]].map(u32::from_le_bytes)
        };
        Ok(self.arrays(count, what)?.iter().map(triple).collect())
    }

    fn doubles(&mut self, count: usize) -> Result<Vec<[f64; 3]>, ProgressiveError> {
        let triple = |bytes: &[u8; 24]| {
            let parts = bytes.as_chunks::<8>().0;
            [parts[0], parts[1], parts[2]].map(f64::from_le_bytes)
        };
        Ok(self.arrays(count, "a position")?.iter().map(triple).collect())
    }

    fn floats(&mut self, count: usize, what: &'static str) -> Result<Vec<f32>, ProgressiveError> {
        Ok(self.arrays(count, what)?.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect())
    }

    fn text(&mut self, index: usize) -> Result<String, ProgressiveError> {
        let length = self.number("a name")? as usize;
        let text = str::from_utf8(self.take(length, "a name")?);
        let bad = |_| ProgressiveError::Bad { what: "name", index, why: "it is not UTF-8" };
        text.map(str::to_owned).map_err(bad)
    }

    fn attributes(
        &mut self,
        wedge_count: usize,
        faces: usize,
    ) -> Result<Attributes, ProgressiveError> {
        let corners = self.triples(faces, "the wedges of a face")?;
        // Each corner stores its wedge in four bytes; without a layer nothing else bounds the
        // count.
        if wedge_count > self.bytes.len() {
            return Err(ProgressiveError::Truncated { at: self.at, what: "the wedges" });
        }
        let layers = (0..self.number("the layers")? as usize).map(|i| self.layer(i, wedge_count));
        Ok(Attributes {
            layers: layers.collect::<Result<_, _>>()?,
            corners: corners.into_iter().map(|face| face.map(WedgeId)).collect(),
            wedge_count,
        })
    }

    fn layer(&mut self, index: usize, wedges: usize) -> Result<Layer, ProgressiveError> {
        let bad = |why| ProgressiveError::Bad { what: "layer", index, why };
        let kind = kind(self.array("a layer")?).ok_or(bad("its kind is unknown"))?;
        let name = self.text(index)?;
        let width = self.number("a layer")? as usize;
        let count = width.checked_mul(wedges).ok_or(bad("it has too many values"))?;
        Ok(Layer { kind, name, width, values: self.floats(count, "a layer's values")? })
    }

    fn labels(&mut self, faces: usize) -> Result<Option<Labels>, ProgressiveError> {
        let Some(count) = self.number("the names")?.checked_sub(1) else { return Ok(None) };
        let names = (0..count as usize).map(|i| self.text(i)).collect::<Result<_, _>>()?;
        Ok(Some(Labels { names, of_face: self.numbers(faces, "the labels")? }))
    }

    fn splits(
        &mut self,
        count: usize,
        attributes: Option<&Attributes>,
    ) -> Result<VertexSplits, ProgressiveError> {
        let records = self.arrays::<44>(count, "a split")?;
        let (mut splits, mut starts) = (Vec::with_capacity(count), [0u32; 3]);
        for (index, record) in records.iter().enumerate() {
            let mut record = ByteReader { bytes: record, at: 0 };
            let [kept, removed] = [record.number("a split")?, record.number("a split")?];
            let position = record.doubles(1)?[0];
            let [moved, removed_faces, blended] = starts;
            splits.push(VertexSplit {
                kept: VertexId(kept),
                removed: VertexId(removed),
                position,
                moved,
                removed_faces,
                blended,
            });
            for start in &mut starts {
                let sum = start.checked_add(record.number("a split")?);
                let why = "its lists are too long";
                *start = sum.ok_or(ProgressiveError::Bad { what: "split", index, why })?;
            }
        }
        let [moved, removed_faces, blended] = starts.map(|end| end as usize);
        let width = attributes.map_or(0, |a| a.layers.iter().map(|layer| layer.width).sum());
        let own = if attributes.is_some() { moved } else { 0 };
        let values = blended.saturating_mul(width);
        Ok(VertexSplits {
            splits,
            moved: self.numbers(moved, "moved corners")?.into_iter().map(CandidateId).collect(),
            wedges: self.numbers(own, "wedges of corners")?.into_iter().map(WedgeId).collect(),
            removed_faces: self
                .numbers(removed_faces, "new faces")?
                .into_iter()
                .map(FaceId)
                .collect(),
            blended: self.numbers(blended, "blended wedges")?.into_iter().map(WedgeId).collect(),
            values: self.floats(values, "blended values")?,
        })
    }
}
