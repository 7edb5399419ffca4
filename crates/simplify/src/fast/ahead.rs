//! What a contraction would make of attributes, found before it is decided; and whether a face turns
//! over in its texture.
//!
//! A face that is left shall have the same sign of its area in uv as before, or next to no area there.
//! Else what the texture shows would be there twice, once the wrong way round.

use glam::Vec4;

use crate::fast::around::Slots;
use crate::fast::carry::Scratch;
use crate::fast::hood::Hood;
use crate::fast::lanes::{LANES, Lanes3};
use crate::fast::looks::{Ends, Placed};
use crate::fast::painted::{Painted, is_seam};
use crate::fast::ring::Vertices;

/// The square of the area in the texture, as a part of that on the surface, that is none.
const FLAT: f32 = 1e-4;

impl<const K: usize> Painted<'_, K> {
    /// Whether anything around has a seam.
    #[inline(always)]
    pub(super) fn has_seam(&self, vertices: &Vertices, hood: &Hood, ends: Ends) -> bool {
        let any = |v: &u32| is_seam(vertices, *v);
        any(&ends.v0) || any(&ends.v1) || hood.ids().iter().any(any)
    }

    /// Where nothing around has a seam: slots are vertices. Whether a face turns over in its texture.
    #[inline(always)]
    pub(super) fn look_ahead_smooth(&mut self, hood: &Hood, placed: &Placed) -> bool {
        let Ends { v0, v1, .. } = placed.ends;
        self.scratch.values = self.values(placed, [v0, v1]);
        let (of_v0, of_v1) = (self.field(v0).values(), self.field(v1).values());
        let Self { fields, scratch, none, coat, .. } = self;
        for i in 0..=hood.len.next_multiple_of(LANES) {
            let id = hood.ids[if i < hood.len { i } else { 0 }];
            let field = fields.get(id as usize).unwrap_or(none);
            for (row, channel) in scratch.first.iter_mut().zip(&field.channels) {
                row[i] = channel.w;
            }
        }
        coat.uvs().any(|u| scratch.folds::<false>(hood, u, [&of_v0, &of_v1]))
    }

    /// The same where something has.
    pub(super) fn look_ahead_by_slots(
        &mut self,
        vertices: &Vertices,
        hood: &Hood,
        placed: &Placed,
    ) -> bool {
        let pairs = self.pairs(vertices, placed.ends);
        self.scratch.slots = Slots::new(&self.seams, vertices, hood, (placed.ends, pairs));
        self.find_values(placed, &pairs);
        let Self { fields, scratch, none, coat, .. } = self;
        for i in 0..hood.len {
            let of = |slot: u32| fields.get(slot as usize).unwrap_or(none).values();
            let [was, a, b] = scratch.slots.spokes[i].map(of);
            let apex = scratch.slots.apexes[i];
            let renewed = scratch.renewed.iter().find(|renewed| renewed.slot == apex);
            let now = renewed.map_or_else(|| of(apex), |renewed| renewed.values);
            for k in 0..K {
                scratch.first[k][i] = a[k];
                scratch.second[k][i] = b[k];
                scratch.before[k][i] = was[k];
                scratch.after[k][i] = now[k];
            }
        }
        coat.uvs().any(|u| scratch.folds::<true>(hood, u, [&[0.0; K]; 2]))
    }
}

impl<const K: usize> Scratch<K> {
    /// Whether more faces look the other way than most in the plane of two channels, from `u` on, than
    /// did before.
    #[inline(always)]
    fn folds<const SEAMS: bool>(&self, hood: &Hood, u: usize, ends: [&[f32; K]; 2]) -> bool {
        let (mut before, mut after) = (Ways::default(), Ways::default());
        let mut start = 0;
        while start < hood.len {
            let at = |row: &[f32], start: usize| Vec4::from_slice(&row[start..]);
            let row = |k: usize| {
                if SEAMS {
                    let apexes = [at(&self.before[k], start), at(&self.after[k], start)];
                    return (at(&self.first[k], start), at(&self.second[k], start), apexes);
                }
                let of_v1 = at(&hood.of_v1, start);
                let before = Vec4::splat(ends[0][k]) * (Vec4::ONE - of_v1) + of_v1 * ends[1][k];
                let apexes = [before, Vec4::splat(self.values[k])];
                (at(&self.first[k], start), at(&self.first[k], start + 1), apexes)
            };
            let ((ax, bx, x), (ay, by, y)) = (row(u), row(u + 1));
            let area = |i: usize| (ax - x[i]) * (by - y[i]) - (ay - y[i]) * (bx - x[i]);
            let (old, new) = (Lanes3::load(&hood.old, start), Lanes3::load(&hood.new, start));
            // Lanes past the end are faces of one point, and the ghost's have no area either.
            before.count(area(0), old.dot(old));
            after.count(area(1), new.dot(new));
            start += LANES;
        }
        after.fewer() > before.fewer()
    }
}

/// How many faces look which way in a texture.
#[derive(Default)]
struct Ways {
    up: u32,
    down: u32,
}

impl Ways {
    /// Adds four faces by twice their areas in the texture, and the squares of those on the surface.
    #[inline(always)]
    fn count(&mut self, area: Vec4, on_surface: Vec4) {
        let counts = (area * area).cmpgt(on_surface * FLAT) & on_surface.cmpgt(Vec4::ZERO);
        self.up += (counts & area.cmpgt(Vec4::ZERO)).bitmask().count_ones();
        self.down += (counts & area.cmplt(Vec4::ZERO)).bitmask().count_ones();
    }

    fn fewer(&self) -> u32 {
        self.up.min(self.down)
    }
}
