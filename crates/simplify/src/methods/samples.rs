//! Samples of the input surface, each attached to the face that represents it now.
//!
//! Samples are stored in one array and linked by face. A sample on a rim, that is a boundary edge
//! or a seam, stays on rims; this preserves outlines and the borders of textures.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Side, Twin, VertexId};

use crate::engine::policy::Memory;
use crate::methods::fan::{Fan, Rim};
use crate::surface::feature_edges::is_feature;
use crate::surface::neighbourhood::{Neighbourhood, Spoke};
use crate::surface::{Placed, Surface};

/// Scattered samples per face of the input, in addition to one per vertex and one in the middle of
/// each rim edge.
const PER_FACE: f64 = 0.5;

/// Sample of the input surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) point: DVec3,
    /// Squared distance from the sample to its projection on the current surface.
    pub(crate) squared: f64,
    /// Side of its face that it must stay on, if it is on a rim.
    side: Option<u8>,
    /// Next sample on the same face.
    next: u32,
}

impl Sample {
    /// Returns true if the sample must stay on a boundary or seam.
    #[inline]
    pub(crate) fn on_rim(&self) -> bool {
        self.side.is_some()
    }
}

/// All samples of the input surface, linked by the faces that represent them.
pub(crate) struct Samples {
    samples: Vec<Sample>,
    /// First sample of each face.
    first: Vec<u32>,
    /// One bit per side of each face, set for rims.
    rims: Vec<u8>,
    /// Scratch space for the samples of a contraction.
    moving: Vec<u32>,
    fan: Fan,
}

/// End of a list.
const NONE: u32 = u32::MAX;

impl Samples {
    pub(crate) fn new(surface: &Surface, connectivity: &Connectivity) -> Self {
        let alive = || (0..surface.face_count()).map(FaceId::new).filter(|&f| surface.is_alive(f));
        let mut this = Self {
            samples: Vec::new(),
            first: vec![NONE; surface.face_count()],
            rims: vec![0; surface.face_count()],
            moving: Vec::new(),
            fan: Fan::default(),
        };
        for face in alive() {
            this.add_rims(surface, connectivity, face);
        }
        let mut held = vec![false; surface.vertex_count()];
        // Rims first, so that vertices on rims become rim samples.
        for on_rim in [true, false] {
            alive().for_each(|face| this.add_vertices(surface, face, on_rim, &mut held));
        }
        let total: f64 = alive().map(|face| surface.area_normal(face).length()).sum();
        let (count, mut area) = (alive().count() as f64 * PER_FACE, 0.0);
        for face in alive() {
            let from = (area / total * count) as u32;
            area += surface.area_normal(face).length();
            for i in from..(area / total * count) as u32 {
                this.add(face, None, spread(surface, face, i));
            }
        }
        this
    }

    fn add_rims(&mut self, surface: &Surface, connectivity: &Connectivity, face: FaceId) {
        for k in 0..3 {
            let side = Side::new(face, k);
            let is_rim = match connectivity.twin(side) {
                Twin::Boundary => true,
                Twin::Side(twin) => is_feature(surface, side, twin),
                _ => false,
            };
            if is_rim {
                self.rims[face.index()] |= 1 << k;
                let [from, to] = [k, (k + 1) % 3].map(|c| surface.position(surface.face(face)[c]));
                self.add(face, Some(k as u8), from.midpoint(to));
            }
        }
    }

    fn add_vertices(&mut self, surface: &Surface, face: FaceId, on_rim: bool, held: &mut [bool]) {
        for (k, v) in surface.face(face).into_iter().enumerate() {
            let rim = self.rims[face.index()] >> k & 1 != 0;
            if !held[v.index()] && rim == on_rim {
                held[v.index()] = true;
                self.add(face, on_rim.then_some(k as u8), surface.position(v));
            }
        }
    }

    fn add(&mut self, face: FaceId, side: Option<u8>, point: DVec3) {
        let next = std::mem::replace(&mut self.first[face.index()], self.samples.len() as u32);
        self.samples.push(Sample { point, squared: 0.0, side, next });
    }

