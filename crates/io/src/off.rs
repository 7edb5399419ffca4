//! off.
