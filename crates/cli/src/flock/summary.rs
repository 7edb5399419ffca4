//! Answer of `flock`: one object, or a few lines.

use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::Budget;
use serde_json::{Value, json};

use crate::flock::model::FlockModel;
use crate::flock::shoot::Take;
use crate::session::files;
use crate::text::numbers::{count, faces, percent, plural, value};
use crate::verbs::flock::Flock;

/// Film with its model, levels and figures.
pub struct Summary<'a> {
    pub options: &'a Flock,
    pub model: &'a FlockModel,
    pub table: &'a LevelTable,
    pub build_seconds: f64,
    pub budget: Budget,
    pub take: &'a Take,
}

impl Summary<'_> {
    pub fn json(&self) -> Value {
        let Self { options, model, table, budget, .. } = self;
        let figures = &self.take.figures;
        let has_budget = options.school.policy.has_budget();
        let whole = table.chains[0].levels.clone();
        json!({
            "model": {
                "name": model.name,
                "faces": model.faces,
                "forward": model.forward.to_string(),
                "forward_guessed": model.is_guessed,
                "up": model.up.to_string(),
            },
            "levels": {
                "method": options.model.method.name(),
                "faces": whole.map(|level| table.triangle_count(level)).collect::<Vec<_>>(),
                "chains": table.chains.len(),
                "vertices": table.positions.len(),
                "triangles": table.triangles.len(),
                "build_seconds": self.build_seconds,
            },
            "policy": options.school.policy.name(),
            "triangles": has_budget.then_some(budget.triangles),
            "detail": (!has_budget).then_some(options.detail),
            "impostors_below_px": options.impostors,
            "camera": options.school.camera.name(),
            "members": options.school.members,
            "schools": options.school.schools,
            "seed": options.seed,
            "frames": figures.frames.len(),
            "fps": options.fps,
            "size": options.size,
            "mean": {
                "members_in_view": figures.mean(|frame| frame.members_in_view as f64),
                "triangles": figures.mean(|frame| frame.triangles as f64),
                "impostors": figures.mean(|frame| frame.impostors as f64),
                "full_triangles": figures.mean(|frame| frame.full_triangles as f64),
                "simulation_ms": figures.mean(|frame| frame.simulation_ms),
                "selection_ms": figures.mean(|frame| frame.selection_ms),
                "draw_ms": self.draw_ms(),
            },
            "triangles_share": figures.share(),
            "total": {
                "triangles": figures.total(|frame| frame.triangles),
                "full_triangles": figures.total(|frame| frame.full_triangles),
                "switches": figures.total(|frame| frame.switches),
            },
            "switches_per_member_second": figures.switches_per_member_second(options.fps),
            "out": files::name(&options.out),
            "figures": files::name(&self.take.lines),
            "recording": options.record.as_deref().map(files::name),
            "pictures": if options.no_pictures { 0 } else { figures.frames.len() },
        })
    }

    pub fn text(&self) -> String {
        let Self { options, model, .. } = self;
        let figures = &self.take.figures;
        let [width, height] = options.size;
        let guessed = if model.is_guessed { " (guessed; --forward sets it)" } else { "" };
        let frames = figures.frames.len();
        let mean = |figure: f64| count(figure.round() as usize);
        let mut text = format!(
            "{}: {frames} frame{} of {width} x {height}, camera {}, policy {}\n",
            files::name(&options.out),
            plural(frames),
            options.school.camera.name(),
            options.school.policy.name()
        );
        text += &format!(
            "{} member{} of {}: {}, swims towards {}{guessed}\n",
            count(options.school.members),
            plural(options.school.members),
            model.name,
            faces(model.faces),
            model.forward
        );
        text += &format!(
            "triangles a frame: {} of {} ({}), {} members in view\n",
            mean(figures.mean(|frame| frame.triangles as f64)),
            mean(figures.mean(|frame| frame.full_triangles as f64)),
            percent(100.0 * figures.share().unwrap_or(f64::NAN)),
            mean(figures.mean(|frame| frame.members_in_view as f64))
        );
        text += &format!(
            "level switches: {} per member in view per second\n",
            value(rounded(figures.switches_per_member_second(options.fps)))
        );
        let selection = value(rounded(figures.mean(|frame| frame.selection_ms)));
        text += &format!("selection: {selection} ms a frame");
        if let Some(draw_ms) = self.draw_ms() {
            text += &format!(", drawing: {} ms", value(rounded(draw_ms)));
        }
        text += "\n";
        text += &format!("{}\n", files::name(&self.take.lines));
        if let Some(folder) = &options.record {
            text += &format!("{}\n", files::name(folder));
        }
        text
    }

    /// Returns the mean time for drawing a frame, if pictures were drawn.
    fn draw_ms(&self) -> Option<f64> {
        let drawn = !self.options.no_pictures;
        drawn.then(|| self.take.figures.mean(|frame| frame.draw_ms.unwrap_or(0.0)))
    }
}

/// Rounds to thousandths.
fn rounded(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}
