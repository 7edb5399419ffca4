//! Reading and writing of text: a cursor over words and numbers, and lines of them.

pub(crate) mod cursor;
pub(crate) mod line_writer;
