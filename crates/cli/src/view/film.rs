//! Filming by a script: the pictures and figures of a model, without a window.

use std::path::{Path, PathBuf};

use meshlod::io::write_file;
use meshlod_view::Gpu;
use meshlod_view::script::{Script, ScriptFilm};
use meshlod_view::stage::Loaded;
use serde_json::{Value, json};

use crate::options::args::ReadArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::count;

/// Draws the frames that a script describes.
pub fn run(
    inputs: &[PathBuf],
    reading: &ReadArgs,
    script_path: &Path,
    out: &Path,
    session: &Session,
) -> Result<Answer, Failure> {
    let [input] = inputs else {
        return Err(Failure::usage(format_args!(
            "--script needs exactly one FILE, not {}",
            inputs.len()
        )));
    };
    files::check_folder(out)?;
    let text =
        std::fs::read_to_string(script_path).map_err(|error| Failure::at(script_path, error))?;
    let script = Script::parse(&text).map_err(|error| Failure::at(script_path, error))?;
    let (frames, size) = (script.frames as usize, script.size);
    let gpu = Gpu::headless().map_err(Failure::new)?;
    session.progress.stage(&format!("reading {}", files::name(input)));
    let loaded = Loaded::read(input, &reading.options()).map_err(Failure::new)?;
    loaded.warnings.iter().for_each(|line| session.warn(line));
    let mut film =
        ScriptFilm::new(&gpu, script, &loaded).map_err(|error| Failure::at(input, error))?;
    files::make_folder(out)?;
    let mut lines = Vec::with_capacity(frames);
    while let Some(frame) = film.next_frame() {
        let frame = frame.map_err(|error| Failure::at(input, error))?;
        session.progress.part("filming", frame.frame as usize, frames);
        write_file(&out.join(format!("frame_{:04}.png", frame.frame)), &frame.picture.png())?;
        lines.push(json!(frame));
    }
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    write_file(&out.join("frames.jsonl"), text.as_bytes())?;
    Ok(summary(&gpu, size, out, &lines))
}

/// Sums up a film; what the first frame sends is the whole cut, and counts apart.
fn summary(gpu: &Gpu, [width, height]: [u32; 2], out: &Path, lines: &[Value]) -> Answer {
    let median = |name: &str| {
        let mut all: Vec<f64> = lines.iter().filter_map(|line| line[name].as_f64()).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let changed = lines.iter().skip(1).map(|line| {
        let [sent, all] = ["sent_bytes", "index_bytes"].map(|name| line[name].as_f64());
        sent.unwrap_or(0.0) / all.filter(|&all| all > 0.0).unwrap_or(f64::INFINITY)
    });
    let most_sent = changed.fold(0.0, f64::max);
    let [faces, draw_ms] = ["faces", "draw_ms"].map(median);
    let folder = files::name(out);
    let json = json!({
        "folder": folder,
        "gpu": gpu.name(),
        "frames": lines.len(),
        "width": width,
        "height": height,
        "faces_median": faces,
        "draw_ms_median": draw_ms,
        "sent_part_max": most_sent,
    });
    let mut text = format!(
        "{folder}: {} pictures of {width} x {height} by {}\n{} faces and {draw_ms:.1} ms a frame \
         (medians)\n",
        count(lines.len()),
        gpu.name(),
        count(faces as usize),
    );
    if most_sent > 0.0 {
        text += &format!("at most {:.2}% of the faces sent between frames\n", 100.0 * most_sent);
    }
    Answer::new(json, text)
}
