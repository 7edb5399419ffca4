//! What every encoding must hold, on random walks through queries.

mod certificates;
mod locate;
mod long;
mod motions;
pub(crate) mod walks;
