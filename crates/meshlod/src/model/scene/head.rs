//! First resource of a scene: its skeleton, and the tables by which a level is taken apart.

use meshlod_io::gltf::Skeleton;

use super::parts::PartKind;
use crate::model::PoseCounts;

/// Tables and skeleton of the scene of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Head {
    /// Skeleton without the key frames of animations, which are a part of their own.
    pub skeleton: Skeleton,
    /// One entry for each mesh of the scene; `None` for a mesh that is not in the levels.
    pub meshes: Vec<Option<MeshEntry>>,
    /// Material and ordinal of each material label of the levels. Faces of a further label have no
    /// material.
    pub slots: Vec<Slot>,
    /// Number of images of the scene.
    pub images: u32,
    /// Parts in the order of the file.
    pub parts: Vec<PartKind>,
    /// Poses in which the errors of the levels were measured.
    pub poses: Option<PoseCounts>,
}

/// Mesh that is in the levels.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MeshEntry {
    /// Column-major matrix from the mesh's own space to that of the levels.
    pub placement: [[f64; 4]; 4],
    /// True if that is its place under the only node that shows it.
    pub is_only: bool,
    /// Number of the objects that the mesh itself has; `None` if it is one object.
    pub objects: Option<u32>,
    /// Attribute layers that the mesh has, by index into those of the levels, and their widths.
    pub layers: Vec<[u32; 2]>,
}

/// Material label of the levels: a material, and the number of earlier labels of the same mesh
/// with that material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Slot {
    pub material: Option<u32>,
    pub ordinal: u32,
}

/// No material.
const NONE: u32 = u32::MAX;
/// Flag of a head with numbers of poses.
const POSED: u8 = 2;

impl Head {
    pub fn to_bytes(&self) -> Vec<u8> {
        let kind = u8::from(self.skeleton.is_gltf) | if self.poses.is_some() { POSED } else { 0 };
        let mut to = vec![kind];
        if let Some(PoseCounts { measured, animations }) = self.poses {
            put(&mut to, &[measured, animations]);
        }
        put(&mut to, &[self.meshes.len() as u32]);
        for mesh in &self.meshes {
            to.push(mesh.is_some().into());
            let Some(mesh) = mesh else { continue };
            to.extend(mesh.placement.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
            to.push(mesh.is_only.into());
            put(&mut to, &[mesh.objects.map_or(0, |count| count + 1), mesh.layers.len() as u32]);
            put(&mut to, mesh.layers.as_flattened());
        }
        put(&mut to, &[self.slots.len() as u32]);
        for Slot { material, ordinal } in &self.slots {
            put(&mut to, &[material.unwrap_or(NONE), *ordinal]);
        }
        put(&mut to, &[self.images, self.parts.len() as u32]);
        for part in &self.parts {
            let (code, image) = match *part {
                PartKind::Animations => (0, 0),
                PartKind::Preview(image) => (1, image),
                PartKind::Image(image) => (2, image),
            };
            put(&mut to, &[code, image]);
        }
        put(&mut to, &[self.skeleton.document.len() as u32]);
        to.extend(&self.skeleton.document);
        to.extend(&self.skeleton.buffer);
        to
    }

    /// Decodes what [`Head::to_bytes`] encoded; `None` if it is damaged.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut input = Input(bytes);
        let kind = input.byte()?;
        let is_gltf = kind & 1 != 0;
        let poses = match kind {
            0 | 1 => None,
            2 | 3 => Some(PoseCounts { measured: input.number()?, animations: input.number()? }),
            _ => return None,
        };
        let meshes = input.list(1, Input::mesh)?;
        let slots = input.list(8, |input| {
            let material = Some(input.number()?).filter(|&material| material != NONE);
            Some(Slot { material, ordinal: input.number()? })
        })?;
        let images = input.number()?;
        let parts = input.list(8, |input| match (input.number()?, input.number()?) {
            (0, 0) => Some(PartKind::Animations),
            (1, image) if image < images => Some(PartKind::Preview(image)),
            (2, image) if image < images => Some(PartKind::Image(image)),
            _ => None,
        })?;
        let length = input.number()?;
        let document = input.take(length as usize)?.to_vec();
        if images as usize > document.len() {
            // The document has an entry for each image.
            return None;
        }
        let emptied = meshes.iter().map(Option::is_some).collect();
        let buffer = input.0.to_vec();
        let skeleton = Skeleton { document, buffer, animations: Vec::new(), is_gltf, emptied };
        Some(Self { skeleton, meshes, slots, images, parts, poses })
    }
}

