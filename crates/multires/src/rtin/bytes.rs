//! Serialization of a height field, as stored in a container.
//!
//! Heights come in the order of insertion, each as its difference from a prediction at the middle
//! of its hypotenuse. So coarse heights come first, and a prediction uses only heights that precede
//! it. docs/notes/rtin.md has the layout.

use thiserror::Error;

use super::field::{Fit, GridPlacement, HeightField};
use super::grid::{Grid, GridPoint};
use crate::pack::{unzigzag, zigzag};

/// Precision with which the heights of a height field are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum HeightPrecision {
    /// Heights are stored exactly, bit for bit.
    Exact,
    /// Heights are stored to within this distance in model units, which must be positive.
    Within(f64),
}

/// Reason why a height field cannot be written or read.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FieldBytesError {
    /// The requested bound on the rounding of heights is not a positive length.
    #[error("the bound on rounding must be a length above 0, not {0}")]
    BadBound(f64),
    /// The data of the height field end early.
    #[error(
        "the height field is truncated: {needed} more bytes of its {what} are needed, only {found} are left"
    )]
    Short {
        /// Name of the truncated part.
        what: &'static str,
        /// Number of bytes needed to complete the part.
        needed: usize,
        /// Number of bytes that are left.
        found: usize,
    },
    /// A stored value of the height field is invalid.
    #[error("the height field is damaged: invalid {0}")]
    Bad(&'static str),
    /// A part of the heights cannot be decompressed, or not to its expected length.
    #[error("part {part} of the heights is damaged: {why}")]
    Heights {
        /// Index of the damaged part, from 0.
        part: u32,
        /// Error message of the decompressor.
        why: String,
    },
}

/// Version of the layout.
const VERSION: u8 = 1;
const HEADER: usize = 72;
/// Largest number of heights per byte; shorter fields are padded. It keeps the header of a short
/// file from requesting much memory, while flat fields of millions of heights still take only
/// kilobytes.
const MAX_PER_BYTE: usize = 256;
/// Number of heights that a prefix of any length may announce, since a short one says as little as
/// its first few parts.
const FREE_HEIGHTS: usize = 1 << 24;
/// Zstandard level. Exact heights of the shared terrain take the same space at 3, 9, 15 and 19, to
/// a third of a percent; in cells of 4 m they take 2 % more at 3 and 7 % less at 19.
const EFFORT: i32 = 9;
/// Largest multiple of a cell that is exact in `f64`.
const MAX_CELLS: f64 = (1u64 << 52) as f64;

/// Range of cell exponents: from the smallest `f64` to where multiples would overflow.
const MIN_POWER: i16 = -1074;
const MAX_POWER: i16 = 900;
/// Limit of coordinates, so that squared distances are finite.
pub(super) const MAX_COORDINATE: f64 = 1e150;

/// Mapping of heights to integers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    /// Multiples of this power of two.
    Cells(i16),
    /// Bit patterns of `f64`, reordered to sort like the numbers.
    Bits,
}

impl HeightField {
    /// Encodes the height field as little-endian bytes, without a checksum of its header.
    /// # Errors
    /// The bound on rounding is not a positive length.
    pub fn to_bytes(&self, precision: HeightPrecision) -> Result<Vec<u8>, FieldBytesError> {
        Ok(self.encoded(precision)?.0)
    }

    /// Encodes the height field like [`to_bytes`](Self::to_bytes), and returns the fit of what is
    /// decoded.
    pub(crate) fn encoded(
        &self,
        precision: HeightPrecision,
    ) -> Result<(Vec<u8>, Fit), FieldBytesError> {
        let scale = Scale::for_heights(&self.heights, precision)?;
        let codes: Vec<i64> = self.heights.iter().map(|&height| scale.code(height)).collect();
        let rounded =
            self.heights.iter().zip(&codes).map(|(h, &code)| (scale.height(code) - h).abs());
        let fit = Fit { rounded: self.fit.rounded + rounded.fold(0.0, f64::max), ..self.fit };
        let mut bytes = header(&self.grid, &self.placement, &fit, scale);
        for part in 0..=self.grid.depth() {
            let residual = |place| {
                let (code, guess) = (codes[self.grid.index(place)], self.grid.guess(place, &codes));
                zigzag(code.wrapping_sub(guess))
            };
            let residuals: Vec<u64> = self.grid.part(part).map(residual).collect();
            write_part(&residuals, &mut bytes)
                .map_err(|e| FieldBytesError::Heights { part, why: e.to_string() })?;
        }
        bytes.resize(bytes.len().max(self.grid.count().div_ceil(MAX_PER_BYTE)), 0);
        Ok((bytes, fit))
    }

