//! The file `.mlq`: docs/formats/mlq.md.

use super::{BLOCKS_PER_PATCH, Compressed, Exceptions, Homes, MOST_VALUES, Positions};
use crate::attributes::{Packed, PackedLayer};
use crate::bytes::{Malformed, Reader};
use crate::kd::BLOCK;
use crate::patch::{Patches, Rows};

const VERSION: u32 = 1;
/// The magic bytes, the version, the scheme, whether there are doubles, how many layers there are, of the three sections how
/// long they are and their sums, and the sum of all that.
pub(super) const HEADER: usize = SUMS + 3 * SUM + 4;
const SUMS: usize = 8 + 4 + 1 + 1 + 2;
const SUM: usize = 8 + 4;

impl Compressed {
    /// What every such file begins with.
    pub const MAGIC: [u8; 8] = *b"meshlodq";

    /// The bytes of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut sections = [Vec::new(), Vec::new(), Vec::new()];
        let [positions, connectivity, attributes] = &mut sections;
        self.positions.store(positions);
        if let Homes::Doubles(numbers) = &self.homes {
            numbers.rows().store(connectivity);
            numbers.store(connectivity);
        }
        self.patches.store(connectivity);
        if let Homes::Parts(exceptions) = &self.homes {
            exceptions.store(connectivity);
        }
        self.layers.iter().for_each(|layer| layer.store(attributes));

        let mut bytes = Vec::with_capacity(self.sizes().total);
        bytes.extend(Self::MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.push(self.positions.tag());
        bytes.push(matches!(self.homes, Homes::Doubles(_)).into());
        bytes.extend((self.layers.len() as u16).to_le_bytes());
        for section in &sections {
            bytes.extend((section.len() as u64).to_le_bytes());
            bytes.extend(crc32fast::hash(section).to_le_bytes());
        }
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        sections.iter().for_each(|section| bytes.extend(section));
        bytes
    }

    /// Writes the checksums that fit into bytes that were changed, for tests of [`Compressed::from_bytes`].
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
            let told = crc32fast::hash(bytes.get(at..end).unwrap_or_default());
            bytes[sum + 8..sum + SUM].copy_from_slice(&told.to_le_bytes());
            at = end;
        }
        let told = crc32fast::hash(&bytes[..HEADER - 4]);
        bytes[HEADER - 4..HEADER].copy_from_slice(&told.to_le_bytes());
    }

    /// What the bytes of a file are.
    ///
    /// # Errors
    /// Bytes that are none, or were spoilt.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Malformed> {
        let mut reader = Reader::new(bytes);
        if reader.take(Self::MAGIC.len())? != Self::MAGIC {
            return Err(Malformed {
                at: 0,
                reason: "not an .mlq file: it begins otherwise".into(),
            });
        }
        match reader.u32()? {
            VERSION => {}
            version => return Err(reader.wrong(format!("version {version} is not known"))),
        }
        if bytes.len() < HEADER {
            return Err(reader.wrong("the header is cut off"));
        }
        let (head, sum) = bytes[..HEADER].split_at(HEADER - 4);
        if crc32fast::hash(head).to_le_bytes() != sum {
            return Err(reader.wrong("the header has been spoilt: another sum"));
        }
        let (scheme, has_doubles, count) = (reader.u8()?, reader.u8()?, reader.u16()?);
        if has_doubles > 1 {
            return Err(reader.wrong(format!("flags {has_doubles:#x} are not known")));
        }
        let mut sums = [(0, 0); 3];
        for sum in &mut sums {
            *sum = (reader.u64()?, reader.u32()?);
        }
        reader.take(4)?;
        let mut section = |what: &str, (len, sum): (u64, u32)| {
            let section = reader.section(usize::try_from(len).unwrap_or(usize::MAX))?;
            match crc32fast::hash(section.rest()) == sum {
                true => Ok(section),
                false => Err(section.wrong(format!("the {what} have been spoilt: another sum"))),
            }
        };
        let positions = section("positions", sums[0])?;
        let faces = section("faces", sums[1])?;
        let attributes = section("attributes", sums[2])?;
        reader.finish()?;
        let positions = whole(positions, |reader| Positions::restore(scheme, reader))?;
        let (patches, homes) =
            whole(faces, |reader| restore_faces(reader, &positions, has_doubles == 1))?;
        let layers = whole(attributes, |reader| restore_layers(reader, count, patches.rows()))?;
        Ok(Self { positions, patches, homes, layers })
    }
}

/// What is read of a section, if that is all of it.
fn whole<T>(
    mut section: Reader,
    read: impl FnOnce(&mut Reader) -> Result<T, Malformed>,
) -> Result<T, Malformed> {
    let this = read(&mut section)?;
    section.finish()?;
    Ok(this)
}

/// Faces, and which vertices their nodes are.
fn restore_faces(
    faces: &mut Reader,
    positions: &Positions,
    has_doubles: bool,
) -> Result<(Patches, Homes), Malformed> {
    let count = positions.len();
    let block = |at: usize| BLOCK.min(count - BLOCK * at);
    let blocks = count.div_ceil(BLOCK);
    let (mut homes, rows, rows_per_patch) = match positions {
        Positions::Parts(_) if has_doubles => return Err(faces.wrong("parts have no doubles")),
        Positions::Parts(parts) => (Homes::Own, parts.rows().clone(), 1),
        _ if has_doubles => {
            let doubles = Rows::restore(blocks, faces)?;
            if count + doubles.nodes() > u32::MAX as usize {
                return Err(faces.wrong("more wedges than are numbered"));
            }
            let rows = (0..blocks).flat_map(|at| [block(at), doubles.range(at).len()]);
            let rows = Rows::new(rows);
            (Homes::Doubles(Packed::restore(doubles, 1, faces)?), rows, 2 * BLOCKS_PER_PATCH)
        }
        _ => (Homes::Own, Rows::new((0..blocks).map(block)), BLOCKS_PER_PATCH),
    };
    let patches = Patches::restore(rows, rows_per_patch, faces)?;
    // Each is at a corner, or there would be no need of it; and a face takes bits.
    if patches.rows().nodes() > 3 * patches.face_count() {
        return Err(faces.wrong("more nodes than corners of faces"));
    }
    if let Positions::Parts(_) = positions {
        homes = Homes::Parts(Exceptions::restore(faces)?);
    }
    Ok((patches, homes))
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
        if values > MOST_VALUES {
            return Err(attributes.wrong(format!("more than {MOST_VALUES} values a wedge")));
        }
        layers.push(layer);
    }
    Ok(layers)
}
