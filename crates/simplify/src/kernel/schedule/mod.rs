//! Scheduling: the costs of edges, the queue, and the deferral of contractions.

pub(crate) mod batch;
pub(crate) mod bucket_queue;
pub(crate) mod deferral;
pub(crate) mod edge_costs;
