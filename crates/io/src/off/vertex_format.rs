//! Attributes of OFF vertices, from the header or, in plain files, from the number of values per
//! line.

use crate::error::ParseError;
use crate::text::cursor::TextCursor;

/// Largest deviation of a unit normal from length 1.
const ROUNDING: f64 = 1e-2;

/// Attributes that follow each vertex position, in this order.
#[derive(Clone, Copy, Default)]
pub(super) struct VertexFormat {
    pub has_normal: bool,
    /// Colour components: 0 without colours, 3 until the first vertex is seen.
    pub color_width: usize,
    pub has_uv: bool,
}

impl VertexFormat {
    /// Reports whether the header names no attributes.
    pub fn is_plain(self) -> bool {
        !self.has_normal && self.color_width == 0 && !self.has_uv
    }

    /// Derives the number of colour components from the numbers on the line of the first vertex.
    pub fn measure_color(&mut self, text: &TextCursor) -> Result<(), ParseError> {
        if self.color_width == 0 {
            return Ok(());
        }
        let others = 3 + if self.has_normal { 3 } else { 0 } + if self.has_uv { 2 } else { 0 };
        let words = text.clone().words_left();
        match words.checked_sub(others) {
            Some(width @ (3 | 4)) => {
                self.color_width = width;
                Ok(())
            }
            _ => Err(text.error(format!(
                "this header calls for {} or {} numbers per vertex, but this line has {words}",
                others + 3,
                others + 4
            ))),
        }
    }

    /// Detects which attributes follow the positions, from the numbers on each line: three or four
    /// non-negative numbers are colours; three numbers of unit length with negative ones among them
    /// are normals. `text` is at the first vertex.
    ///
    /// Detects nothing unless each vertex and face has its own line.
    /// # Errors
    /// Numbers that are neither colours nor normals.
    pub fn of_lines(text: &TextCursor, vertices: usize, faces: usize) -> Result<Self, ParseError> {
        let none = Self::default();
        let mut first = text.clone();
        first.more_anywhere();
        let words = first.clone().words_left();
        if words <= 3 || !has_lines(text, words, vertices, faces) {
            return Ok(none);
        }
        let calls = format!("the header calls for 3 numbers per vertex, but all have {words}");
        if !matches!(words, 6 | 7) {
            return Err(first.error(calls));
        }
        let (mut is_unit, mut negative) = (words == 6, None);
        let mut lines = text.clone();
        for _ in 0..vertices {
            lines.more_anywhere();
            let mut values = [0.0; 7];
            for value in &mut values[..words] {
                *value = lines.attribute("a vertex is missing")?.into();
            }
            let more: &[f64] = &values[3..words];
            is_unit &= (more.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() <= 2.0 * ROUNDING;
            negative = negative.or_else(|| more.iter().any(|&x| x < 0.0).then(|| lines.clone()));
        }
        match negative {
            None => Ok(Self { color_width: words - 3, ..none }),
            Some(_) if is_unit => Ok(Self { has_normal: true, ..none }),
            Some(line) => Err(line.error(format!(
                "{calls}, and the last {} of this one are neither a colour nor a unit normal",
                words - 3
            ))),
        }
    }
}

/// Reports whether each vertex has its own line of this many words, followed by a line for each
/// face.
fn has_lines(text: &TextCursor, words: usize, vertices: usize, faces: usize) -> bool {
    let mut lines = text.clone();
    (0..vertices).all(|_| lines.more_anywhere() && lines.words_left() == words)
        && (0..faces).all(|_| lines.more_anywhere() && lines.words_left() > 0)
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::LayerKind;

    use crate::off::read;

    /// Kind of the layer and its first values, of a triangle whose vertices have this too.
    fn layer(more: [&str; 3]) -> Result<Option<(LayerKind, Vec<f32>)>, String> {
        let [a, b, c] = more;
        let text = format!("OFF\n3 1 0\n0 0 0 {a}\n1 0 0 {b}\n0 1 0 {c}\n3 0 1 2\n");
        let mesh = read(text.as_bytes()).map_err(|error| error.to_string())?;
        let layers = mesh.attributes.map_or_else(Vec::new, |own| own.layers);
        Ok(layers.first().map(|own| (own.kind, own.values[..own.width].to_vec())))
    }

    #[test]
    fn colours_and_normals_are_distinguished() {
        let color = |values: &[f32]| Ok(Some((LayerKind::Color(0), values.to_vec())));
        assert_eq!(layer([""; 3]), Ok(None));
        assert_eq!(layer(["255 0 51", "0 255 0", "0 0 255"]), color(&[1.0, 0.0, 0.2]));
        assert_eq!(layer(["1 0 .5 1", "0 1 0 1", "0 0 1 1"]), color(&[1.0, 0.0, 0.5, 1.0]));
        let normals = layer(["0 0 -1", "0 .6 .8", "1 0 0"]);
        assert_eq!(normals, Ok(Some((LayerKind::Normal, vec![0.0, 0.0, -1.0]))));
        let odd = layer(["1 2 3", "1 -2 3", "1 2 3"]).unwrap_err();
        assert_eq!(
            odd,
            "line 4: the header calls for 3 numbers per vertex, but all have 6, and the last 3 of \
             this one are neither a colour nor a unit normal"
        );
    }

    #[test]
    fn other_numbers_are_an_error() {
        let odd = layer(["7"; 3]).unwrap_err();
        assert_eq!(odd, "line 3: the header calls for 3 numbers per vertex, but all have 4");
    }

    #[test]
    fn vertices_that_share_lines_have_no_colours() {
        let text = "OFF\n4 2 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n3 0 1 2\n3 0 2 3\n";
        let mesh = read(text.as_bytes()).unwrap();
        assert!(mesh.attributes.is_none());
        assert_eq!(mesh.positions[3], [0.0, 1.0, 0.0]);
    }
}
