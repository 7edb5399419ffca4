//! Text formats: a cursor to read words and numbers, and a writer of lines.

pub(crate) mod cursor;
pub(crate) mod line_writer;
