//! What a contraction does to the fields around it.

use glam::{Vec3, Vec4};

use crate::fast::around::Slots;
use crate::fast::field::Field;
use crate::fast::hood::{Hood, ROOM};
use crate::fast::lanes::{LANES, Lanes3, transpose};
use crate::fast::looks::{Ends, Placed};
use crate::fast::painted::Painted;
use crate::fast::renew::Renewed;
use crate::fast::ring::GHOST;
use crate::fast::wide::TINY;

/// Values at corners of spokes, a channel of all in one row, and the lanes beyond their end.
type Rows<const K: usize> = [[f32; ROOM]; K];

/// Room for a contraction.
pub(super) struct Scratch<const K: usize> {
    /// At `ids[i]` of spoke i.
    pub(super) first: Rows<K>,
    /// Where there are seams, at `ids[i + 1]` of spoke i, at its apex before and after.
    pub(super) second: Rows<K>,
    pub(super) before: Rows<K>,
    pub(super) after: Rows<K>,
    /// What the field of each spoke becomes, less what it was.
    pub(super) changes: [Field<K>; ROOM],
    /// What it becomes, where there are seams.
    pub(super) new: [Field<K>; ROOM],
    /// Where there are none: the new vertex's values.
    pub(super) values: [f32; K],
    /// Where there are seams: the slots that have new values, and which is where.
    pub(super) renewed: Vec<Renewed<K>>,
    pub(super) slots: Slots,
}

impl<const K: usize> Painted<'_, K> {
    /// Where nothing around has a seam: slots are vertices. As looked ahead to.
    #[inline(always)]
    pub(super) fn contract_smooth(&mut self, hood: &Hood, placed: &Placed) {
        let Ends { v0, v1, .. } = placed.ends;
        let (of_v0, of_v1) = (self.field(v0).values(), self.field(v1).values());
        let Self { fields, scratch, .. } = self;
        let values = scratch.values;
        let mut new = scratch.change::<false>(hood, placed.by, [&of_v0, &of_v1, &values]);
        for (channel, value) in new.channels.iter_mut().zip(values) {
            channel.w = value;
        }
        let mut last = scratch.changes[hood.len - 1];
        for i in 0..hood.len {
            let change = scratch.changes[i];
            let id = hood.ids[i];
            if id != GHOST {
                let field = &mut fields[id as usize];
                field.add(&last);
                field.add(&change);
            }
            last = change;
        }
        for wing in [0, hood.of_v0] {
            if hood.ghost != Some(wing) {
                let field = &mut fields[hood.ids[wing] as usize];
                field.take(&dying(hood, wing, [&of_v0, &of_v1, &field.values()]));
            }
        }
        fields[v0 as usize] = new;
        self.heirs[v1 as usize] = v0;
        if placed.by != Vec3::ZERO {
            self.heirs[v0 as usize] = v0;
        }
    }
}

impl<const K: usize> Scratch<K> {
    pub(super) fn new() -> Box<Self> {
        let (rows, fields) = ([[0.0; ROOM]; K], [Field::EMPTY; ROOM]);
        let (first, second, before, after) = (rows, rows, rows, rows);
        let (values, renewed, slots) = ([0.0; K], Vec::new(), Slots::default());
        Box::new(Self {
            first,
            second,
            before,
            after,
            changes: fields,
            new: fields,
            values,
            renewed,
            slots,
        })
    }

