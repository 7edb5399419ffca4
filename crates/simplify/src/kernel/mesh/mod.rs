//! The surface: vertices of 128 bytes with their one-rings, in a local frame.

pub(crate) mod local_frame;
pub(crate) mod one_ring;
pub(crate) mod vertex;
