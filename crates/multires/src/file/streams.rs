//! Streams of bytes and numbers, separated by meaning so that they compress well.

use std::io::{self, Read, Write};
use std::ops::{BitOrAssign, Shl};

use crate::pack::{unzigzag, zigzag};

/// Compression level of zstandard. On the dragon, higher levels take twice the time and save half a
/// percent.
const COMPRESSION_LEVEL: i32 = 9;
/// Upper limit on the numbers read per compressed byte, so that a short file cannot exhaust the
/// memory. Real files have up to 20.
const MAX_NUMBERS_PER_BYTE: usize = 64;
/// Magic number of a skippable zstandard frame, which pads data that compresses below that limit.
const SKIPPABLE_FRAME: [u8; 4] = 0x184D_2A50u32.to_le_bytes();

/// Compresses streams one after the other. Each is flushed, so it gets blocks and entropy codes of
/// its own.
pub(super) struct Packer {
    encoder: zstd::Encoder<'static, Vec<u8>>,
    numbers: usize,
}

impl Packer {
    pub(super) fn new() -> io::Result<Self> {
        let mut encoder = zstd::Encoder::new(Vec::new(), COMPRESSION_LEVEL)?;
        encoder.include_contentsize(false)?;
        Ok(Self { encoder, numbers: 0 })
    }

    /// Appends a stream of bytes. Its length is not stored.
    pub(super) fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.numbers += bytes.len();
        self.encoder.write_all(bytes)?;
        self.encoder.flush()
    }

    /// Appends a stream of numbers by byte planes, the lowest bytes first, after a byte with the
    /// number of planes.
    pub(super) fn numbers<N: Copy + Into<u64>>(&mut self, numbers: &[N]) -> io::Result<()> {
        let most = numbers.iter().map(|&n| n.into()).max().unwrap_or(0);
        let planes = (u64::BITS - most.leading_zeros()).div_ceil(8);
        self.numbers += 1 + if planes > 0 { 0 } else { numbers.len() };
        self.encoder.write_all(&[planes as u8])?;
        for plane in 0..planes {
            let bytes: Vec<u8> = numbers.iter().map(|&n| (n.into() >> (8 * plane)) as u8).collect();
            self.bytes(&bytes)?;
        }
        Ok(())
    }

    /// Appends a stream of signed numbers, mapped to unsigned ones by [`zigzag`].
    pub(super) fn signed(&mut self, numbers: impl Iterator<Item = i32>) -> io::Result<()> {
        let folded: Vec<u32> = numbers.map(|n| zigzag(n.into()) as u32).collect();
        self.numbers(&folded)
    }

    /// Appends bytes that encode this many numbers, after their length.
    pub(super) fn encoded(&mut self, numbers: usize, bytes: &[u8]) -> io::Result<()> {
        self.numbers(&[bytes.len() as u32])?;
        self.numbers += numbers;
        self.bytes(bytes)
    }

    pub(super) fn finish(self) -> io::Result<Vec<u8>> {
        let mut bytes = self.encoder.finish()?;
        let least = self.numbers / MAX_NUMBERS_PER_BYTE;
        if bytes.len() < least {
            let rest = least - bytes.len();
            bytes.extend(SKIPPABLE_FRAME);
            bytes.extend((rest as u32).to_le_bytes());
            bytes.resize(bytes.len() + rest, 0);
        }
        Ok(bytes)
    }
}

/// Reads the streams of a [`Packer`], and never allocates more than was asked for.
pub(super) struct Unpacker<'b> {
    decoder: zstd::Decoder<'static, &'b [u8]>,
    /// Number of further values that the input may hold.
    left: usize,
}

impl<'b> Unpacker<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> io::Result<Self> {
        let left = (bytes.len() + 1).saturating_mul(MAX_NUMBERS_PER_BYTE);
        Ok(Self { decoder: zstd::Decoder::with_buffer(bytes)?, left })
    }

    pub(super) fn bytes(&mut self, count: usize) -> io::Result<Vec<u8>> {
        self.charge(count)?;
        let mut bytes = vec![0; count];
        self.decoder.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    fn charge(&mut self, count: usize) -> io::Result<()> {
        let left = self.left.checked_sub(count).ok_or(io::ErrorKind::InvalidData)?;
        self.left = left;
        Ok(())
    }

    /// Reads a stream of `count` numbers of type `u32` or `u64`.
    pub(super) fn numbers<N>(&mut self, count: usize) -> io::Result<Vec<N>>
    where
        N: Copy + From<u8> + BitOrAssign + Shl<usize, Output = N>,
    {
        let planes = usize::from(self.bytes(1)?[0]);
        if planes > size_of::<N>() {
            return Err(io::ErrorKind::InvalidData.into());
        }
        if planes == 0 {
            self.charge(count)?;
            return Ok(vec![N::from(0); count]);
        }
        let mut numbers: Vec<N> = self.bytes(count)?.into_iter().map(N::from).collect();
        for plane in 1..planes {
            let bytes = self.bytes(count)?;
            let parts = numbers.iter_mut().zip(bytes);
            parts.for_each(|(number, byte)| *number |= N::from(byte) << (8 * plane));
        }
        Ok(numbers)
    }

    pub(super) fn signed(&mut self, count: usize) -> io::Result<Vec<i32>> {
        let unfold = |n: u32| unzigzag(n.into()) as i32;
        Ok(self.numbers(count)?.into_iter().map(unfold).collect())
    }

    /// Reads the bytes that encode this many numbers.
    pub(super) fn encoded(&mut self, numbers: usize) -> io::Result<Vec<u8>> {
        let length = self.numbers::<u32>(1)?[0] as usize;
        self.charge(numbers)?;
        self.bytes(length)
    }

    /// Returns true if all data has been read.
    pub(super) fn is_at_end(&mut self) -> io::Result<bool> {
        Ok(self.decoder.read(&mut [0])? == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        let numbers = [0, 1, 255, 256, u32::MAX, 70_000];
        let wide = [1, u64::MAX, 1 << 40];
        let signed = [0, -1, i32::MIN, i32::MAX, 300, -300];
        let mut packer = Packer::new().unwrap();
        packer.numbers::<u32>(&numbers).unwrap();
        packer.signed(signed.into_iter()).unwrap();
        packer.numbers(&[0u32; 3]).unwrap();
        packer.numbers(&wide).unwrap();
        packer.bytes(b"end").unwrap();
        let bytes = packer.finish().unwrap();
        let mut unpacker = Unpacker::new(&bytes).unwrap();
        assert_eq!(unpacker.numbers::<u32>(6).unwrap(), numbers);
        assert_eq!(unpacker.signed(6).unwrap(), signed);
        assert_eq!(unpacker.numbers::<u32>(3).unwrap(), [0; 3]);
        assert_eq!(unpacker.numbers::<u64>(3).unwrap(), wide);
        assert_eq!(unpacker.bytes(3).unwrap(), b"end");
        assert!(unpacker.is_at_end().unwrap());
        assert!(unpacker.bytes(1).is_err());
    }

    #[test]
    fn what_is_cut_off_is_an_error() {
        let mut packer = Packer::new().unwrap();
        packer.numbers(&(0..1000).map(|i| i * i).collect::<Vec<u32>>()).unwrap();
        let bytes = packer.finish().unwrap();
        for end in 0..bytes.len() {
            let read = Unpacker::new(&bytes[..end]).and_then(|mut u| {
                u.numbers::<u32>(1000)?;
                u.is_at_end()
            });
            assert!(read.is_err() || end + 3 >= bytes.len(), "{end} of {}", bytes.len());
        }
    }
}
