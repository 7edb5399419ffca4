//! Decoded images of a model, kept for the tiles that come next.

use std::fs;
use std::hash::Hash;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use meshlod_io::Image;
use meshlod_picture::{Averaging, Texture};
use rustc_hash::FxHashMap;

use crate::error::TilesError;

/// Bytes of decoded images that are kept, unless tiles that are being made need more at once: nine of
/// the largest.
const MOST_BYTES: usize = 3 << 28;

/// Bytes of encoded images that are kept.
const MOST_ENCODED_BYTES: usize = 1 << 28;

/// Images that were decoded or encoded for tiles; belongs to the images of one model. Copies share
/// what they keep.
#[derive(Clone, Debug, Default)]
pub struct DecodedImages {
    decoded: Kept<DecodedKey, Option<Arc<Texture>>>,
    encoded: Kept<EncodedKey, Arc<Image>>,
    files: Option<Arc<ImageFiles>>,
}

/// Files of images, which are read when they are needed.
#[derive(Debug)]
struct ImageFiles {
    /// Path and checksum of each.
    all: Vec<(PathBuf, u32)>,
    /// File that could not be read, or is not as it was written, and the reason.
    failed: Mutex<Option<(PathBuf, String)>>,
}

/// Image, and whether its texels are colours.
type DecodedKey = (usize, bool);

/// Image, its role, and how often it is halved.
pub(super) type EncodedKey = (usize, Role, u32);

/// Use of an image by a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Role {
    /// Colours.
    Color,
    /// Colours and opacity.
    ColorAndOpacity,
    /// Normals, roughness or metalness.
    Values,
}

impl ImageFiles {
    /// Reads an image; `None` if that fails, which is remembered.
    fn read(&self, image: usize) -> Option<Vec<u8>> {
        let (path, checksum) = self.all.get(image)?;
        let reason = match fs::read(path) {
            Ok(bytes) if crc32fast::hash(&bytes) == *checksum => return Some(bytes),
            Ok(_) => "is cut off or changed".to_owned(),
            Err(error) => error.to_string(),
        };
        *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some((path.clone(), reason));
        None
    }
}

impl DecodedImages {
    /// Creates images that are read from files with these checksums when they are needed.
    pub(crate) fn of_files(all: Vec<(PathBuf, u32)>) -> Self {
        let files = Some(Arc::new(ImageFiles { all, failed: Mutex::default() }));
        Self { files, ..Self::default() }
    }

    /// Fails if a file could not be read, or is not as it was written: no tile may be made then.
    ///
    /// # Errors
    /// The file and the reason.
    pub(crate) fn check(&self) -> Result<(), TilesError> {
        let Some(files) = &self.files else { return Ok(()) };
        match &*files.failed.lock().unwrap_or_else(PoisonError::into_inner) {
            Some((path, reason)) => Err(TilesError::damaged(path, reason)),
            None => Ok(()),
        }
    }

    /// Returns an image as a texture; `None` if it is missing or damaged.
    pub(super) fn texture(
        &self,
        images: &[Image],
        image: usize,
        role: Role,
    ) -> Option<Arc<Texture>> {
        let is_color = role != Role::Values;
        let averaging = if is_color { Averaging::Light } else { Averaging::Values };
        let decode = || {
            let texture = match &self.files {
                Some(files) => Texture::decode_averaged(&files.read(image)?, averaging),
                None => Texture::decode_averaged(&images.get(image)?.bytes, averaging),
            };
            let texture = texture.ok()?;
            Some(Arc::new(texture))
        };
        let bytes = |texture: &Option<Arc<Texture>>| {
            let levels = texture.iter().flat_map(|texture| texture.levels());
            levels.map(|(_, _, texels)| size_of_val(texels)).sum()
        };
        self.decoded.get((image, is_color), MOST_BYTES, decode, bytes)
    }

    /// Returns an image that many tiles have alike, encoded by the first that asks.
    pub(super) fn encoded(&self, key: EncodedKey, encode: impl FnOnce() -> Image) -> Arc<Image> {
        let encode = || Arc::new(encode());
        self.encoded.get(key, MOST_ENCODED_BYTES, encode, |image| image.bytes.len())
    }
}

