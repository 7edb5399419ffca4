//! SMF scopes between `begin` and `end`: their transformations, and the first vertex of their
//! numbering.

use glam::{DMat3, DMat4, DVec2, DVec3};

use crate::error::ParseError;
use crate::text::cursor::{TextCursor, quoted};

/// Limit on nesting: more than any real file needs, and little memory.
const MOST_SCOPES: usize = 1000;

/// Stack of scopes, innermost last; the first one is the file itself.
pub(super) struct Scopes(Vec<Scope>);

#[derive(Clone, Copy)]
struct Scope {
    transform: DMat4,
    /// Scale of texture coordinates, applied before the offset.
    uv_scale: DVec2,
    uv_offset: DVec2,
    /// Number of vertices before the scope.
    first: usize,
    correction: i64,
}

impl Scopes {
    pub(super) fn new() -> Self {
        Self(vec![Scope {
            transform: DMat4::IDENTITY,
            uv_scale: DVec2::ONE,
            uv_offset: DVec2::ZERO,
            first: 0,
            correction: 0,
        }])
    }

    /// Runs a scope command; returns false for other commands. `vertices` is the number of
    /// preceding vertices.
    pub(super) fn run(
        &mut self,
        command: &[u8],
        vertices: usize,
        text: &mut TextCursor,
    ) -> Result<bool, ParseError> {
        match command {
            b"begin" => self.begin(vertices, text)?,
            b"end" => self.end(text)?,
            b"trans" => {
                let offset = numbers(text, "trans needs x, y and z")?;
                self.inner().transform *= DMat4::from_translation(offset.into());
            }
            b"scale" => {
                let scale = numbers(text, "scale needs x, y and z")?;
                self.inner().transform *= DMat4::from_scale(scale.into());
            }
            b"rot" => self.rotate(text)?,
            b"t_trans" => {
                let offset = DVec2::from(numbers(text, "t_trans needs u and v")?);
                let inner = self.inner();
                inner.uv_offset += inner.uv_scale * offset;
            }
            b"t_scale" => {
                let scale = DVec2::from(numbers(text, "t_scale needs u and v")?);
                self.inner().uv_scale *= scale;
            }
            b"set" => self.set(text)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn begin(&mut self, vertices: usize, text: &TextCursor) -> Result<(), ParseError> {
        if self.0.len() > MOST_SCOPES {
            return Err(text.error(format!("more than {MOST_SCOPES} nested scopes")));
        }
        let scope = Scope { first: vertices, ..*self.inner() };
        self.0.push(scope);
        Ok(())
    }

    fn end(&mut self, text: &TextCursor) -> Result<(), ParseError> {
        if self.0.len() == 1 {
            return Err(text.error("end without begin"));
        }
        self.0.pop();
        Ok(())
    }

    fn rotate(&mut self, text: &mut TextCursor) -> Result<(), ParseError> {
        let axis = match text.word() {
            b"x" => DVec3::X,
            b"y" => DVec3::Y,
            b"z" => DVec3::Z,
            other => return Err(text.error(format!("{} is not an axis", quoted(other)))),
        };
        let [degrees] = numbers(text, "rot needs an angle in degrees")?;
        self.inner().transform *= DMat4::from_axis_angle(axis, degrees.to_radians());
        Ok(())
    }

    /// Runs `set vertex_correction N`, optionally with a `=` before the number. Other variables are
    /// ignored.
    fn set(&mut self, text: &mut TextCursor) -> Result<(), ParseError> {
        if text.word() == b"vertex_correction" {
            if text.more() {
                text.take(b'=');
            }
            self.inner().correction = text.integer("vertex_correction needs a number")?;
        }
        Ok(())
    }

    /// Resolves a vertex index: relative to the first vertex of the scope if positive, back from
    /// the last of `vertices` if negative.
    pub(super) fn vertex(&self, index: i64, vertices: usize) -> Option<u32> {
        let scope = self.0.last()?;
        let v = if index < 0 {
            vertices as i64 + index
        } else {
            index.saturating_add(scope.correction).saturating_add(scope.first as i64 - 1)
        };
        u32::try_from(v).ok().filter(|&v| (v as usize) < vertices)
    }

    pub(super) fn position(&self, position: [f64; 3]) -> [f64; 3] {
        match self.0.last() {
            // Bypasses the identity, so that -0 stays -0.
            Some(scope) if scope.transform != DMat4::IDENTITY => {
                scope.transform.transform_point3(position.into()).into()
            }
            _ => position,
        }
    }

    /// Transforms a normal with the surface and normalises it; 0 stays 0.
    pub(super) fn normal(&self, normal: [f32; 3]) -> [f32; 3] {
        let mut normal = DVec3::from(normal.map(f64::from));
        if let Some(scope) = self.0.last() {
            // The cofactor matrix is the inverse transpose times the determinant, without a
            // division.
            let DMat3 { x_axis: x, y_axis: y, z_axis: z } = DMat3::from_mat4(scope.transform);
            let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
            normal = cofactors * normal * cofactors.determinant().signum();
        }
        normal.normalize_or_zero().to_array().map(|x| x as f32)
    }

    pub(super) fn uv(&self, uv: [f32; 2]) -> [f32; 2] {
        let Some(scope) = self.0.last() else { return uv };
        let uv = scope.uv_scale * DVec2::from(uv.map(f64::from)) + scope.uv_offset;
        uv.to_array().map(|x| x as f32).map(|x| if x.is_finite() { x } else { 0.0 })
    }

    fn inner(&mut self) -> &mut Scope {
        self.0.last_mut().expect("the file's own scope is never closed")
    }
}

fn numbers<const N: usize>(text: &mut TextCursor, need: &str) -> Result<[f64; N], ParseError> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = text.number(need)?;
    }
    Ok(numbers)
}
