//! Draws mesh files in every style: `cargo run --release --example gallery -- OUT.png MESH...`
//!
//! One row per mesh: shaded, wireframe, height as a heat map, uv checker, back faces in red.

use std::error::Error;
use std::path::Path;

use meshlod_io::ReadOptions;
use meshlod_mesh::Mesh;
use meshlod_picture::{
    BackFaces, Camera, ColorMap, Lighting, Normals, Paint, Picture, PictureError, Style, Values,
    View, Wireframe, grid, render,
};

/// Pictures per row.
const COLUMNS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let out = arguments.next().ok_or("usage: gallery OUT.png MESH...")?;
    let mut pictures = Vec::new();
    for path in arguments {
        let mesh = meshlod_io::read(Path::new(&path), &ReadOptions::default())?.into_mesh();
        pictures.extend(row(&mesh)?);
    }
    std::fs::write(out, grid(&pictures, COLUMNS)?.png())?;
    Ok(())
}

fn row(mesh: &Mesh) -> Result<[Picture; COLUMNS], PictureError> {
    let camera = Camera::fit_mesh(mesh, &View::default());
    let bounds = mesh.bounds();
    let heights: Vec<f32> = mesh.positions.iter().map(|p| p[1] as f32).collect();
    let range = [bounds.min[1] as f32, bounds.max[1] as f32];
    let plain = Style {
        size: [512, 512],
        normals: Normals::Creased { crease_rad: 0.7 },
        ..Style::default()
    };
    let wireframe = Some(Wireframe::default());
    let heat = Paint::VertexValues(Values { values: &heights, map: ColorMap::Heat, range });
    let draw = |style: &Style| render(mesh, &camera, style);
    Ok([
        draw(&plain)?,
        draw(&Style { wireframe, normals: Normals::Flat, ..plain.clone() })?,
        draw(&Style { paint: heat, lighting: Lighting::Soft, ..plain.clone() })?,
        draw(&Style { paint: Paint::Checker { squares: 16 }, ..plain.clone() })?,
        draw(&Style { back_faces: BackFaces::RED, ..plain })?,
    ])
}
