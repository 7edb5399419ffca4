//! Pictures of a mesh and its simplified levels from one viewpoint.

use meshlod::Mesh;
use meshlod::measure::{PreparedSurface, vertex_errors};
use meshlod::picture::{Background, Camera, Lighting, Normals, Paint, Style, View, render};

use crate::page::heat;
use crate::page::inline_picture::InlinePicture;
use crate::page::refine::refined;
use crate::page::style::SubjectStyle;
use crate::page::subject::Subject;
use crate::session::failure::Failure;
use crate::text::numbers;

/// Width and height of the pictures in pixels: twice the displayed size, for high-resolution
/// screens.
pub const SIZE: [u32; 2] = [384, 320];

/// Width and height of pictures that have more to show when they are enlarged.
pub const LARGE: [u32; 2] = [576, 480];

/// Pictures of a mesh or of one of its simplified levels.
pub struct LevelPictures {
    pub shaded: InlinePicture,
    pub wired: InlinePicture,
    /// Heat map of the distance from the original mesh; only for a simplified level.
    pub heat: Option<InlinePicture>,
}

/// Renderer of a mesh and its simplified levels with a fixed camera.
pub struct SubjectRenderer<'s> {
    subject: &'s Subject,
    original: &'s PreparedSurface<'s>,
    camera: Camera,
    /// Width and height of the pictures in pixels.
    size: [u32; 2],
}

impl<'s> SubjectRenderer<'s> {
    pub fn new(subject: &'s Subject, original: &'s PreparedSurface<'s>, size: [u32; 2]) -> Self {
        let camera = Camera::fit_mesh(&subject.mesh, &view(&subject.style, size, 0.94));
        Self { subject, original, camera, size }
    }

    /// Draws the pictures of the original mesh.
    pub fn input(&self) -> Result<LevelPictures, Failure> {
        self.pictures(&self.subject.mesh, "")
    }

    /// Draws the pictures of a simplified level; `by` is the name of its method.
    pub fn level(&self, shown: &Mesh, by: &str) -> Result<LevelPictures, Failure> {
        let heat = Some(self.heat(shown, by)?);
        Ok(LevelPictures { heat, ..self.pictures(shown, by)? })
    }

    fn pictures(&self, mesh: &Mesh, by: &str) -> Result<LevelPictures, Failure> {
        let (title, faces) = (&self.subject.title, faces(mesh, by));
        Ok(LevelPictures {
            shaded: self.picture(
                mesh,
                self.subject.style.shaded(),
                format!("{title}, shaded, {faces}"),
            )?,
            wired: self.picture(
                mesh,
                self.subject.style.wired(),
                format!("{title} with its edges drawn, {faces}"),
            )?,
            heat: None,
        })
    }

    /// Draws the level coloured by its distance from the input.
    fn heat(&self, level: &Mesh, by: &str) -> Result<InlinePicture, Failure> {
        let diagonal = self.original.diagonal();
        let mesh = refined(level, diagonal * HEAT_STEP);
        let values = heat::values(&vertex_errors(&mesh, self.original), diagonal);
        let style = Style {
            paint: Paint::VertexValues(heat::scale(&values)),
            lighting: Lighting::Soft,
            normals: Normals::Flat,
            single_sided: &self.subject.style.single_sided,
            ..Style::default()
        };
        let title = &self.subject.title;
        let alt = format!("Heat map of the error of {title} at {}", faces(level, by));
        self.picture(&mesh, style, alt)
    }

    /// Renders with a transparent background.
    fn picture(
        &self,
        mesh: &Mesh,
        style: Style<'_>,
        alt: String,
    ) -> Result<InlinePicture, Failure> {
        let style = Style { size: self.size, background: Background::Transparent, ..style };
        let picture = render(mesh, &self.camera, &style).map_err(Failure::new)?;
        Ok(InlinePicture::new(&picture, alt))
    }
}

/// Spacing of error samples on the surface, as a fraction of the diagonal: about three pixels.
const HEAT_STEP: f64 = 0.01;

/// Field of view of the shorter side, in radians: about 20°, like a long lens.
const FOV_RAD: f64 = 0.35;

/// Returns the view of a mesh for a picture of this size in pixels; `fill` as in [`View`].
pub fn view(style: &SubjectStyle, size: [u32; 2], fill: f64) -> View {
    let [width, height] = size.map(f64::from);
    View {
        direction: style.direction,
        up: style.up,
        fov_rad: FOV_RAD,
        fill,
        aspect: width / height,
    }
}

/// Returns the view in a given direction, with the y axis up.
pub fn view_from(direction: [f64; 3], size: [u32; 2]) -> View {
    let [width, height] = size.map(f64::from);
    let view = View { direction, fov_rad: FOV_RAD, fill: 0.94, ..View::default() };
    View { aspect: width / height, ..view }
}

fn faces(mesh: &Mesh, by: &str) -> String {
    let faces = numbers::faces(mesh.faces.len());
    if by.is_empty() { faces } else { format!("{faces} by {by}") }
}
