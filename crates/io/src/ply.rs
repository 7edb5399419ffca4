//! ply.
