//! Groups of options that verbs share, each with the plain data that it stands for.
//!
//! Values are read by [`parse`], with [`number`], [`tolerance`] and [`query_args`]; what they are
//! doubted for is in [`doubt`]. [`args`] has the options of every verb, [`constraints`] and [`method`]
//! those of verbs that simplify.

pub mod args;
pub mod constraints;
pub mod doubt;
pub mod finish;
pub mod fuse;
pub mod locks;
pub mod method;
pub mod model_query;
pub mod number;
pub mod parse;
pub mod query_args;
pub mod tolerance;
pub mod topology;
