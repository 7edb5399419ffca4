//! The surface at work: vertices in 128 bytes each, with their one-rings.

pub(crate) mod local_frame;
pub(crate) mod one_ring;
pub(crate) mod vertex;