    fn of_face(&self, face: FaceId) -> impl Iterator<Item = u32> + '_ {
        let listed = |i: u32| (i != NONE).then_some(i);
        let first = listed(self.first[face.index()]);
        std::iter::successors(first, move |&i| listed(self.samples[i as usize].next))
    }

    /// Calls `each` for every sample that a contraction reassigns.
    pub(crate) fn moving(&self, neighbourhood: &Neighbourhood, mut each: impl FnMut(&Sample)) {
        self.moving_ids(neighbourhood, |i| each(&self.samples[i as usize]));
    }

    fn moving_ids(&self, neighbourhood: &Neighbourhood, mut each: impl FnMut(u32)) {
        for spoke in neighbourhood.spokes() {
            // Samples on the rim opposite the contracted corner stay there.
            let across = ((spoke.corner() + 1) % 3) as u8;
            self.of_face(spoke.face)
                .filter(|&i| self.samples[i as usize].side != Some(across))
                .for_each(&mut each);
        }
        for removed in neighbourhood.removed_faces() {
            self.of_face(removed.face).for_each(&mut each);
        }
    }

    /// Returns the rim sides of a face, one bit each.
    #[inline]
    fn rims(&self, face: FaceId) -> u8 {
        self.rims[face.index()]
    }

    /// Builds the fan of faces that a contraction would make.
    pub(crate) fn fan(
        &self,
        surface: &Surface,
        neighbourhood: &Neighbourhood,
        origin: DVec3,
        fan: &mut Fan,
    ) {
        fan.clear();
        let ring = |place: u32| neighbourhood.ring()[place as usize].position - origin;
        for spoke in neighbourhood.spokes() {
            fan.add_spoke([ring(spoke.a), ring(spoke.b)]);
        }
        let mut on_rim = |place: u32| {
            let leads = |spoke: &Spoke| spoke.a == place || spoke.b == place;
            let Some(spoke) = neighbourhood.spokes().iter().position(leads) else { return };
            if fan.rims().iter().all(|rim| rim.place != place) {
                fan.add_rim(Rim { place, end: ring(place), spoke: spoke as u32 });
            }
        };
        for spoke in neighbourhood.spokes() {
            let rims = self.rims(spoke.face);
            if rims != 0 {
                let is_rim = |side: usize| rims >> (side % 3) & 1 != 0;
                if is_rim(spoke.corner()) {
                    on_rim(spoke.a);
                }
                if is_rim(spoke.corner() + 2) {
                    on_rim(spoke.b);
                }
            }
        }
        for removed in
            neighbourhood.removed_faces().iter().filter(|removed| self.rims(removed.face) != 0)
        {
            let Some(apex) = removed.apex() else { continue };
            let corner = surface.corner(removed.face, neighbourhood.ring()[apex].id);
            let at_apex = 1 << corner | 1 << ((corner + 2) % 3);
            if self.rims(removed.face) & at_apex != 0 {
                on_rim(apex as u32);
            }
        }
    }
}

impl Memory for Samples {
    const KNOWS_RING: bool = true;

    fn merge(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let (mut fan, mut moving) =
            (std::mem::take(&mut self.fan), std::mem::take(&mut self.moving));
        let origin = placed.position;
        self.fan(surface, neighbourhood, origin, &mut fan);
        fan.place(DVec3::ZERO);
        moving.clear();
        self.moving_ids(neighbourhood, |i| moving.push(i));
        self.unlink(neighbourhood);
        for &i in &moving {
            let sample = self.samples[i as usize];
            let found = fan.nearest(sample.point - origin, sample.on_rim());
            let spoke = &neighbourhood.spokes()[found.spoke];
            let side = found.rim.map(|rim| {
                let first = fan.rims()[rim].place == spoke.a;
                (if first { spoke.corner() } else { (spoke.corner() + 2) % 3 }) as u8
            });
            let first = &mut self.first[spoke.face.index()];
            let next = std::mem::replace(first, i);
            self.samples[i as usize] = Sample { squared: found.squared, side, next, ..sample };
        }
        (self.fan, self.moving) = (fan, moving);
        self.mark_rims(neighbourhood);
    }
}

impl Samples {
    /// Unlinks the moving samples from the faces around.
    fn unlink(&mut self, neighbourhood: &Neighbourhood) {
        for removed in neighbourhood.removed_faces() {
            self.first[removed.face.index()] = NONE;
        }
        for spoke in neighbourhood.spokes() {
            let across = ((spoke.corner() + 1) % 3) as u8;
            let mut next = std::mem::replace(&mut self.first[spoke.face.index()], NONE);
            while next != NONE {
                let i = next;
                next = self.samples[i as usize].next;
                if self.samples[i as usize].side == Some(across) {
                    let first = std::mem::replace(&mut self.first[spoke.face.index()], i);
                    self.samples[i as usize].next = first;
                }
            }
        }
    }

    /// Marks the rim sides of the new faces; `fan` must be of this contraction.
    fn mark_rims(&mut self, neighbourhood: &Neighbourhood) {
        let fan = std::mem::take(&mut self.fan);
        for rim in fan.rims() {
            for spoke in neighbourhood.spokes() {
                if spoke.a == rim.place {
                    self.rims[spoke.face.index()] |= 1 << spoke.corner();
                }
                if spoke.b == rim.place {
                    self.rims[spoke.face.index()] |= 1 << ((spoke.corner() + 2) % 3);
                }
            }
        }
        self.fan = fan;
    }
}

/// Returns point `i` of a sequence that fills any triangle evenly.
///
/// # References
/// [Rob18], the sequence of the plastic number, folded into the triangle.
fn spread(surface: &Surface, face: FaceId, i: u32) -> DVec3 {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let [mut s, mut t] = STEPS.map(|step| (0.5 + f64::from(i) * step).fract());
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    let [a, b, c] = surface.face(face).map(|v: VertexId| surface.position(v));
    a + (b - a) * s + (c - a) * t
}
