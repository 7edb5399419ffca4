//! Pictures of the steps, all from one side.

use std::path::Path;

use meshlod::Mesh;
use meshlod::jobs::CheckRequest;
use meshlod::mesh::VertexId;
use meshlod::picture::{Background, Camera, Lighting, Normals, Paint, Picture, Style, render};
use meshlod::strip::Strips;
use serde_json::Value;

use crate::check::drawing::{Drawing, Part};
use crate::check::inspection::Inspection;
use crate::demo::pipeline::steps::{BROKEN, Figure, STRIPS, Step};
use crate::options::args::ReadArgs;
use crate::page::inline_picture::InlinePicture;
use crate::page::renderer::view;
use crate::page::subject::Subject;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;

/// Width and height of the pictures in pixels.
const SIZE: [u32; 2] = [480, 400];

/// Painter of the steps of a sample.
pub struct StepPainter<'p> {
    subject: &'p Subject,
    folder: &'p Path,
    camera: Camera,
    session: &'p Session,
}

impl<'p> StepPainter<'p> {
    pub fn new(subject: &'p Subject, folder: &'p Path, session: &'p Session) -> Self {
        let camera = Camera::fit_mesh(&subject.mesh, &view(&subject.style, SIZE, 0.94));
        Self { subject, folder, camera, session }
    }

    /// Draws the mesh of a step: defects marked, strips in colours, or faces with their edges.
    pub fn picture(&self, step: &Step, figure: &Figure) -> Result<InlinePicture, Failure> {
        let path = self.folder.join(step.shown);
        let mesh = files::read(&path, &ReadArgs::default(), self.session)?.into_mesh();
        let picture = if step.shown == BROKEN {
            self.defects(mesh)?
        } else if step.files.contains(&STRIPS) {
            self.strips(&mesh)?
        } else {
            self.draw(&mesh, self.subject.style.wired())?
        };
        Ok(InlinePicture::new(&picture, format!("{}: {}", step.name, figure.text())))
    }

    fn defects(&self, mesh: Mesh) -> Result<Picture, Failure> {
        let inspected = Inspection::marked(mesh, &CheckRequest::default(), &());
        let drawn = inspected.map_err(Failure::new)?.drawn.expect("asked for");
        let drawing = Drawing::new(&drawn.mesh, &drawn.marks, Part::Whole);
        drawing.picture(&self.camera).map_err(Failure::new)
    }

    /// Draws every strip in a colour that differs from those before.
    fn strips(&self, mesh: &Mesh) -> Result<Picture, Failure> {
        let path = self.folder.join(STRIPS);
        let lists = serde_json::from_slice(&files::read_all(&path)?);
        let lists: Value = lists.map_err(|error| Failure::at(&path, error))?;
        let (mut faces, mut colors) = (Vec::new(), Vec::new());
        for (i, strip) in vertices_of(&lists).enumerate() {
            let mut one = Strips::default();
            one.push(strip);
            faces.extend(one.triangles());
            colors.resize(faces.len(), color(i));
        }
        let mesh = Mesh::new(mesh.positions.clone(), faces);
        let style = Style {
            paint: Paint::FaceColors(&colors),
            normals: Normals::Flat,
            lighting: Lighting::Soft,
            wireframe: Some(self.subject.style.wireframe),
            ..Style::default()
        };
        self.draw(&mesh, style)
    }

    fn draw(&self, mesh: &Mesh, style: Style<'_>) -> Result<Picture, Failure> {
        let style = Style { size: SIZE, background: Background::Transparent, ..style };
        render(mesh, &self.camera, &style).map_err(Failure::new)
    }
}

/// Iterates over the strips of the first level, as vertices of the mesh.
fn vertices_of(lists: &Value) -> impl Iterator<Item = Vec<VertexId>> {
    let id = |value: &Value| value.as_u64().unwrap_or_default() as usize;
    let vertex = move |number: &Value| match lists["wedges"].as_array() {
        Some(wedges) => VertexId::new(id(&wedges[id(number)]["vertex"])),
        None => VertexId::new(id(number)),
    };
    let strips = lists["levels"][0]["strips"].as_array().into_iter().flatten();
    strips.map(move |strip| strip.as_array().into_iter().flatten().map(vertex).collect())
}

/// Returns a colour on a circle of hues, turned by the golden angle from strip to strip.
fn color(strip: usize) -> [u8; 3] {
    const TURN: f64 = 0.381_966;
    let hue = 6.0 * (strip as f64 * TURN).fract();
    let channel = |shift: f64| {
        let distance = (hue + shift).rem_euclid(6.0);
        let level = (distance - 3.0).abs() - 1.0;
        (110.0 + 120.0 * level.clamp(0.0, 1.0)) as u8
    };
    [channel(0.0), channel(4.0), channel(2.0)]
}
