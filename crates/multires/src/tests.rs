//! Properties that every encoding must have, on random walks through queries.

pub(crate) mod attributes;
mod certificates;
mod drawn;
mod geomorphs;
mod locate;
mod long;
mod motions;
mod recorded;
pub(crate) mod walks;
mod wedges;
