//! Pictures of a subject and its levels, all from one place.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use meshlod::Mesh;
use meshlod::measure::{Surface, vertex_errors};
use meshlod::picture::{
    Background, Camera, Lighting, Normals, Paint, Picture, Style, View, render,
};

use crate::failure::Failure;
use crate::numbers;
use crate::page::heat;
use crate::page::look::Look;
use crate::page::refine::refined;
use crate::page::subject::Subject;

/// Width and height of the pictures on the page: twice what they are shown at, for fine screens.
pub const SIZE: [u32; 2] = [384, 320];

/// A picture that is part of the page.
pub struct Plate {
    /// The whole PNG.
    pub uri: String,
    /// What it shows, for those who cannot see it.
    pub alt: String,
}

/// The pictures of a subject or of one of its levels.
pub struct Shots {
    pub shaded: Plate,
    pub wired: Plate,
    /// Of a level: how far it is from the input.
    pub heat: Option<Plate>,
}

/// A camera before a subject.
pub struct Studio<'s> {
    subject: &'s Subject,
    original: &'s Surface<'s>,
    camera: Camera,
}

impl<'s> Studio<'s> {
    pub fn new(subject: &'s Subject, original: &'s Surface<'s>) -> Self {
        let camera = Camera::fit_mesh(&subject.mesh, &view(&subject.look, SIZE, 0.94));
        Self { subject, original, camera }
    }

    /// The pictures of the subject.
    pub fn input(&self) -> Result<Shots, Failure> {
        self.shots(&self.subject.mesh, "")
    }

    /// The pictures of a level; `by` says whose.
    pub fn level(&self, shown: &Mesh, by: &str) -> Result<Shots, Failure> {
        let heat = Some(self.heat(shown, by)?);
        Ok(Shots { heat, ..self.shots(shown, by)? })
    }

    fn shots(&self, mesh: &Mesh, by: &str) -> Result<Shots, Failure> {
        let (title, faces) = (&self.subject.title, faces(mesh, by));
        Ok(Shots {
            shaded: self.plate(
                mesh,
                self.subject.look.shaded(),
                format!("{title}, shaded, {faces}"),
            )?,
            wired: self.plate(
                mesh,
                self.subject.look.wired(),
                format!("{title} with its edges drawn, {faces}"),
            )?,
            heat: None,
        })
    }

    /// The level, coloured by how far it is from the input.
    fn heat(&self, level: &Mesh, by: &str) -> Result<Plate, Failure> {
        let diagonal = self.original.diagonal();
        let mesh = refined(level, diagonal * HEAT_STEP);
        let values = heat::values(&vertex_errors(&mesh, self.original), diagonal);
        let style = Style {
            paint: Paint::VertexValues(heat::scale(&values)),
            lighting: Lighting::Soft,
            normals: Normals::Flat,
            ..Style::default()
        };
        let title = &self.subject.title;
        let alt = format!("Heat map of the error of {title} at {}", faces(level, by));
        self.plate(&mesh, style, alt)
    }

    /// The page shows behind it.
    fn plate(&self, mesh: &Mesh, style: Style<'_>, alt: String) -> Result<Plate, Failure> {
        let style = Style { size: SIZE, background: Background::Transparent, ..style };
        let picture = render(mesh, &self.camera, &style).map_err(Failure::new)?;
        Ok(Plate { uri: uri(&picture), alt })
    }
}

/// Errors are looked up this close, as a part of the diagonal: some three pixels.
const HEAT_STEP: f64 = 0.01;

/// The angle that the shorter side sees, in radians: about 20°, as of a long lens.
const FOV_RAD: f64 = 0.35;

/// Where a look wants to be seen from, in a picture of a size; `fill` as in [`View`].
pub fn view(look: &Look, size: [u32; 2], fill: f64) -> View {
    let [width, height] = size.map(f64::from);
    View { direction: look.direction, up: look.up, fov_rad: FOV_RAD, fill, aspect: width / height }
}

/// The same in a direction, y up.
pub fn view_from(direction: [f64; 3], size: [u32; 2]) -> View {
    let [width, height] = size.map(f64::from);
    let view = View { direction, fov_rad: FOV_RAD, fill: 0.94, ..View::default() };
    View { aspect: width / height, ..view }
}

/// A picture as part of a page.
pub fn uri(picture: &Picture) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(picture.png()))
}

fn faces(mesh: &Mesh, by: &str) -> String {
    let faces = numbers::faces(mesh.faces.len());
    if by.is_empty() { faces } else { format!("{faces} by {by}") }
}