fn put(to: &mut Vec<u8>, numbers: &[u32]) {
    to.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

/// Bytes still to be decoded.
struct Input<'b>(&'b [u8]);

impl<'b> Input<'b> {
    fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|byte| byte[0])
    }

    fn flag(&mut self) -> Option<bool> {
        match self.byte()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }

    fn number(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    /// Decodes a number of elements, each of at least `least` bytes, and then these.
    fn list<T>(
        &mut self,
        least: usize,
        element: impl Fn(&mut Self) -> Option<T>,
    ) -> Option<Vec<T>> {
        let count = self.number()? as usize;
        if count.checked_mul(least)? > self.0.len() {
            return None;
        }
        (0..count).map(|_| element(self)).collect()
    }

    fn mesh(&mut self) -> Option<Option<MeshEntry>> {
        if !self.flag()? {
            return Some(None);
        }
        let mut placement = [[0.0; 4]; 4];
        for x in placement.as_flattened_mut() {
            let bytes = self.take(8)?.try_into().ok()?;
            *x = Some(f64::from_le_bytes(bytes)).filter(|x| x.is_finite())?;
        }
        let is_only = self.flag()?;
        let objects = self.number()?.checked_sub(1);
        let layers = self.list(8, |input| Some([input.number()?, input.number()?]))?;
        Some(Some(MeshEntry { placement, is_only, objects, layers }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> Head {
        let document = b"any bytes".to_vec();
        let emptied = vec![true, false, true];
        let skeleton = Skeleton {
            document,
            buffer: vec![1, 2, 3],
            is_gltf: true,
            emptied,
            ..Skeleton::default()
        };
        let placement = [[1.0, 0.0, -0.5, 0.0]; 4];
        let mesh = MeshEntry { placement, is_only: true, objects: Some(0), layers: vec![[2, 3]] };
        Head {
            skeleton,
            meshes: vec![Some(mesh.clone()), None, Some(MeshEntry { objects: None, ..mesh })],
            slots: vec![
                Slot { material: Some(1), ordinal: 0 },
                Slot { material: None, ordinal: 2 },
            ],
            images: 4,
            parts: vec![PartKind::Preview(3), PartKind::Animations, PartKind::Image(3)],
            poses: Some(PoseCounts { measured: 64, animations: 3 }),
        }
    }

    #[test]
    fn a_head_comes_back() {
        assert_eq!(Head::from_bytes(&head().to_bytes()), Some(head()));
        assert_eq!(Head::from_bytes(&Head::default().to_bytes()), Some(Head::default()));
        let unposed = Head { poses: None, ..head() };
        assert_eq!(Head::from_bytes(&unposed.to_bytes()), Some(unposed));
    }

    #[test]
    fn damaged_heads_are_refused_or_are_other_heads() {
        let bytes = head().to_bytes();
        let end = bytes.len() - 5;
        for length in 0..end {
            assert_eq!(Head::from_bytes(&bytes[..length]), None, "{length}");
        }
        let mut refused = 0;
        for (at, bit) in (0..end).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
            let mut wrong = bytes.clone();
            wrong[at] ^= 1 << bit;
            match Head::from_bytes(&wrong) {
                Some(other) => assert_eq!(other.to_bytes(), wrong, "bit {bit} of byte {at}"),
                None => refused += 1,
            }
        }
        assert!(refused > 100, "{refused}");
    }
}
