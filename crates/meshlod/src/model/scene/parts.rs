//! Order of the parts of a scene among the chunks of a file.

use meshlod_multires::Resource;

use super::image_versions::ImageVersion;

/// Part of a scene that is a resource of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PartKind {
    /// Key frames of the animations.
    Animations,
    /// Smaller version of the image of this number.
    Preview(u32),
    /// Image of this number.
    Image(u32),
}

/// Part of a scene with its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ScenePart {
    pub kind: PartKind,
    pub bytes: Vec<u8>,
    /// Longest side in texels.
    side: u32,
}

/// Images of at most this many texels a side come before all chunks.
const FIRST_SIDE: u32 = 16;
/// Animations come after images of at most this many texels a side.
const ANIMATION_SIDE: u32 = 64;

/// Sorts the versions of all images and the key frames: small images before larger ones, and
/// colours before other images of the same size.
pub(super) fn sort_parts(
    animations: Vec<u8>,
    images: Vec<Vec<ImageVersion>>,
    is_color: &[bool],
) -> Vec<ScenePart> {
    let mut parts = Vec::new();
    for (index, versions) in (0..).zip(images) {
        parts.extend(versions.into_iter().map(|ImageVersion { side, bytes, is_preview }| {
            let kind = if is_preview { PartKind::Preview(index) } else { PartKind::Image(index) };
            ScenePart { kind, bytes, side }
        }));
    }
    if !animations.is_empty() {
        let kind = PartKind::Animations;
        parts.push(ScenePart { kind, bytes: animations, side: ANIMATION_SIDE });
    }
    parts.sort_by_key(|part| {
        let last = match part.kind {
            PartKind::Preview(index) | PartKind::Image(index) => !is_color[index as usize],
            PartKind::Animations => true,
        };
        (part.side, last)
    });
    parts
}

/// Places parts between the chunks, given the bytes of each chunk, after the bytes that all of them
/// need: the smallest images first, and then half of the bytes for parts and half for chunks, so
/// that a truncated file has textures as fine as its surface.
pub(super) fn interleave(head: Vec<u8>, parts: &[ScenePart], chunks: &[u64]) -> Vec<Resource> {
    let mut resources = vec![Resource { after_chunks: 0, bytes: head }];
    let (mut after, mut of_chunks, mut of_parts) = (0, 0, 0);
    for part in parts {
        if part.side > FIRST_SIDE {
            of_parts += part.bytes.len() as u64;
        }
        while after < chunks.len() && of_chunks < of_parts {
            of_chunks += chunks[after];
            after += 1;
        }
        resources.push(Resource { after_chunks: after, bytes: part.bytes.clone() });
    }
    resources
}

#[cfg(test)]
mod tests {
    use super::*;

    fn version(side: u32, length: usize) -> ImageVersion {
        ImageVersion { side, bytes: vec![side as u8; length], is_preview: side < 512 }
    }

    #[test]
    fn small_images_come_first_and_colours_before_data() {
        let images =
            vec![vec![version(8, 9), version(512, 90)], vec![version(8, 9), version(512, 40)]];
        let parts = sort_parts(vec![1, 2], images, &[false, true]);
        let kinds: Vec<PartKind> = parts.iter().map(|part| part.kind).collect();
        use PartKind::{Animations, Image, Preview};
        assert_eq!(kinds, [Preview(1), Preview(0), Animations, Image(1), Image(0)]);
        let after = |chunks: &[u64]| {
            let all = interleave(vec![7], &parts, chunks);
            all.iter().map(|resource| resource.after_chunks).collect::<Vec<_>>()
        };
        assert_eq!(after(&[20; 5]), [0, 0, 0, 1, 3, 5]);
        assert_eq!(after(&[]), [0; 6]);
    }
}
