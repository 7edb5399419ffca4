//! What every encoding must hold, on random walks through queries.

mod certificates;
mod motions;
pub(crate) mod walks;
