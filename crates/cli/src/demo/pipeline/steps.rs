//! The steps of the pipeline: what they are for, their commands, files and figures.

use serde_json::Value;

use crate::page::figures::digits;
use crate::text::numbers;

/// A step of the pipeline.
pub struct Step {
    pub name: &'static str,
    pub about: &'static str,
    /// Commands without the name of the program, word by word.
    pub commands: &'static [&'static [&'static str]],
    /// Files that the step adds to the folder.
    pub files: &'static [&'static str],
    /// File whose mesh the picture shows.
    pub shown: &'static str,
    /// Function that takes the figure from the JSON of the commands.
    pub figure: fn(&[Value]) -> Figure,
}

/// The one number by which a step is judged.
pub struct Figure {
    pub exact: f64,
    /// The number as shown, with its unit.
    pub number: String,
    /// Words after the number: the thing that it counts or measures.
    pub of: String,
}

impl Figure {
    fn new(exact: f64, number: String, of: impl Into<String>) -> Self {
        Self { exact, number, of: of.into() }
    }

    fn count(number: usize, of: impl Into<String>) -> Self {
        Self::new(number as f64, numbers::count(number), of)
    }

    pub fn text(&self) -> String {
        format!("{} {}", self.number, self.of)
    }
}

/// The broken mesh that the pipeline begins with.
pub const BROKEN: &str = "fish-broken.ply";
const REPAIRED: &str = "fish-repaired.ply";
const SMALL: &str = "fish-small.glb";
const MODEL: &str = "fish.mlod";
const NEAR: &str = "fish-near.glb";
/// Lists of the vertices of all strips.
pub const STRIPS: &str = "fish-strips.json";
const SENT: &str = "fish.mlz";

/// A camera close to the head.
const CAMERA: &str = "eye=-1.3,0.15,0.5 look=-0.8,0,0 fov=35 640x480";

pub const STEPS: [Step; 6] = [
    Step {
        name: "Check",
        about: "A fish with a hole, a tear, faces that look inwards, and others that are there twice. \
                Colours mark the places; the page of --out lists them, with what to do about each.",
        commands: &[&["check", BROKEN]],
        files: &[BROKEN],
        shown: BROKEN,
        figure: |json| Figure::count(defects(&json[0]), "defects are found"),
    },
    Step {
        name: "Repair",
        about: "Copies go, faces turn, the tear is sewn, and the hole is closed. The second command \
                checks the file that was written.",
        commands: &[&["repair", BROKEN, REPAIRED, "--holes", "64"], &["check", REPAIRED]],
        files: &[REPAIRED],
        shown: REPAIRED,
        figure: |json| Figure::count(defects(&json[1]), "defects are left"),
    },
    Step {
        name: "Simplify",
        about: "No point of the level is farther than 0.2% of the diagonal from the original, and none of \
                the original farther from the level. That is proved, not estimated.",
        commands: &[&["simplify", "fish.ply", SMALL, "--error", "0.2%"]],
        files: &[SMALL],
        shown: SMALL,
        figure: |json| {
            let [faces, all] = ["output_faces", "input_faces"].map(|field| number(&json[0], field));
            Figure::count(faces, format!("of {} faces are enough", numbers::count(all)))
        },
    },
    Step {
        name: "All levels in one file",
        about: "From everything between a handful of faces and all of them, a cut that is off by at most \
                two pixels for a camera close to the head, and as coarse as may be elsewhere.",
        commands: &[
            &["build", "fish.ply", MODEL],
            &["extract", MODEL, NEAR, "--error", "2px", "--camera", CAMERA],
        ],
        files: &[MODEL, NEAR],
        shown: NEAR,
        figure: |json| Figure::count(number(&json[1], "faces"), "faces for that camera"),
    },
    Step {
        name: "Strips",
        about: "The faces of that level in long strips, a colour each. At seams of the texture a strip ends.",
        commands: &[&["strip", SMALL, "--out", STRIPS]],
        files: &[STRIPS],
        shown: SMALL,
        figure: |json| {
            let level = &json[0]["levels"][0];
            let [sent, drawn] =
                ["vertices_sent", "triangles"].map(|field| number(level, field) as f64);
            Figure::new(
                sent / drawn,
                format!("{:.2}", sent / drawn),
                "vertices a triangle; a list takes three",
            )
        },
    },
    Step {
        name: "Compress",
        about: "Positions, faces, normals, texture coordinates and colours in one small file, here \
                unpacked again.",
        commands: &[&["compress", "fish.ply", SENT, "--bits", "11"]],
        files: &[SENT],
        shown: SENT,
        figure: |json| {
            let [bytes, vertices] =
                ["bytes_total", "vertices"].map(|field| number(&json[0], field) as f64);
            Figure::new(
                bytes / vertices,
                digits(bytes / vertices),
                "bytes a vertex, with all attributes",
            )
        },
    },
];

/// Returns whether a word of a command is the name of a file in the folder.
pub fn is_file(word: &str) -> bool {
    word == "fish.ply" || STEPS.iter().any(|step| step.files.contains(&word))
}

fn defects(check: &Value) -> usize {
    number(check, "errors") + number(check, "warnings")
}

fn number(json: &Value, field: &str) -> usize {
    json[field].as_u64().unwrap_or_default() as usize
}