/// Values that are made once, of which the last used ones are kept.
#[derive(Debug)]
struct Kept<K, V>(Arc<Mutex<Decodings<K, V>>>);

#[derive(Debug)]
struct Decodings<K, V> {
    of: FxHashMap<K, Slot<V>>,
    /// Number of uses so far.
    uses: u64,
}

#[derive(Debug)]
struct Slot<V> {
    value: Arc<OnceLock<V>>,
    last_use: u64,
    bytes: usize,
}

impl<K, V> Clone for Kept<K, V> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Self(Arc::new(Mutex::new(Decodings { of: FxHashMap::default(), uses: 0 })))
    }
}

impl<K: Copy + Eq + Hash, V: Clone> Kept<K, V> {
    /// Returns a value, made unless it is kept; threads that want it meanwhile wait. Forgets others
    /// that were not used for longest until the rest takes at most `most` bytes.
    fn get(&self, key: K, most: usize, make: impl FnOnce() -> V, bytes: impl Fn(&V) -> usize) -> V {
        // The lock is not held while a value is made.
        let value = self.slots(|slots| slots.slot(key).value.clone());
        let value = value.get_or_init(make).clone();
        self.slots(|slots| {
            slots.slot(key).bytes = bytes(&value);
            slots.forget_down_to(most);
        });
        value
    }

    fn slots<T>(&self, work: impl FnOnce(&mut Decodings<K, V>) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl<K: Copy + Eq + Hash, V> Decodings<K, V> {
    /// Returns the slot of a value, as the last used one.
    fn slot(&mut self, key: K) -> &mut Slot<V> {
        self.uses += 1;
        let new = || Slot { value: Arc::default(), last_use: 0, bytes: 0 };
        let slot = self.of.entry(key).or_insert_with(new);
        slot.last_use = self.uses;
        slot
    }

    fn forget_down_to(&mut self, most: usize) {
        while self.of.len() > 1 && self.of.values().map(|slot| slot.bytes).sum::<usize>() > most {
            let oldest = self.of.iter().min_by_key(|(_, slot)| slot.last_use);
            let Some((&key, _)) = oldest else { return };
            self.of.remove(&key);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn values_are_made_once_until_they_are_forgotten() {
        let made = Cell::new(0);
        let kept = Kept::default();
        let make = |key: usize| {
            let make = || {
                made.set(made.get() + 1);
                10 * key
            };
            kept.get(key, 2, make, |_| 1)
        };
        assert_eq!([1, 2, 1].map(make), [10, 20, 10]);
        assert_eq!(made.get(), 2);
        // The third pushes out the 2, which was not used for longest.
        assert_eq!([3, 1, 2].map(make), [30, 10, 20]);
        assert_eq!(made.get(), 4);
    }

    #[test]
    fn what_is_no_image_has_no_texture() {
        let image = |bytes: &[u8]| Image { name: String::new(), bytes: bytes.to_vec() };
        let images = [image(&[]), image(b"no image")];
        for index in 0..3 {
            assert!(DecodedImages::default().texture(&images, index, Role::Color).is_none());
        }
    }

    #[test]
    fn images_in_files_are_read_when_they_are_needed() {
        let folder = tempfile::tempdir().unwrap();
        let png = meshlod_picture::Picture::new(1, 1, vec![9; 4]).unwrap().png();
        let path = folder.path().join("image-0");
        let decoded = || DecodedImages::of_files(vec![(path.clone(), crc32fast::hash(&png)); 2]);
        let early = decoded();
        fs::write(&path, &png).unwrap();
        assert!(early.texture(&[], 1, Role::Color).is_some() && early.check().is_ok());
        fs::write(&path, &png[1..]).unwrap();
        // It is kept.
        assert!(early.texture(&[], 1, Role::Color).is_some());
        let late = decoded();
        assert!(late.texture(&[], 1, Role::Color).is_none());
        assert!(late.check().unwrap_err().to_string().contains("image-0: is cut off or changed"));
    }
}
