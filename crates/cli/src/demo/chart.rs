//! Error against faces, both by decades, as a drawing within the page.

use maud::{Markup, html};

use crate::demo::chain::Chain;
use crate::demo::exhibit::Exhibit;
use crate::demo::figures::{COLORS, key};

/// Width and height in its own units.
const SIZE: [f64; 2] = [440.0, 330.0];
/// Left, right, top, bottom of the plot within.
const PLOT: [f64; 4] = [58.0, 428.0, 12.0, 288.0];
/// Decades below this percentage are not drawn: an error there is rounding.
const LEAST_DECADE: i32 = -5;

/// One line a method: faces and RMS error in percent of the diagonal.
pub fn chart(exhibit: &Exhibit) -> Markup {
    let axes = Axes::of(&exhibit.chains);
    let alt = format!("RMS error against faces, {}: one line per method", exhibit.subject.title);
    html! {
        figure.chart {
            svg viewBox=(format!("0 0 {} {}", SIZE[0], SIZE[1])) role="img" aria-label=(alt) {
                (axes.grid())
                @for (i, chain) in exhibit.chains.iter().enumerate() { (axes.line(i, chain)) }
            }
            figcaption {
                p {
                    @for (i, chain) in exhibit.chains.iter().enumerate() {
                        span.series { (key(i)) (chain.method.name()) } " "
                    }
                }
                p { "RMS error in percent of the diagonal, against faces. Both axes go by decades." }
            }
        }
    }
}

/// The logarithms that the sides of the plot stand for.
struct Axes {
    faces: [f64; 2],
    /// Whole decades of percent.
    error: [i32; 2],
}

/// How far the outermost points stay from the sides, in decades.
const MARGIN: f64 = 0.08;

impl Axes {
    fn of(chains: &[Chain]) -> Self {
        let (mut faces, mut error) = ([f64::INFINITY, 0.0], [0, LEAST_DECADE + 1]);
        for [x, y] in chains.iter().flat_map(points) {
            faces = [faces[0].min(x - MARGIN), faces[1].max(x + MARGIN)];
            error = [error[0].min(y.floor() as i32), error[1].max(y.ceil() as i32)];
        }
        Self { faces, error }
    }

    fn x(&self, faces: f64) -> f64 {
        let t = (faces - self.faces[0]) / (self.faces[1] - self.faces[0]);
        PLOT[0] + t * (PLOT[1] - PLOT[0])
    }

    fn y(&self, error: f64) -> f64 {
        let [low, high] = self.error.map(f64::from);
        PLOT[3] - (error - low) / (high - low) * (PLOT[3] - PLOT[2])
    }

    /// Lines at the decades, and what they stand for.
    fn grid(&self) -> Markup {
        let faces = [1.0, 2.0, 5.0]
            .into_iter()
            .flat_map(|step| (1..8).map(move |decade| step * 10f64.powi(decade)))
            .filter(|faces| (self.faces[0]..self.faces[1]).contains(&faces.log10()));
        html! {
            @for decade in self.error[0]..=self.error[1] {
                @let y = short(self.y(decade.into()));
                line.rule x1=(PLOT[0]) x2=(PLOT[1]) y1=(y) y2=(y) {}
                text x=(PLOT[0] - 8.0) y=(y) dy="0.32em" text-anchor="end" { (percent(decade)) }
            }
            @for faces in faces {
                @let x = short(self.x(faces.log10()));
                line.tick x1=(x) x2=(x) y1=(PLOT[3]) y2=(PLOT[3] + 5.0) {}
                text x=(x) y=(PLOT[3] + 19.0) text-anchor="middle" { (thousands(faces)) }
            }
            text x=(PLOT[1]) y=(PLOT[3] + 37.0) text-anchor="end" { "faces" }
        }
    }

    fn line(&self, method: usize, chain: &Chain) -> Markup {
        let places: Vec<[String; 2]> =
            points(chain).map(|[x, y]| [short(self.x(x)), short(self.y(y))]).collect();
        let path: Vec<String> = places.iter().map(|place| place.join(",")).collect();
        html! {
            g class=(format!("series m{}", method % COLORS)) {
                polyline points=(path.join(" ")) {}
                @for [x, y] in &places { circle cx=(x) cy=(y) r="3.5" {} }
            }
        }
    }
}

/// The levels of a chain as logarithms: of faces, of percent.
fn points(chain: &Chain) -> impl Iterator<Item = [f64; 2]> {
    chain.levels.iter().map(|level| {
        let percent = level.distance.percent(level.distance.rms());
        let error = percent.log10().max(LEAST_DECADE.into());
        [(level.report.output_faces as f64).log10(), error]
    })
}

/// A tenth of a unit is finer than a screen.
fn short(length: f64) -> String {
    format!("{length:.1}")
}

fn percent(decade: i32) -> String {
    match decade {
        LEAST_DECADE => "0".into(),
        _ => format!("{}%", 10f64.powi(decade)),
    }
}

fn thousands(faces: f64) -> String {
    if faces < 1000.0 { format!("{faces}") } else { format!("{}k", faces / 1000.0) }
}
