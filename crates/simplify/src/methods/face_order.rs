//! Priority of face constriction by the size, sharpness and resulting valence of a face.

use meshlod_mesh::FaceId;

use crate::engine::policy::Priority;
use crate::methods::creases::Creases;
use crate::surface::Surface;
use crate::surface::contracted::{Contracted, Freedom};

/// wb: weight of turns against balance. Mean error of horse-97k at 10 % and 1 %, by [LJ05]: 0.5
/// .0230, .146; 0.7 .0223, .149; 0.8 .0216, .167; 0.9 .0217, .183; 0.95 .0230, .207.
const TURN_WEIGHT: f64 = 0.8;

/// Cost √area · (wb · turn + (1 − wb) · balance), both terms between 0 and 1 (eqs. 1 and 7 of
/// [LJ05]). [LJ05] and [Wu01] differ in the weights of vertices in the turn.
pub(crate) struct FaceOrder {
    /// Greatest valence that a contraction of the input would produce.
    most_valence: f64,
}

impl FaceOrder {
    pub(crate) fn new(surface: &Surface) -> Self {
        let faces = (0..surface.face_count()).map(FaceId::new).filter(|&f| surface.is_alive(f));
        let valences = faces.map(|f| valence_after(surface, &Contracted::face(surface.face(f))));
        Self { most_valence: valences.fold(1.0, f64::max) }
    }
}

impl Priority<Creases> for FaceOrder {
    #[inline]
    fn cost(
        &self,
        surface: &Surface,
        memory: &Creases,
        of: &Contracted,
        _: Freedom,
    ) -> Option<f64> {
        let turn = memory.turn(surface, of) / 2.0;
        let balance = (valence_after(surface, of) / self.most_valence).min(1.0);
        let measure = TURN_WEIGHT * turn + (1.0 - TURN_WEIGHT) * balance;
        Some(size(surface, of).sqrt() * measure)
    }
}

/// Returns the valence of the new vertex (eq. 4).
#[inline]
fn valence_after(surface: &Surface, of: &Contracted) -> f64 {
    let sum = of.iter().map(|&v| surface.valence(v) as f64).sum::<f64>();
    let lost = if of.len() == 2 { 4.0 } else { 9.0 };
    (sum - lost).max(0.0)
}

/// Returns the area of a face, or of the equilateral triangle on an edge.
#[inline]
fn size(surface: &Surface, of: &Contracted) -> f64 {
    let [a, b] = [of[0], of[1]].map(|v| surface.position(v));
    match of.get(2) {
        Some(&c) => 0.5 * (b - a).cross(surface.position(c) - a).length(),
        None => 0.25 * 3f64.sqrt() * a.distance_squared(b),
    }
}
