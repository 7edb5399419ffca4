//! Reading and writing `.mlq` files, which docs/formats/mlq.md describes.

use super::face_labels::FaceLabels;
use super::faces::Faces;
use super::strips::PartStrips;
use super::weld_parts::WeldExceptions;
use super::{BLOCKS_PER_PATCH, Compressed, MAX_VALUES, Positions, WedgeVertices};
use crate::attributes::{PackedLayer, PackedRows};
use crate::bytes::{Malformed, Reader};
use crate::kd::BLOCK;
use crate::patch::{Patches, Rows};

const VERSION: u32 = 1;
/// Size of the file header: magic bytes, version, scheme, a flag for extra wedges, number of
/// layers, length and checksum of each of the three sections, and the checksum of the header.
pub(super) const HEADER: usize = SUMS + 3 * SUM + 4;
const SUMS: usize = 8 + 4 + 1 + 1 + 2;
const SUM: usize = 8 + 4;
/// Size of what stands before labels and resources: their length and checksum.
pub(super) const MORE: usize = SUM;
/// Flags: some vertex has a second wedge; labels or resources follow the attributes; faces are
/// strips of parts.
const HAS_EXTRA: u8 = 1;
const HAS_MORE: u8 = 2;
const HAS_STRIPS: u8 = 4;

impl Compressed {
    /// The first eight bytes of every `.mlq` file.
    pub const MAGIC: [u8; 8] = *b"meshlodq";

    /// Encodes the compressed mesh as the bytes of an `.mlq` file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut sections = [Vec::new(), Vec::new(), Vec::new()];
        let [positions, connectivity, attributes] = &mut sections;
        self.positions.store(positions);
        if let WedgeVertices::Extra(numbers) = &self.wedge_vertices {
            numbers.rows().store(connectivity);
            numbers.store(connectivity);
        }
        self.faces.store(connectivity);
        if let WedgeVertices::Parts(exceptions) = &self.wedge_vertices {
            exceptions.store(connectivity);
        }
        self.layers.iter().for_each(|layer| layer.store(attributes));

        let mut bytes = Vec::with_capacity(self.sizes().total);
        bytes.extend(Self::MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.push(self.positions.tag());
        bytes.push(self.flags());
        bytes.extend((self.layers.len() as u16).to_le_bytes());
        for section in &sections {
            bytes.extend((section.len() as u64).to_le_bytes());
            bytes.extend(crc32fast::hash(section).to_le_bytes());
        }
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        sections.iter().for_each(|section| bytes.extend(section));
        if self.has_more() {
            let mut more = Vec::new();
            self.labels.iter().for_each(|labels| FaceLabels::store(labels.as_ref(), &mut more));
            more.extend(&self.resources);
            bytes.extend((more.len() as u64).to_le_bytes());
            bytes.extend(crc32fast::hash(&more).to_le_bytes());
            bytes.extend(more);
        }
        bytes
    }

    fn flags(&self) -> u8 {
        let flag = |flag: u8, is_set: bool| if is_set { flag } else { 0 };
        flag(HAS_EXTRA, matches!(self.wedge_vertices, WedgeVertices::Extra(_)))
            | flag(HAS_MORE, self.has_more())
            | flag(HAS_STRIPS, self.faces.strips().is_some())
    }

    /// Recomputes the checksums of a modified `.mlq` file, for tests of [`Compressed::from_bytes`].
    #[doc(hidden)]
    pub fn seal(bytes: &mut [u8]) {
        if bytes.len() < HEADER {
            return;
        }
        let mut at = HEADER;
        for sum in (0..3).map(|section| SUMS + section * SUM) {
            let len: [u8; 8] = bytes[sum..sum + 8].try_into().expect("eight");
            let len = usize::try_from(u64::from_le_bytes(len)).unwrap_or(usize::MAX);
            let end = at.saturating_add(len);
            let hash = crc32fast::hash(bytes.get(at..end).unwrap_or_default());
            bytes[sum + 8..sum + SUM].copy_from_slice(&hash.to_le_bytes());
            at = end;
        }
        if let Some(more) = bytes.get_mut(at..).filter(|more| more.len() >= MORE) {
            let hash = crc32fast::hash(&more[MORE..]);
            more[SUM - 4..SUM].copy_from_slice(&hash.to_le_bytes());
        }
        let hash = crc32fast::hash(&bytes[..HEADER - 4]);
        bytes[HEADER - 4..HEADER].copy_from_slice(&hash.to_le_bytes());
    }

