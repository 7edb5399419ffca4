//! `render`: draws a picture of a mesh.

use std::path::PathBuf;

use clap::Args;
use meshlod::Mesh;
use meshlod::measure::{PreparedSurface, vertex_errors};
use meshlod::picture::{
    Camera, ColorMap, Lighting, Normals, Paint, Picture, Style, Values, View, Wireframe, render,
};
use meshlod::scene::single_sided_materials;
use serde_json::json;

use crate::options::args::{ReadArgs, ViewArgs};
use crate::options::parse;
use crate::page::style::{self, OwnedPaint, normals_of};
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
#[cfg(feature = "view")]
use crate::text::numbers::count;
use crate::text::numbers::{percent, value};
#[cfg(feature = "view")]
use crate::view::still;

/// Render a picture of a mesh
///
/// Nodes are where the file has them; skins, morph targets and animations are not applied.
#[derive(Args)]
pub struct Render {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// PNG to write, or -
    #[arg(value_name = "OUT.png")]
    output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = parse::pixels)]
    size: [u32; 2],
    #[command(flatten)]
    viewpoint: ViewArgs,
    /// Draw the edges of all faces
    #[arg(long)]
    wireframe: bool,
    /// Use flat shading
    #[arg(long)]
    flat: bool,
    /// Draw a checkerboard in texture coordinates in place of textures
    #[arg(long, conflicts_with = "heat_against")]
    checker: bool,
    /// Colour every vertex by its distance from this mesh
    #[arg(long, value_name = "B")]
    heat_against: Option<PathBuf>,
    /// Draw on the GPU, as the viewer does
    ///
    /// Also draws .mlod and .mlq files as they are stored. Needs a meshlod built with the feature
    /// view.
    #[arg(long)]
    gpu: bool,
    #[command(flatten)]
    reading: ReadArgs,
}

/// Squares of the checkerboard per unit of uv.
const SQUARES: u32 = 16;

/// Distances of the vertices of a mesh from another mesh.
struct Heat {
    values: Vec<f32>,
    max: f64,
    max_percent: f64,
}

impl Render {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        files::check_picture(&self.output, session)?;
        #[cfg(not(feature = "view"))]
        if self.gpu {
            return Err(Failure::new(crate::view::MISSING));
        }
        #[cfg(feature = "view")]
        if self.gpu && still::is_stored(&self.input) {
            return self.draw_stored(session);
        }
        let scene = files::read_surface(&self.input, &self.reading, session)?;
        let paint = OwnedPaint::of(&scene, style::materials(&scene, &self.input, session));
        let single_sided = single_sided_materials(&scene);
        let mesh = scene.into_mesh();
        let heat = self.heat(&mesh, session)?;
        session.progress.stage("drawing");
        let style =
            Style { single_sided: &single_sided, ..self.style(&mesh, &paint, heat.as_ref()) };
        let picture = self.draw(&mesh, &style)?;
        files::write_picture(&self.output, &picture.png())?;

        let [width, height] = self.size;
        let file = files::name(&self.output);
        let json = json!({
            "file": file,
            "width": width,
            "height": height,
            "faces": mesh.faces.len(),
            "textures": paint.textures(),
            "heat_max": heat.as_ref().map(|heat| heat.max),
            "heat_max_percent": heat.as_ref().map(|heat| heat.max_percent),
        });
        let mut text = format!("{file}: {width} x {height}\n");
        if let Some(Heat { max, max_percent, .. }) = heat {
            let (max, part) = (value(max), percent(max_percent));
            text += &format!("heat map: darkest at a distance of {max} ({part} of the diagonal)\n");
        }
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn draw(&self, mesh: &Mesh, style: &Style<'_>) -> Result<Picture, Failure> {
        #[cfg(feature = "view")]
        if self.gpu {
            return still::mesh(mesh, &self.camera(mesh), style);
        }
        render(mesh, &self.camera(mesh), style).map_err(|error| Failure::at(&self.input, error))
    }

    /// Draws a file of our own formats from what it stores.
    #[cfg(feature = "view")]
    fn draw_stored(&self, session: &Session) -> Result<Answer, Failure> {
        use meshlod_view::stage::{Display, Shading};
        if self.checker || self.heat_against.is_some() {
            let reason = "cannot be combined with --checker or --heat-against in this format";
            return Err(Failure::usage(format_args!("--gpu {reason}")));
        }
        let is_compressed = self.input.extension().is_some_and(|s| s.eq_ignore_ascii_case("mlq"));
        if self.wireframe && is_compressed {
            let reason = "a compressed mesh has no wireframe: decompress it first";
            return Err(Failure::usage(format_args!("--wireframe: {reason}")));
        }
        session.progress.stage("drawing");
        let display = Display {
            shading: if self.flat { Shading::Flat } else { Shading::Smooth },
            wireframe: self.wireframe,
            ..Display::default()
        };
        let [width, height] = self.size.map(f64::from);
        let view = View { aspect: width / height, ..self.viewpoint.view() };
        let still::Stored { picture, faces } =
            still::stored(&self.input, self.size, &view, &display)?;
        files::write_picture(&self.output, &picture.png())?;
        let [width, height] = self.size;
        let file = files::name(&self.output);
        let json = json!({ "file": file, "width": width, "height": height, "faces": faces });
        let text = format!("{file}: {width} x {height}, {} faces\n", count(faces));
        Ok(Answer { file_on_stdout: files::is_pipe(&self.output), ..Answer::new(json, text) })
    }

    fn heat(&self, mesh: &Mesh, session: &Session) -> Result<Option<Heat>, Failure> {
        let Some(path) = &self.heat_against else { return Ok(None) };
        let against = files::read_surface(path, &self.reading, session)?.into_mesh();
        session.progress.stage("measuring");
        let against = PreparedSurface::new(&against).map_err(|error| Failure::at(path, error))?;
        let errors = vertex_errors(mesh, &against);
        let max = errors.iter().copied().fold(0.0, f64::max);
        let values = errors.into_iter().map(|error| error as f32).collect();
        Ok(Some(Heat { values, max, max_percent: 100.0 * max / against.diagonal() }))
    }

    fn style<'a>(&self, mesh: &Mesh, paint: &'a OwnedPaint, heat: Option<&'a Heat>) -> Style<'a> {
        let paint = match heat {
            Some(Heat { values, max, .. }) => {
                let range = [0.0, *max as f32];
                Paint::VertexValues(Values { values, map: ColorMap::Heat, range })
            }
            None if self.checker => Paint::Checker { squares: SQUARES },
            None => paint.as_paint(),
        };
        Style {
            size: self.size,
            paint,
            normals: if self.flat { Normals::Flat } else { normals_of(mesh) },
            lighting: if heat.is_some() { Lighting::Soft } else { Lighting::default() },
            wireframe: self.wireframe.then(Wireframe::default),
            ..Style::default()
        }
    }

    fn camera(&self, mesh: &Mesh) -> Camera {
        let [width, height] = self.size.map(f64::from);
        Camera::fit_mesh(mesh, &View { aspect: width / height, ..self.viewpoint.view() })
    }
}
