//! glTF 2.0 and GLB.
use crate::*;
/// Source.
#[derive(Clone, Debug)]
pub struct Source;
/// Level.
pub struct Level;
/// Written.
pub struct Written { /// d
 pub document: Vec<u8>, /// b
 pub buffer: Option<(String, Vec<u8>)>, /// i
 pub images: Vec<Image> }
/// read
pub fn read(bytes: &[u8], resolve: Resolve<'_>, weld: Weld) -> Result<Scene, ParseError> { let _ = (bytes, resolve, weld, Source); Err(ParseError::part("glTF", "pending")) }
/// write
pub fn write(scene: &Scene, levels: &[Level], stem: &str) -> Result<Written, Unfit> { let _ = (scene, levels, stem); Err(Unfit::new("glTF", "pending")) }
/// write
pub fn write_glb(scene: &Scene, levels: &[Level]) -> Result<Vec<u8>, Unfit> { let _ = (scene, levels); Err(Unfit::new("glTF", "pending")) }
