//! PLY comments in other formats: `# comment …` and `# obj_info …` lines in text formats, an array
//! in the extras of the asset in glTF.

use std::io;

use serde_json::{Value, json};

use crate::text::cursor::text_of;
use crate::text::line_writer::LineWriter;

/// Writes comments as lines of a text format.
pub(crate) fn write(remarks: &[String], lines: &mut LineWriter) -> io::Result<()> {
    for remark in remarks {
        // A backslash would continue the comment on the next line.
        let end = if remark.ends_with('\\') { " ." } else { "" };
        lines.word(&format!("# {remark}{end}"));
        lines.end()?;
    }
    Ok(())
}

/// Finds the comments written by [`write`], above the first line of data.
pub(crate) fn of_text(bytes: &[u8]) -> Vec<String> {
    let mut remarks = Vec::new();
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii) {
        match line.strip_prefix(b"#") {
            Some(text) => remarks.extend(remark(&text_of(text.trim_ascii()))),
            None if line.is_empty() || line.ends_with(b"OFF") => {}
            None => break,
        }
    }
    remarks
}

/// Puts comments into a glTF document.
pub(crate) fn put(remarks: &[String], document: &mut Value) {
    if !remarks.is_empty() {
        document["asset"]["extras"] = json!({ "comments": remarks });
    }
}

/// Finds the comments stored by [`put`] in a glTF document.
pub(crate) fn of_document(document: &Value) -> Vec<String> {
    let comments = document["asset"]["extras"]["comments"].as_array();
    comments.into_iter().flatten().filter_map(|text| remark(text.as_str()?)).collect()
}

/// Returns the text if it is a valid comment line of a PLY header.
fn remark(text: &str) -> Option<String> {
    let is_remark = matches!(text.split_ascii_whitespace().next(), Some("comment" | "obj_info"));
    let is_line = !text.contains(['\n', '\r']) && text.trim() == text;
    let is_texture = text.split_ascii_whitespace().nth(1) == Some("TextureFile");
    (is_remark && is_line && !is_texture).then(|| text.to_owned())
}

#[cfg(test)]
mod tests {
    use crate::{
        Format, Precision, ReadOptions, Scene, WriteOptions, obj, ply, read_bytes, write_to,
    };

    const PLY: &str = "ply\nformat ascii 1.0\ncomment by  hand\nobj_info scan 7\n\
        element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

    fn read(bytes: &[u8], format: Format) -> Scene {
        read_bytes(bytes, format, &mut |_| None, &ReadOptions::default()).unwrap()
    }

    #[test]
    fn comments_of_ply_survive_the_other_formats() {
        let scene = read(PLY.as_bytes(), Format::Ply);
        let expected = ["comment by  hand", "obj_info scan 7"];
        for format in [Format::Obj, Format::Off, Format::Smf, Format::Glb] {
            assert!(scene.limits_of(format).is_empty(), "{format:?}");
            let mut file = Vec::new();
            write_to(&mut file, &scene, format, &WriteOptions::default()).unwrap();
            let back = read(&file, format);
            assert_eq!(back.ply.remarks, expected, "{format:?}");
            let mut again = Vec::new();
            ply::write_scene(&back, Precision::Auto, &mut again).unwrap();
            let text = String::from_utf8_lossy(&again).into_owned();
            assert!(text.contains("comment by  hand\nobj_info scan 7\n"), "{format:?}: {text}");
        }
        assert_eq!(scene.limits_of(Format::Stl).len(), 2);
    }

    #[test]
    fn other_comments_stay_what_they_were() {
        let text = "# made by a program\n# comment\tours\n# comment TextureFile a.png\n\
            v 0 0 0\n# comment late\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        assert_eq!(read(text.as_bytes(), Format::Obj).ply.remarks, ["comment\tours"]);
        let mut scene = read(text.as_bytes(), Format::Obj);
        scene.ply.remarks = vec!["comment c:\\".to_owned()];
        let mut file = Vec::new();
        obj::write(&scene, Precision::Auto, &mut file, &[]).unwrap();
        assert_eq!(read(&file, Format::Obj).meshes[0].mesh.faces.len(), 1);
    }
}
