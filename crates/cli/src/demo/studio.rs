//! Pictures of a subject and its levels, all from one place.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use meshlod::Mesh;
use meshlod::measure::vertex_errors;
use meshlod::picture::{
    Background, Camera, Lighting, Normals, Paint, Picture, Style, View, Wireframe, render,
};

use crate::demo::chain::{Chain, Level, Original};
use crate::demo::heat;
use crate::demo::refine::refined;
use crate::demo::subjects::Subject;
use crate::failure::Failure;
use crate::numbers::count;

/// Width and height of the pictures on the page: twice what they are shown at, for fine screens.
pub const SIZE: [u32; 2] = [384, 320];

/// A picture that is part of the page.
pub struct Plate {
    /// The whole PNG.
    pub uri: String,
    /// What it shows, for those who cannot see it.
    pub alt: String,
}

/// The pictures of an exhibit: the input, then its levels.
pub struct Pictures {
    pub shaded: Vec<Plate>,
    pub wired: Vec<Plate>,
    /// Of the levels alone.
    pub heat: Vec<Plate>,
}

/// A camera before a subject.
pub struct Studio<'m> {
    subject: &'static Subject,
    original: &'m Original<'m>,
    camera: Camera,
}

impl<'m> Studio<'m> {
    pub fn new(subject: &'static Subject, original: &'m Original<'m>) -> Self {
        let [width, height] = SIZE.map(f64::from);
        let view = View {
            direction: subject.direction,
            fill: 0.94,
            aspect: width / height,
            fov_rad: FOV_RAD,
            ..View::default()
        };
        Self { subject, original, camera: Camera::fit_mesh(original.mesh, &view) }
    }

    /// All pictures of a chain.
    pub fn pictures(&self, chain: &Chain) -> Result<Pictures, Failure> {
        let meshes =
            || std::iter::once(self.original.mesh).chain(chain.levels.iter().map(|l| &l.mesh));
        Ok(Pictures {
            shaded: meshes().map(|mesh| self.shaded(mesh)).collect::<Result<_, _>>()?,
            wired: meshes().map(|mesh| self.wired(mesh)).collect::<Result<_, _>>()?,
            heat: chain.levels.iter().map(|level| self.heat(level)).collect::<Result<_, _>>()?,
        })
    }

    fn shaded(&self, mesh: &Mesh) -> Result<Plate, Failure> {
        let alt = format!("{}, shaded, {}", self.subject.title, faces(mesh));
        self.plate(mesh, &style(self.subject), alt)
    }

    fn wired(&self, mesh: &Mesh) -> Result<Plate, Failure> {
        let alt = format!("{} with its edges drawn, {}", self.subject.title, faces(mesh));
        self.plate(mesh, &wired(self.subject), alt)
    }

    /// The level, coloured by how far it is from the input.
    fn heat(&self, level: &Level) -> Result<Plate, Failure> {
        let diagonal = level.distance.diagonal;
        let mesh = refined(&level.mesh, diagonal * HEAT_STEP);
        let values = heat::values(&vertex_errors(&mesh, &self.original.surface), diagonal);
        let style = Style {
            paint: Paint::VertexValues(heat::scale(&values)),
            lighting: Lighting::Soft,
            normals: Normals::Flat,
            ..style(self.subject)
        };
        let title = self.subject.title;
        let alt = format!("Heat map of the error of the {title} at {}", faces(&level.mesh));
        self.plate(&mesh, &style, alt)
    }

    fn plate(&self, mesh: &Mesh, style: &Style, alt: String) -> Result<Plate, Failure> {
        let picture = render(mesh, &self.camera, style).map_err(Failure::new)?;
        Ok(Plate { uri: uri(&picture), alt })
    }
}

/// Errors are looked up this close, as a part of the diagonal: some three pixels.
const HEAT_STEP: f64 = 0.01;

/// The angle that the shorter side sees, in radians: about 20°, as of a long lens.
pub const FOV_RAD: f64 = 0.35;

/// A subject as it is; the page shows behind.
pub fn style(subject: &Subject) -> Style<'static> {
    Style {
        size: SIZE,
        paint: (subject.paint)(),
        normals: subject.normals,
        background: Background::Transparent,
        ..Style::default()
    }
}

/// The same with every face shown.
pub fn wired(subject: &Subject) -> Style<'static> {
    let wireframe =
        Wireframe { color: subject.lines, width_px: 0.9, opacity: subject.line_opacity };
    Style { wireframe: Some(wireframe), normals: Normals::Flat, ..style(subject) }
}

pub fn uri(picture: &Picture) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(picture.png()))
}

fn faces(mesh: &Mesh) -> String {
    format!("{} faces", count(mesh.faces.len()))
}
