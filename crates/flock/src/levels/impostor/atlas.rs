//! Drawing of the atlas.

use glam::{DVec3, Vec3};
use meshlod_picture::{
    Antialiasing, Background, Camera, Normals, Paint, Picture, Style, bleed, grid, render,
};
use rayon::prelude::*;

use crate::levels::impostor::ImpostorOptions;
use crate::levels::look::Look;
use crate::levels::table::{LevelTable, TableError};

/// Distance of the eye in body lengths. It stands for one that is infinitely far: what is half a
/// body length nearer looks 1.3 % larger.
const DISTANCE: f64 = 40.0;

/// Draws a view for each pair of right and up, and puts them side by side.
pub(super) fn draw(
    table: &LevelTable,
    look: &Look,
    options: &ImpostorOptions,
    axes: &[[Vec3; 2]],
    half_width: f32,
) -> Result<Picture, TableError> {
    let mut mesh = table.mesh(0);
    if look.materials.is_none() {
        // Colours or one plain material: its labels would refer to others.
        mesh.materials = None;
    }
    let materials = look.materials_over(&table.layers);
    let style = Style {
        size: [options.side_px; 2],
        paint: materials.as_deref().map_or(Paint::Colors, Paint::Materials),
        normals: Normals::FromMesh,
        lighting: options.lighting,
        background: Background::Transparent,
        antialiasing: Antialiasing::Four,
        ..Style::default()
    };
    let fov = 2.0 * (f64::from(half_width) / DISTANCE).atan();
    let view = |&[right, up]: &[Vec3; 2]| {
        let eye = right.cross(up).as_dvec3() * DISTANCE;
        let up: DVec3 = up.as_dvec3();
        render(&mesh, &Camera::look_at(eye.into(), [0.0; 3], up.into(), fov), &style)
    };
    let views: Result<Vec<Picture>, _> = axes.par_iter().map(view).collect();
    let atlas = grid(&views?, options.views_per_side)?;
    Ok(bleed(&atlas, options.side_px)?)
}
