//! Computes the attribute values of wedges after a contraction.
//!
//! A pair along the edge becomes one wedge with the values that fit both best. Where a vertex has
//! several wedges in one chart, creases in the shading, the unpaired ones stay with their faces:
//! each takes the normal that fits it best, and all share one place in uv.

use crate::kernel::attributes::attribute_quadric::{AttributeQuadric, best_values};
use crate::kernel::attributes::scratch::NewValues;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::{Collapse, WedgePairs};
use crate::kernel::metric::Metric;

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Returns the attribute values of the wedge that a pair of wedges becomes.
    pub(crate) fn values(&self, collapse: &Collapse, [s0, s1]: [u32; 2]) -> [f32; K] {
        let (f0, f1) = (self.quadric(s0), self.quadric(s1));
        let before = f0.values();
        if collapse.keeps_values() {
            return before;
        }
        let mut values = best_values(f0, f1, collapse.half, collapse.from_middle);
        self.layers.clamp_values(&mut values, &before);
        values
    }

    /// Computes the new attribute values at all slots of both ends of an edge.
    ///
    /// If `v0` stays where it is or moves along its normal, its values stay. But if unpaired slots of
    /// `v1` join it, all are written again, because a value converted to channels and back may differ
    /// in its last digit.
    pub(crate) fn find_values(&mut self, collapse: &Collapse) {
        let mut renewed = std::mem::take(&mut self.scratch.renewed);
        renewed.clear();
        let (ends, wedge_pairs) = (&collapse.ends, &collapse.ends.wedge_pairs);
        let stays = collapse.keeps_values();
        if !stays || self.unpaired(ends, 1).next().is_some() {
            let weight = |quadric: &AttributeQuadric<K>| if stays { 0.0 } else { quadric.weight() };
            for (i, &[s0, s1]) in wedge_pairs.pairs().iter().enumerate() {
                if wedge_pairs.pairs()[..i].iter().all(|before| before[0] != s0) {
                    let weight = weight(self.quadric(s0)) + weight(self.quadric(s1));
                    let values = self.values(collapse, [s0, s1]);
                    renewed.push(NewValues { slot: s0, values, leader: s0, weight });
                }
            }
            for (end, from) in [(0, -collapse.half), (1, collapse.half)] {
                for slot in self.unpaired(ends, end) {
                    let quadric = self.quadric(slot);
                    let mut values = quadric.values();
                    if end == 1 || !stays {
                        values = quadric.best_values(collapse.from_middle - from);
                        self.layers.clamp_values(&mut values, &quadric.values());
                    }
                    let leader = if end == 0 { slot } else { self.leader(wedge_pairs, slot) };
                    renewed.push(NewValues { slot, values, leader, weight: weight(quadric) });
                }
            }
        }
        if !self.charts.is_empty() && renewed.len() > 1 {
            self.unify_charts(&mut renewed);
        }
        self.scratch.renewed = renewed;
    }

    /// Gives all slots of one chart the same place in uv.
    fn unify_charts(&self, renewed: &mut [NewValues<K>]) {
        for i in 0..renewed.len() {
            let chart = self.chart(renewed[i].leader);
            let is_of = |other: &NewValues<K>| self.chart(other.leader) == chart;
            if renewed[..i].iter().any(is_of) {
                continue;
            }
            let (mut sum, mut weight) = ([0.0; K], 0.0);
            for other in renewed.iter().filter(|other| is_of(other)) {
                let share = f64::from(other.weight);
                weight += share;
                for (sum, x) in sum.iter_mut().zip(other.values) {
                    *sum += share * f64::from(x);
                }
            }
            let mean = match weight > 0.0 {
                true => sum.map(|x| (x / weight) as f32),
                false => renewed[i].values,
            };
            let others = renewed[i..].iter_mut().filter(|other| is_of(other));
            others.for_each(|other| self.layers.copy_textures(&mut other.values, &mean));
        }
    }

    /// Assigns slots to the chart they join, and copies its textures outside the channels.
    pub(crate) fn update_charts(&mut self, wedge_pairs: &WedgePairs) {
        let Self { scratch, charts, carried, .. } = self;
        if charts.is_empty() {
            return;
        }
        for &NewValues { slot, leader, .. } in &scratch.renewed {
            let chart = charts.at(leader);
            *charts.get_mut(slot) = chart;
            let mut leaders = wedge_pairs.pairs().iter().map(|pair| pair[0]);
            if let Some(other) = leaders.find(|&other| charts.at(other) == chart) {
                carried.copy_textures(slot, other);
            }
        }
    }
}
