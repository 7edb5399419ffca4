//! Sample fish with its colours in a texture, as models of games have them.

use meshlod::flock::levels::Look;
use meshlod::mesh::{Attributes, LayerKind, VertexId, WedgeId};
use meshlod::picture::{
    Antialiasing, Background, Camera, Lighting, Materials, Paint, PaintMaterial, PictureError,
    Style, Texture, render,
};
use meshlod::{Mesh, samples};

/// Faces of the fish, as in the paper.
const FACES: usize = 4_000;

/// Faces of the fish that the texture is taken from.
const PAINTED_FACES: usize = 400_000;

/// Side of the texture in texels.
const SIDE: u32 = 1024;

/// Texels by which the charts of the texture are widened, so that its mipmaps stay clean.
const BLEED: usize = 16;

/// Returns the sample fish and its texture.
pub fn textured_fish() -> Result<(Mesh, Look), PictureError> {
    let mut fish = samples::fish(FACES);
    if let Some(attributes) = &mut fish.attributes {
        attributes.layers.retain(|layer| !matches!(layer.kind, LayerKind::Color(_)));
    }
    let texture = painted(&samples::fish(PAINTED_FACES))?;
    let material = PaintMaterial { base_color: [1.0; 3], texture: Some(0) };
    let materials = Materials { materials: vec![material], textures: vec![texture] };
    Ok((fish, Look { materials: Some(materials) }))
}

/// Draws the vertex colours of a mesh over its texture coordinates, in which no faces overlap.
fn painted(mesh: &Mesh) -> Result<Texture, PictureError> {
    const DISTANCE: f64 = 10.0;
    let flat = unfolded(mesh);
    let fov = 2.0 * (0.5 / DISTANCE).atan();
    let camera = Camera::look_at([0.5, 0.5, DISTANCE], [0.5, 0.5, 0.0], [0.0, 1.0, 0.0], fov);
    let style = Style {
        size: [SIDE; 2],
        paint: Paint::Colors,
        lighting: Lighting::Unlit,
        background: Background::Transparent,
        antialiasing: Antialiasing::Four,
        ..Style::default()
    };
    let picture = render(&flat, &camera, &style)?;
    let mut texels: Vec<[u8; 4]> =
        picture.rgba().chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect();
    for _ in 0..BLEED {
        widen(&mut texels, SIDE as usize);
    }
    Texture::new(SIDE, SIDE, texels.as_flattened())
}

/// Returns a mesh of the texture coordinates, with the vertex colours.
fn unfolded(mesh: &Mesh) -> Mesh {
    let Some(attributes) = &mesh.attributes else { return Mesh::default() };
    let layer = |kind| attributes.layer(kind);
    let (Some(uv), Some(colors)) = (layer(LayerKind::Uv(0)), layer(LayerKind::Color(0))) else {
        return Mesh::default();
    };
    let place = |wedge: usize| {
        let [u, v] = [0, 1].map(|axis| f64::from(uv.of(WedgeId(wedge as u32))[axis]));
        [u, v, 0.0]
    };
    let positions = (0..attributes.wedge_count).map(place).collect();
    let faces = attributes.corners.iter().map(|face| face.map(|w| VertexId(w.0))).collect();
    let attributes = Attributes { layers: vec![colors.clone()], ..attributes.clone() };
    Mesh { attributes: Some(attributes), ..Mesh::new(positions, faces) }
}

/// Gives every empty texel the colour of a neighbour that is not.
fn widen(texels: &mut [[u8; 4]], side: usize) {
    let before = texels.to_vec();
    for (i, texel) in texels.iter_mut().enumerate().filter(|(_, texel)| texel[3] == 0) {
        let (x, y) = (i % side, i / side);
        let neighbours = [
            (x > 0).then(|| i - 1),
            (x + 1 < side).then_some(i + 1),
            (y > 0).then(|| i - side),
            (y + 1 < side).then_some(i + side),
        ];
        let filled = |&at: &usize| before[at][3] != 0;
        if let Some(at) = neighbours.into_iter().flatten().find(filled) {
            *texel = before[at];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texture_fills_the_charts() {
        let flat = unfolded(&samples::fish(2_000));
        flat.validate().unwrap();
        assert!(flat.bounds().max[0] <= 1.0 && flat.bounds().min[1] >= 0.0);
        let mut texels = vec![[0; 4]; 9];
        texels[4] = [9, 8, 7, 255];
        widen(&mut texels, 3);
        assert_eq!(texels.iter().filter(|texel| texel[3] > 0).count(), 5);
    }
}
