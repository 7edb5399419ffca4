//! smf.