    /// Puts what each spoke changes in its place; gives the sum of the new faces where there are no
    /// seams, each new one where there are. `values` are those of both ends and of the new vertex, which
    /// without seams are those of all apexes.
    #[inline(always)]
    pub(super) fn change<const SEAMS: bool>(
        &mut self,
        hood: &Hood,
        by: Vec3,
        [of_v0, of_v1, values]: [&[f32; K]; 3],
    ) -> Field<K> {
        let mut sum = [[Vec4::ZERO; 3]; K];
        let mut squares = [Vec4::ZERO; 7];
        let mut start = 0;
        while start < hood.len {
            let row = |row: &[f32; ROOM], start: usize| Vec4::from_slice(&row[start..]);
            let at_v1 = row(&hood.of_v1, start);
            let at_v0 = Vec4::ONE - at_v1;
            let (a, b) = (Lanes3::load(&hood.ring, start), Lanes3::load(&hood.ring, start + 1));
            let old = Spokes::new(
                a,
                b,
                Lanes3::all(hood.along).by(at_v1),
                Lanes3::load(&hood.old, start),
            );
            let new = Spokes::new(a, b, Lanes3::all(by), Lanes3::load(&hood.new, start));
            let (mut changes, mut news) = ([[Vec4::ZERO; 3]; K], [[Vec4::ZERO; 3]; K]);
            let (mut was, mut now) = ([Vec4::ZERO; 6], [Vec4::ZERO; 6]);
            for k in 0..K {
                let to_a = row(&self.first[k], start);
                let (to_b, at_first, at_last) = if SEAMS {
                    let (second, before) = (&self.second[k], &self.before[k]);
                    (row(second, start), row(before, start), row(&self.after[k], start))
                } else {
                    let at_first = at_v0 * of_v0[k] + at_v1 * of_v1[k];
                    (row(&self.first[k], start + 1), at_first, Vec4::splat(values[k]))
                };
                let before = old.slope(to_a - at_first, to_b - at_first, &mut was);
                let after = new.slope(to_a - at_last, to_b - at_last, &mut now);
                changes[k] = [after.x - before.x, after.y - before.y, after.z - before.z];
                news[k] = [after.x, after.y, after.z];
                for (sum, after) in sum[k].iter_mut().zip(news[k]) {
                    *sum += after;
                }
            }
            let (mut change, mut after) = ([Vec4::ZERO; 7], [Vec4::ZERO; 7]);
            for i in 0..6 {
                after[i] = now[i] * new.scale;
                change[i] = after[i] - was[i] * old.scale;
            }
            after[6] = new.weight;
            change[6] = new.weight - old.weight;
            for (sum, after) in squares.iter_mut().zip(after) {
                *sum += after;
            }
            write(&mut self.changes, start, &change, &changes);
            if SEAMS {
                write(&mut self.new, start, &after, &news);
            }
            start += LANES;
        }
        let [xx, yy, zz, xy, xz, yz, weight] = squares.map(Vec4::element_sum);
        let mut field = Field::EMPTY;
        field.squares = [Vec4::new(xx, yy, zz, xy), Vec4::new(xz, yz, weight, 0.0)];
        for (channel, [x, y, z]) in field.channels.iter_mut().zip(sum) {
            *channel = Vec4::new(x.element_sum(), y.element_sum(), z.element_sum(), 0.0);
        }
        field
    }
}

/// Writes the fields of four spokes.
#[inline(always)]
fn write<const K: usize>(
    to: &mut [Field<K>; ROOM],
    start: usize,
    squares: &[Vec4; 7],
    channels: &[[Vec4; 3]; K],
) {
    let [xx, yy, zz, xy, xz, yz, weight] = *squares;
    let first = transpose(xx, yy, zz, xy);
    let second = transpose(xz, yz, weight, Vec4::ZERO);
    for lane in 0..LANES {
        to[start + lane].squares = [first[lane], second[lane]];
    }
    for (k, [x, y, z]) in channels.iter().enumerate() {
        let rows = transpose(*x, *y, *z, Vec4::ZERO);
        for (lane, row) in rows.into_iter().enumerate() {
            to[start + lane].channels[k] = row;
        }
    }
}

/// Four faces, and how a channel's slope on them follows from its values.
struct Spokes {
    along_a: Lanes3,
    along_b: Lanes3,
    weight: Vec4,
    /// The weight's inverse.
    scale: Vec4,
}

impl Spokes {
    /// Corners `a`, `b` and `apex`; no face where the normal is zero.
    #[inline(always)]
    fn new(a: Lanes3, b: Lanes3, apex: Lanes3, normal: Lanes3) -> Self {
        let weight = normal.dot(normal);
        Self {
            along_a: (b - apex).cross(normal),
            along_b: normal.cross(a - apex),
            weight,
            scale: (weight + Vec4::splat(TINY)).recip(),
        }
    }

    /// The slope by the weight, its squares added.
    #[inline(always)]
    fn slope(&self, to_a: Vec4, to_b: Vec4, squares: &mut [Vec4; 6]) -> Lanes3 {
        let slope = self.along_a.by(to_a) + self.along_b.by(to_b);
        let Lanes3 { x, y, z } = slope;
        squares[0] += x * x;
        squares[1] += y * y;
        squares[2] += z * z;
        squares[3] += x * y;
        squares[4] += x * z;
        squares[5] += y * z;
        slope
    }
}

/// The field of the face of the edge and a wing, by the values at both ends and at the wing.
pub(super) fn dying<const K: usize>(
    hood: &Hood,
    wing: usize,
    [v0, v1, other]: [&[f32; K]; 3],
) -> Field<K> {
    let (mut to_v1, mut to_wing) = ([0.0; K], [0.0; K]);
    for k in 0..K {
        (to_v1[k], to_wing[k]) = (v1[k] - v0[k], other[k] - v0[k]);
    }
    Field::face(hood.along, hood.seen(wing), to_v1, to_wing)
}
