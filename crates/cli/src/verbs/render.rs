//! `render`: a picture.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use meshlod::measure::vertex_errors;
use meshlod::mesh::LayerKind;
use meshlod::picture::{
    Camera, ColorMap, Lighting, Materials, Normals, Paint, Style, UpAxis, Values, View, Wireframe,
    render,
};
use meshlod::{Mesh, Scene, materials_of};
use serde_json::json;

use crate::amounts::{self, Look};
use crate::answer::Answer;
use crate::args::Reading;
use crate::distance;
use crate::failure::Failure;
use crate::files;
use crate::numbers::{percent, value};
use crate::session::Session;

#[derive(Args)]
pub struct Render {
    /// File to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// PNG to write, or -
    #[arg(value_name = "OUT.png")]
    output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = amounts::pixels)]
    size: [u32; 2],
    /// Where to look from: front, back, left, right, top, bottom; or the direction to look in, x,y,z
    #[arg(long, value_name = "DIR", value_parser = amounts::look, allow_hyphen_values = true)]
    view: Option<Look>,
    /// The axis that is up
    #[arg(long, value_name = "AXIS", default_value = "y")]
    up: Axis,
    /// Draw the edges of all faces
    #[arg(long)]
    wireframe: bool,
    /// Shade every face flat
    #[arg(long)]
    flat: bool,
    /// A checkerboard over the uvs, whatever the textures
    #[arg(long, conflicts_with = "heat_against")]
    checker: bool,
    /// Colour by the distance of every vertex from this mesh
    #[arg(long, value_name = "B")]
    heat_against: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Clone, Copy, ValueEnum)]
enum Axis {
    Y,
    Z,
}

/// Edges that bend by more than this, in radians, are sharp where a file has no normals.
const CREASE_RAD: f64 = 1.0;

/// Squares of the checkerboard along a unit of uv.
const SQUARES: u32 = 16;

/// Distances of a mesh's vertices from another mesh.
struct Heat {
    values: Vec<f32>,
    max: f64,
    max_percent: f64,
}

impl Render {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_picture(&self.output, session)?;
        let scene = files::read(&self.input, &self.reading, session)?;
        let (materials, unread) = materials_of(&scene);
        for image in unread {
            let reason = format_args!("image {}: {}", image.name, image.reason);
            session.warn(Failure::at(&self.input, reason));
        }
        let textures = materials.textures.len();
        let materials = has_colour(&scene, &materials).then_some(materials);
        let mesh = scene.into_mesh();
        if mesh.faces.is_empty() {
            return Err(Failure::at(&self.input, "the mesh has no faces"));
        }
        let heat = self.heat(&mesh, session)?;
        session.progress.stage("drawing");
        let style = self.style(&mesh, materials.as_ref(), heat.as_ref());
        let picture = render(&mesh, &self.camera(&mesh), &style)
            .map_err(|error| Failure::at(&self.input, error))?;
        files::write_picture(&self.output, &picture.png())?;

        let [width, height] = self.size;
        let file = files::name(&self.output);
        let json = json!({
            "file": file,
            "width": width,
            "height": height,
            "faces": mesh.faces.len(),
            "textures": textures,
            "heat_max": heat.as_ref().map(|heat| heat.max),
            "heat_max_percent": heat.as_ref().map(|heat| heat.max_percent),
        });
        let mut text = format!("{file}: {width} x {height}\n");
        if let Some(Heat { max, max_percent, .. }) = heat {
            let (max, part) = (value(max), percent(max_percent));
            text += &format!("darkest at a distance of {max} ({part} of the diagonal)\n");
        }
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn heat(&self, mesh: &Mesh, session: &Session) -> Result<Option<Heat>, Failure> {
        let Some(path) = &self.heat_against else { return Ok(None) };
        let against = files::read(path, &self.reading, session)?.into_mesh();
        session.progress.stage("measuring");
        let against = distance::ready(&against, path)?;
        let errors = vertex_errors(mesh, &against);
        let max = errors.iter().copied().fold(0.0, f64::max);
        let values = errors.into_iter().map(|error| error as f32).collect();
        Ok(Some(Heat { values, max, max_percent: 100.0 * max / against.diagonal() }))
    }

    fn style<'a>(
        &self,
        mesh: &Mesh,
        materials: Option<&'a Materials>,
        heat: Option<&'a Heat>,
    ) -> Style<'a> {
        let has = |kind| mesh.attributes.as_ref().is_some_and(|all| all.layer(kind).is_some());
        let paint = match (heat, materials) {
            (Some(Heat { values, max, .. }), _) => {
                let range = [0.0, *max as f32];
                Paint::VertexValues(Values { values, map: ColorMap::Heat, range })
            }
            _ if self.checker => Paint::Checker { squares: SQUARES },
            (None, Some(materials)) => Paint::Materials(materials),
            _ if has(LayerKind::Color(0)) => Paint::Colors,
            _ => Paint::default(),
        };
        let normals = match self.flat {
            true => Normals::Flat,
            false if has(LayerKind::Normal) => Normals::FromMesh,
            false => Normals::Creased { crease_rad: CREASE_RAD },
        };
        Style {
            size: self.size,
            paint,
            normals,
            lighting: if heat.is_some() { Lighting::Soft } else { Lighting::default() },
            wireframe: self.wireframe.then(Wireframe::default),
            ..Style::default()
        }
    }

    fn camera(&self, mesh: &Mesh) -> Camera {
        let [width, height] = self.size.map(f64::from);
        let up = match self.up {
            Axis::Y => UpAxis::Y,
            Axis::Z => UpAxis::Z,
        };
        let mut view = View { aspect: width / height, ..View::three_quarter(up) };
        match (self.view, up) {
            (None, _) => {}
            (Some(Look::Along(direction) | Look::From(direction)), UpAxis::Y)
            | (Some(Look::Along(direction)), UpAxis::Z) => view.direction = direction,
            (Some(Look::From([x, y, z])), UpAxis::Z) => view.direction = [x, -z, y],
        }
        Camera::fit_mesh(mesh, &view)
    }
}

/// Whether materials say more than that everything is white.
fn has_colour(scene: &Scene, materials: &Materials) -> bool {
    let white = |material: &meshlod::io::Material| material.base_color[..3] == [1.0; 3];
    !materials.textures.is_empty() || !scene.materials.iter().all(white)
}