    /// Decodes a height field that [`HeightField::to_bytes`] wrote.
    ///
    /// Memory use is proportional to the number of bytes, whatever they contain.
    /// # Errors
    /// The data are truncated or damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FieldBytesError> {
        Self::decode(bytes, None).map(|(field, _)| field)
    }

    /// Decodes the start of a height field of `whole` bytes, and returns it with the number of
    /// parts present and the total number.
    ///
    /// A vertex of a part that is missing gets the height by which it would have been predicted,
    /// from the middle of its hypotenuse. So the field is that of the last part present, up to
    /// rounding to the cells of the heights.
    ///
    /// Memory use is proportional to the number of bytes, or that of 16 million heights if they are
    /// few.
    /// # Errors
    /// The header or the first part are truncated, or the data are damaged.
    pub fn from_prefix(bytes: &[u8], whole: u64) -> Result<(Self, [u32; 2]), FieldBytesError> {
        let (field, parts) = Self::decode(bytes, Some(whole))?;
        let all = field.grid.depth() + 1;
        Ok((field, [parts, all]))
    }

    /// Decodes a height field, or its start if the length of the whole is given. Returns the number
    /// of parts that were there.
    fn decode(bytes: &[u8], whole: Option<u64>) -> Result<(Self, u32), FieldBytesError> {
        let is_prefix = whole.is_some_and(|whole| whole > bytes.len() as u64);
        let mut reader = ByteReader { bytes };
        let (mut this, scale) = read_header(&mut reader)?;
        let least = this.grid.count().div_ceil(MAX_PER_BYTE);
        let is_small = is_prefix && this.grid.count() <= FREE_HEIGHTS;
        if bytes.len() < least && !is_small {
            let (needed, found) = (least - HEADER, reader.bytes.len());
            return Err(FieldBytesError::Short { what: "heights", needed, found });
        }
        let mut codes = vec![0i64; this.grid.count()];
        let mut parts = 0;
        for part in 0..=this.grid.depth() {
            let residuals = match read_part(&mut reader, this.grid.part(part).count(), part) {
                Err(FieldBytesError::Short { .. }) if is_prefix && part > 0 => {
                    // What follows belongs to this part.
                    reader.bytes = &[];
                    None
                }
                read => Some(read?),
            };
            parts += u32::from(residuals.is_some());
            let mut residuals = residuals.into_iter().flatten();
            for place in this.grid.part(part) {
                let residual = residuals.next().unwrap_or(0);
                let code = this.grid.guess(place, &codes).wrapping_add(unzigzag(residual));
                codes[this.grid.index(place)] = code;
            }
        }
        let is_padding = reader.bytes.iter().all(|&byte| byte == 0) && bytes.len() == least;
        if !(is_padding || reader.bytes.is_empty() || is_prefix) {
            return Err(FieldBytesError::Bad("length"));
        }
        this.heights = codes.iter().map(|&code| scale.height(code)).collect();
        if !scale.holds(&codes) || !this.heights.iter().all(|height| height.abs() < MAX_COORDINATE)
        {
            return Err(FieldBytesError::Bad("heights"));
        }
        Ok((this, parts))
    }
}

impl Grid {
    /// Iterates over a part: the corners of the square in part 0, and in part k the vertices
    /// inserted after k − 1 halvings.
    fn part(&self, part: u32) -> impl Iterator<Item = GridPoint> + use<> {
        let grid = *self;
        let side = self.side;
        let corners = [[0, 0], [side, 0], [0, side], [side, side]];
        let corners = corners.map(|[column, row]| GridPoint { column, row });
        let corners = corners.into_iter().filter(move |&p| part == 0 && grid.holds(p));
        let inserted = part.checked_sub(1).map(|depth| grid.inserted_at(depth));
        corners.chain(inserted.into_iter().flatten())
    }

