//! What every encoding must hold, on random walks through queries.

mod certificates;
mod long;
mod motions;
mod near;
pub(crate) mod walks;
