//! Models in a browser: the viewer's page, with a model inside or served with a folder.
//!
//! `viewer` holds what `npm run page` makes of `web/page`; [`page`] puts a model into it, and
//! [`server`] serves it with the files of a folder.

pub mod page;
pub mod server;

/// The viewer: one page with its style and its script, and a mark where a model goes.
pub const VIEWER: &str = include_str!("viewer/page.html");

/// Decoders of `.mlz` and `.mlq`, a module that the viewer imports from the server.
pub const FORMATS: &str = include_str!("viewer/formats.js");