    /// Predicts a height from earlier parts: the middle of its hypotenuse, or as much of that as is
    /// known.
    fn guess(&self, place: GridPoint, codes: &[i64]) -> i64 {
        let Some(diamond) = self.diamond(place) else {
            return if place == GridPoint::default() { 0 } else { codes[0] };
        };
        let code = |p: &GridPoint| self.holds(*p).then(|| codes[self.index(*p)]);
        let mut known = diamond.ends.iter().filter_map(code);
        match (known.next(), known.next()) {
            (Some(a), Some(b)) => i64::midpoint(a, b),
            (Some(only), None) => only,
            // Then the hypotenuse is a falling one, and a corner before it is known.
            _ => diamond.corners().find_map(|p| code(&p)).unwrap_or(0),
        }
    }
}

impl Scale {
    fn for_heights(heights: &[f64], precision: HeightPrecision) -> Result<Self, FieldBytesError> {
        let most = heights.iter().fold(0f64, |most, height| most.max(height.abs()));
        let exact = heights.iter().filter(|&&h| h != 0.0).map(|&h| last_bit(h)).min().unwrap_or(0);
        let power = match precision {
            HeightPrecision::Exact => exact,
            HeightPrecision::Within(bound) if bound > 0.0 && bound.is_finite() => {
                exact.max((2.0 * bound).log2().floor() as i16)
            }
            HeightPrecision::Within(bound) => return Err(FieldBytesError::BadBound(bound)),
        };
        let power = power.min(MAX_POWER);
        let fits = most <= MAX_CELLS * f64::from(power).exp2();
        Ok(if fits { Self::Cells(power) } else { Self::Bits })
    }

    fn code(self, height: f64) -> i64 {
        match self {
            Self::Cells(power) => (height / f64::from(power).exp2()).round() as i64,
            Self::Bits => in_order(height.to_bits() as i64),
        }
    }

    fn height(self, code: i64) -> f64 {
        match self {
            Self::Cells(power) => code as f64 * f64::from(power).exp2(),
            Self::Bits => f64::from_bits(in_order(code) as u64),
        }
    }

    /// Returns true if the codes are in the range of the scale.
    fn holds(self, codes: &[i64]) -> bool {
        self == Self::Bits || codes.iter().all(|code| code.unsigned_abs() <= MAX_CELLS as u64)
    }
}

/// Returns the exponent of the lowest set bit of a nonzero number.
fn last_bit(x: f64) -> i16 {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i16;
    let mantissa = bits & ((1 << 52) - 1) | u64::from(exponent > 0) << 52;
    exponent.max(1) - 1075 + mantissa.trailing_zeros() as i16
}