    /// Reads an `.mlq` file, keeping its positions, faces and attributes compressed in memory.
    ///
    /// # Errors
    /// Bytes that are not an `.mlq` file, or are damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Malformed> {
        let mut reader = Reader::new(bytes);
        if reader.take(Self::MAGIC.len())? != Self::MAGIC {
            return Err(Malformed {
                at: 0,
                reason: "not an .mlq file: the magic bytes are missing".into(),
            });
        }
        match reader.u32()? {
            VERSION => {}
            version => {
                return Err(reader.wrong(format!(
                    "unknown version {version}; this reader knows version {VERSION}"
                )));
            }
        }
        if bytes.len() < HEADER {
            return Err(reader.wrong("the file ends within the header"));
        }
        let (head, sum) = bytes[..HEADER].split_at(HEADER - 4);
        if crc32fast::hash(head).to_le_bytes() != sum {
            return Err(reader.wrong("the header is damaged: its checksum does not match"));
        }
        let (scheme, flags, count) = (reader.u8()?, reader.u8()?, reader.u16()?);
        if flags & !(HAS_EXTRA | HAS_MORE | HAS_STRIPS) != 0 {
            return Err(reader.wrong(format!("unknown flags {flags:#x}")));
        }
        let mut sums = [(0, 0); 3];
        for sum in &mut sums {
            *sum = (reader.u64()?, reader.u32()?);
        }
        reader.take(4)?;
        let positions = section(&mut reader, "positions", sums[0])?;
        let faces = section(&mut reader, "faces", sums[1])?;
        let attributes = section(&mut reader, "attributes", sums[2])?;
        let more = match flags & HAS_MORE {
            0 => None,
            _ => {
                let sum = (reader.u64()?, reader.u32()?);
                Some(section(&mut reader, "materials and nodes", sum)?)
            }
        };
        reader.finish()?;
        let positions = whole(positions, |reader| Positions::restore(scheme, reader))?;
        let (faces, wedge_vertices) =
            whole(faces, |reader| restore_faces(reader, &positions, flags))?;
        let layers = whole(attributes, |reader| restore_layers(reader, count, faces.rows()))?;
        let (mut labels, mut resources) = ([None, None], Vec::new());
        if let Some(mut more) = more {
            for labels in &mut labels {
                *labels = FaceLabels::restore(&faces, &mut more)?;
            }
            resources = more.rest().to_vec();
        }
        Ok(Self { positions, faces, wedge_vertices, layers, labels, resources })
    }
}

/// Reads a section and checks its sum, given its length and that.
fn section<'a>(
    reader: &mut Reader<'a>,
    what: &str,
    (len, sum): (u64, u32),
) -> Result<Reader<'a>, Malformed> {
    let section = reader.section(usize::try_from(len).unwrap_or(usize::MAX))?;
    match crc32fast::hash(section.rest()) == sum {
        true => Ok(section),
        false => {
            Err(section.wrong(format!("the {what} are damaged: their checksum does not match")))
        }
    }
}

/// Reads a section and checks that nothing of it is left.
fn whole<T>(
    mut section: Reader,
    read: impl FnOnce(&mut Reader) -> Result<T, Malformed>,
) -> Result<T, Malformed> {
    let this = read(&mut section)?;
    section.finish()?;
    Ok(this)
}

/// Reads the faces and the map from their nodes to vertices.
fn restore_faces(
    reader: &mut Reader,
    positions: &Positions,
    flags: u8,
) -> Result<(Faces, WedgeVertices), Malformed> {
    let (has_extra, has_strips) = (flags & HAS_EXTRA != 0, flags & HAS_STRIPS != 0);
    let (faces, wedge_vertices) = match positions.parts() {
        Some(_) if has_extra => return Err(reader.wrong("parts cannot have rows of extra wedges")),
        None if has_strips => return Err(reader.wrong("strips need positions in parts")),
        Some(parts) => {
            let rows = parts.rows().clone();
            let faces = match has_strips {
                true => Faces::Strips(PartStrips::restore(rows, reader)?),
                false => Faces::Patches(Patches::restore(rows, 1, reader)?),
            };
            (faces, WedgeVertices::Parts(WeldExceptions::restore(reader)?))
        }
        None => restore_patches(reader, positions.len(), has_extra)?,
    };
    // Every node is at some corner. Since a face takes bits, this bounds memory by the file size.
    if faces.rows().nodes() > 3 * faces.face_count() {
        return Err(reader.wrong("there are more nodes than face corners"));
    }
    Ok((faces, wedge_vertices))
}

/// Reads the faces over blocks of `count` vertices in all.
fn restore_patches(
    reader: &mut Reader,
    count: usize,
    has_extra: bool,
) -> Result<(Faces, WedgeVertices), Malformed> {
    let block = |at: usize| BLOCK.min(count - BLOCK * at);
    let blocks = count.div_ceil(BLOCK);
    let (wedge_vertices, rows, rows_per_patch) = if has_extra {
        let extra = Rows::restore(blocks, reader)?;
        if count + extra.nodes() > u32::MAX as usize {
            return Err(reader.wrong("the wedges are too many for 32-bit indices"));
        }
        let rows = (0..blocks).flat_map(|at| [block(at), extra.range(at).len()]);
        let rows = Rows::new(rows);
        let extra = WedgeVertices::Extra(PackedRows::restore(extra, 1, reader)?);
        (extra, rows, 2 * BLOCKS_PER_PATCH)
    } else {
        (WedgeVertices::Identity, Rows::new((0..blocks).map(block)), BLOCKS_PER_PATCH)
    };
    Ok((Faces::Patches(Patches::restore(rows, rows_per_patch, reader)?), wedge_vertices))
}

fn restore_layers(
    attributes: &mut Reader,
    count: u16,
    rows: &Rows,
) -> Result<Vec<PackedLayer>, Malformed> {
    let (mut layers, mut values) = (Vec::new(), 0);
    for _ in 0..count {
        let layer = PackedLayer::restore(rows.clone(), attributes)?;
        values += layer.width();
        if values > MAX_VALUES {
            return Err(
                attributes.wrong(format!("a wedge has more than {MAX_VALUES} attribute values"))
            );
        }
        layers.push(layer);
    }
    Ok(layers)
}
