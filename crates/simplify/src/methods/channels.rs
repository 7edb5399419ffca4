//! The attributes that count in quadrics, as numbers in model units.
//!
//! A channel is one number of a layer, times a length: so that attributes can be weighed against
//! distances, whatever the size of the model and of its textures. For normals and colours the length
//! is the diagonal; for uvs it is that of a unit of uv on the model, on average, so that an error
//! there is how far the texture slides.

use glam::DVec3;
use meshlod_mesh::{FaceId, Layer, LayerKind, WedgeId};

use crate::options::AttributeWeights;
use crate::surface::Surface;
use crate::surface::wedges::Wedges;

/// A layer that counts.
struct Counted {
    layer: usize,
    /// Of its values; what comes after, as alpha does, does not count.
    width: usize,
    scale: f64,
}

/// Which numbers of a wedge count, and how much.
pub(crate) struct Channels {
    counted: Vec<Counted>,
}

impl Channels {
    /// The channels of a surface; none if it has no layer that counts.
    pub(crate) fn new(surface: &Surface, weights: &AttributeWeights) -> Option<Self> {
        let wedges = surface.wedges.as_ref()?;
        let diagonal = diagonal(surface);
        let counted = wedges.layers().iter().enumerate().filter_map(|(i, layer)| {
            let (width, scale) = match layer.kind {
                LayerKind::Normal => (3, weights.normal * diagonal),
                LayerKind::Color(_) => (3, weights.color * diagonal),
                LayerKind::Uv(_) if weights.uv > 0.0 => {
                    (2, weights.uv * length_of_uv(surface, wedges, layer))
                }
                _ => return None,
            };
            let counts = scale > 0.0 && scale.is_finite() && layer.width >= width;
            counts.then_some(Counted { layer: i, width, scale })
        });
        let counted: Vec<_> = counted.collect();
        (!counted.is_empty()).then_some(Self { counted })
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.counted.iter().map(|counted| counted.width).sum()
    }

    /// A wedge's values in all channels, in model units. What is no number counts as zero.
    pub(crate) fn values<'a>(
        &'a self,
        wedges: &'a Wedges,
        wedge: WedgeId,
    ) -> impl Iterator<Item = f64> + 'a {
        self.counted.iter().flat_map(move |counted| {
            let values = wedges.layers()[counted.layer].of(wedge)[..counted.width].iter();
            values.map(|&x| if x.is_finite() { f64::from(x) * counted.scale } else { 0.0 })
        })
    }
}

fn live_faces(surface: &Surface) -> impl Iterator<Item = FaceId> + '_ {
    (0..surface.face_count()).map(FaceId::new).filter(|&face| surface.is_alive(face))
}

fn diagonal(surface: &Surface) -> f64 {
    let corners = || live_faces(surface).flat_map(|f| surface.face(f)).map(|v| surface.position(v));
    let low = corners().fold(DVec3::INFINITY, DVec3::min);
    let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
    low.distance(high)
}

/// The length of a unit of uv on the surface: the root of its area by that of its texture.
fn length_of_uv(surface: &Surface, wedges: &Wedges, layer: &Layer) -> f64 {
    let (mut area, mut in_texture) = (0.0, 0.0);
    for face in live_faces(surface) {
        let uv = |w: WedgeId| DVec3::from([layer.of(w)[0].into(), layer.of(w)[1].into(), 0.0]);
        let [a, b, c] = wedges.of(face).map(uv);
        area += surface.area_normal(face).length();
        in_texture += (b - a).cross(c - a).length();
    }
    (area / in_texture).sqrt()
}