/// Maps the bits of an `f64` to an integer in the same order, and back.
fn in_order(bits: i64) -> i64 {
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

fn header(grid: &Grid, placement: &GridPlacement, fit: &Fit, scale: Scale) -> Vec<u8> {
    let (kind, power) = match scale {
        Scale::Cells(power) => (0, power),
        Scale::Bits => (1, 0),
    };
    let mut bytes = vec![VERSION, placement.up, placement.looks_down.into(), kind];
    bytes.extend(i32::from(power).to_le_bytes());
    bytes.extend([grid.columns, grid.rows].map(u32::to_le_bytes).as_flattened());
    let lengths = [placement.origin, placement.step].concat();
    for length in lengths.into_iter().chain([fit.moved, fit.turned, fit.rounded]) {
        bytes.extend(length.to_le_bytes());
    }
    bytes
}

/// Reads a field without its heights.
fn read_header(reader: &mut ByteReader<'_>) -> Result<(HeightField, Scale), FieldBytesError> {
    use FieldBytesError::Bad;
    let what = "header";
    let [version, up, looks_down, kind] = reader.array(what)?;
    if version != VERSION {
        return Err(Bad("version"));
    }
    if up > 2 || looks_down > 1 {
        return Err(Bad("axis"));
    }
    let power = i32::from_le_bytes(reader.array(what)?);
    let scale = match (kind, i16::try_from(power)) {
        (0, Ok(power)) if (MIN_POWER..=MAX_POWER).contains(&power) => Scale::Cells(power),
        (1, Ok(0)) => Scale::Bits,
        _ => return Err(Bad("scale")),
    };
    let columns = u32::from_le_bytes(reader.array(what)?);
    let rows = u32::from_le_bytes(reader.array(what)?);
    let grid = Grid::new(columns, rows).ok_or(Bad("size"))?;
    let mut lengths = [0.0; 7];
    for length in &mut lengths {
        *length = f64::from_le_bytes(reader.array(what)?);
    }
    let [x, y, dx, dy, moved, turned, rounded] = lengths;
    let placement =
        GridPlacement { up, looks_down: looks_down == 1, origin: [x, y], step: [dx, dy] };
    let is_place = |x: f64| x.abs() < MAX_COORDINATE;
    let last = placement.point(GridPoint { column: columns - 1, row: rows - 1 }, 0.0).to_array();
    let is_placement = [x, y].into_iter().chain(last).all(is_place) && dx > 0.0 && dy > 0.0;
    if !is_placement || ![moved, turned, rounded].iter().all(|x| (0.0..MAX_COORDINATE).contains(x))
    {
        return Err(Bad("grid placement"));
    }
    let fit = Fit { moved, turned, rounded };
    Ok((HeightField { grid, placement, heights: Vec::new(), fit }, scale))
}

/// Writes the width of the numbers, their compressed length and the compressed bytes: first the low
/// byte of each number, then the next of each, and so on.
fn write_part(residuals: &[u64], bytes: &mut Vec<u8>) -> std::io::Result<()> {
    let greatest = residuals.iter().copied().max().unwrap_or(0);
    let width = (u64::BITS - greatest.leading_zeros()).div_ceil(8);
    let plane = |k: u32| residuals.iter().map(move |x| (x >> (8 * k)) as u8);
    let planes: Vec<u8> = (0..width).flat_map(plane).collect();
    let mut packed = Vec::new();
    if width > 0 {
        let mut packer = zstd::bulk::Compressor::new(EFFORT)?;
        packer.include_checksum(true)?;
        packed = packer.compress(&planes)?;
    }
    let length = u32::try_from(packed.len()).map_err(std::io::Error::other)?;
    bytes.push(width as u8);
    bytes.extend(length.to_le_bytes());
    bytes.extend(packed);
    Ok(())
}

fn read_part(
    reader: &mut ByteReader<'_>,
    count: usize,
    part: u32,
) -> Result<impl Iterator<Item = u64> + use<>, FieldBytesError> {
    let damaged = |why: &str| FieldBytesError::Heights { part, why: why.to_owned() };
    let [width] = reader.array("heights")?;
    let width = usize::from(width);
    let length = u32::from_le_bytes(reader.array("heights")?) as usize;
    let packed = reader.take(length, "heights")?;
    if width > 8 || (width == 0) != packed.is_empty() {
        return Err(damaged("invalid width"));
    }
    let planes = match width {
        0 => Vec::new(),
        _ => zstd::bulk::decompress(packed, count * width).map_err(|e| damaged(&e.to_string()))?,
    };
    if planes.len() != count * width {
        return Err(damaged("too few values"));
    }
    Ok((0..count).map(move |i| {
        (0..width).map(|k| u64::from(planes[k * count + i]) << (8 * k)).fold(0, |x, byte| x | byte)
    }))
}

/// The bytes not yet read.
struct ByteReader<'b> {
    bytes: &'b [u8],
}

impl<'b> ByteReader<'b> {
    fn take(&mut self, needed: usize, what: &'static str) -> Result<&'b [u8], FieldBytesError> {
        let found = self.bytes.len();
        let (taken, rest) = self.bytes.split_at_checked(needed).ok_or(FieldBytesError::Short {
            what,
            needed,
            found,
        })?;
        self.bytes = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], FieldBytesError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }
}
