//! Which edge comes next: costs of edges, the queue, and what has to wait.

pub(crate) mod batch;
pub(crate) mod bucket_queue;
pub(crate) mod deferral;
pub(crate) mod edge_costs;
