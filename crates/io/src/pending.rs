//! Formats on their way.
#![allow(dead_code, unused_variables)]
use crate::{ParseError, Precision, Resolve, Scene};
use meshlod_mesh::Mesh;
use std::io::{self, Write};
fn no<T>() -> Result<T, ParseError> {
    Err(ParseError::part("file", "this format is on its way"))
}
pub(crate) mod one {
    use super::*;
    pub fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
        no()
    }
    pub fn write(mesh: &Mesh, precision: Precision, out: &mut dyn Write) -> io::Result<()> {
        Err(io::Error::other("on its way"))
    }
}
pub(crate) mod stl {
    use super::*;
    pub fn read(bytes: &[u8]) -> Result<Mesh, ParseError> {
        no()
    }
    pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
        Err(io::Error::other("on its way"))
    }
}
pub(crate) mod obj {
    use super::*;
    pub fn read(bytes: &[u8], resolve: Resolve<'_>) -> Result<Scene, ParseError> {
        no()
    }
    pub fn write(
        scene: &Scene,
        precision: Precision,
        out: &mut dyn Write,
        library: Option<&str>,
    ) -> io::Result<()> {
        Err(io::Error::other("on its way"))
    }
    pub fn write_mtl(scene: &Scene, out: &mut dyn Write) -> io::Result<()> {
        Err(io::Error::other("on its way"))
    }
}
