//! The queue side of the loop: the first costing, requeueing, and waking.

use crate::kernel::attributes::AttributeModel;
use crate::kernel::collapse_loop::CollapseLoop;
use crate::kernel::mesh::one_ring::{GHOST, LONG, MAX_RING};
use crate::kernel::mesh::vertex::{NO_VERTEX, VertexFlags};
use crate::kernel::schedule::batch::Batch;
use crate::kernel::schedule::bucket_queue::last_bucket;
use crate::kernel::schedule::edge_costs::{Cheapest, Rank, cheapest};
use crate::kernel::simd::{SimdTask, widest};

/// Number of neighbours of a vertex that are read ahead: most have no more.
const READ_AHEAD: usize = 8;

impl<A: AttributeModel> CollapseLoop<'_, A> {
    /// Costs and queues all vertices for the first time, except those that wait for another part.
    pub(crate) fn cost_all_vertices(&mut self) {
        widest(CostAll(self));
    }

    /// Costs all vertices for the first time. Only edges to later vertices are costed, so each edge
    /// is costed once.
    #[inline(always)]
    fn cost_all(&mut self) {
        let Self { vertices, model, queue, .. } = self;
        let first = vertices.base;
        let mut least = vec![Rank::LAST; vertices.all.len()];
        let mut report = |[v, w]: [u32; 2], cost: f32| {
            let least = &mut least[(v - first) as usize];
            *least = (*least).min(Rank::new(cost, w));
        };
        let mut batch = Batch::<{ 4 * MAX_RING }>::new();
        for v in vertices.ids() {
            for &w in vertices.neighbours(v).iter().take(MAX_RING) {
                batch.push(v, w, w > v && w != GHOST);
            }
            if !batch.has_room(MAX_RING) {
                batch.cost_all(vertices, model, &mut report);
            }
        }
        batch.cost_all(vertices, model, report);
        for (v, least) in vertices.ids().zip(least) {
            let vertex = vertices.get_mut(v);
            if vertex.len > 0 && !vertex.flags.any(VertexFlags::OUTER) {
                let Cheapest { bucket, target } = least.cheapest();
                vertex.target = target;
                vertex.bucket = bucket;
                queue.push(v, bucket);
            }
        }
    }

    /// Reads the next vertices, their rings and their neighbours, with all that a contraction will
    /// touch of them, in loops whose loads do not depend on each other. Read one by one, each would
    /// cost a memory latency.
    pub(super) fn prefetch(&self) {
        let (vertices, (next, _)) = (&self.vertices, self.queue.next());
        let touch = |v: u32| vertices.get(v).target ^ vertices.get(v).ring[0];
        let mut sum = 0;
        for &v in next {
            sum ^= touch(v) ^ self.model.prefetch(v);
        }
        for &v in next {
            let vertex = vertices.get(v);
            sum ^= touch(vertex.target);
            // The end of a loop over the ring would be mispredicted, and found out only once the
            // ring has come from memory.
            let len = if vertex.len == LONG { 0 } else { usize::from(vertex.len) };
            for (i, &w) in vertex.ring[..READ_AHEAD].iter().enumerate() {
                let w = if i < len { w } else { v };
                sum ^= touch(w) ^ self.model.prefetch(w);
            }
        }
        std::hint::black_box(sum);
    }

    /// Returns whether a queue entry is still the current one of its vertex.
    #[inline(always)]
    pub(super) fn is_due(&self, v: u32, bucket: u16) -> bool {
        let vertex = self.vertices.get(v);
        vertex.bucket == bucket && !vertex.flags.any(VertexFlags::INACTIVE)
    }

    /// Costs all edges of a vertex and queues it by the cheapest, at the front or behind it.
    /// `known` is an edge costed a moment ago, with its bucket: another rounding must not bring it
    /// back to the front.
    #[inline(always)]
    pub(super) fn requeue(&mut self, v: u32, front: u16, known: Option<(u32, u16)>) {
        self.vertices.refresh(v);
        let Cheapest { mut bucket, target } = cheapest(&self.vertices, &self.model, v);
        if let Some((of, least)) = known
            && of == target
        {
            bucket = bucket.max(least);
        }
        let bucket = bucket.max(front);
        let vertex = self.vertices.get_mut(v);
        vertex.target = target;
        vertex.bucket = bucket;
        vertex.flags.clear(VertexFlags::STALE);
        self.queue.push(v, bucket);
    }

    /// Queues a vertex behind the front without costing it.
    #[inline(always)]
    pub(crate) fn defer(&mut self, v: u32, bucket: u16) {
        let vertex = self.vertices.get_mut(v);
        vertex.target = NO_VERTEX;
        vertex.bucket = last_bucket().min(bucket);
        self.queue.push(v, vertex.bucket);
    }

    /// Requeues a vertex whose edges were refused: it may have other edges now.
    pub(crate) fn wake(&mut self, v: u32, front: u16) {
        let vertex = self.vertices.get_mut(v);
        if vertex.floor > 0 && !vertex.flags.any(VertexFlags::INACTIVE) {
            self.queue.wake(vertex, v, front);
        }
    }

    /// Makes all refused edges eligible again.
    pub(crate) fn wake_all(&mut self) {
        self.components.iter_mut().for_each(|components| components.wake_all());
        self.queue.put_back();
        for v in self.vertices.ids() {
            let vertex = self.vertices.get(v);
            if vertex.floor > 0 && !vertex.flags.any(VertexFlags::INACTIVE) {
                self.put_first(v);
            }
        }
    }

    /// Makes seams hold from now on, and queues the vertices on them.
    pub(crate) fn hold_seams(&mut self) {
        if !self.model.hold_seams() {
            return;
        }
        self.queue.put_back();
        for v in self.vertices.ids() {
            let flags = self.vertices.get(v).flags;
            if flags.any(VertexFlags::SEAM) && !flags.any(VertexFlags::INACTIVE) {
                self.put_first(v);
            }
        }
    }

    /// Queues a vertex that has waited for its neighbours to be in the same part.
    pub(crate) fn release(&mut self, v: u32) {
        self.vertices.get_mut(v).flags.clear(VertexFlags::OUTER);
        self.put_first(v);
    }

    /// Queues a vertex before all others; it is costed when its entry comes up.
    pub(crate) fn put_first(&mut self, v: u32) {
        let vertex = self.vertices.get_mut(v);
        vertex.floor = 0;
        vertex.target = NO_VERTEX;
        vertex.bucket = 0;
        self.queue.push(v, 0);
    }

    /// Returns the bucket of the next step, an edge or a component.
    pub(crate) fn next_bucket(&mut self) -> Option<u16> {
        let of_component = self.components.as_ref().and_then(|components| components.next_bucket());
        let until = of_component.unwrap_or(last_bucket());
        self.next_edge_bucket(until).into_iter().chain(of_component).min()
    }

    /// Returns a lower bound on the bucket of the next step.
    pub(crate) fn lowest_bucket(&self) -> usize {
        let of_component = self.components.as_ref().and_then(|components| components.next_bucket());
        self.queue.lowest().min(of_component.map_or(usize::MAX, usize::from))
    }

    fn next_edge_bucket(&mut self, until: u16) -> Option<u16> {
        while self.take_batch(until) {
            let (next, bucket) = self.queue.next();
            if next.last().is_some_and(|&v| self.is_due(v, bucket)) {
                return Some(bucket);
            }
            self.pop();
        }
        None
    }
}

/// SIMD task of [`CollapseLoop::cost_all_vertices`].
struct CostAll<'e, 'v, A>(&'e mut CollapseLoop<'v, A>);

impl<A: AttributeModel> SimdTask for CostAll<'_, '_, A> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        self.0.cost_all();
    }
}
