//! Polypaint of ZBrush: colours of vertices in comments, as in `#MRGB ffff0000ff00ff00`.

/// Colours and masks from comments, in the order of the vertices.
#[derive(Default)]
pub(super) struct Polypaint {
    pub colors: Vec<[f32; 3]>,
    /// Number of vertices that are partly or fully masked.
    pub masked: usize,
}

impl Polypaint {
    /// Adds the vertices on a line after `#MRGB`, with two hexadecimal digits each for mask, red,
    /// green and blue. The rest of the line after an invalid number is a comment.
    pub fn add(&mut self, line: &[u8]) {
        for digits in line.trim_ascii().chunks_exact(8) {
            let text = std::str::from_utf8(digits).ok();
            let text = text.filter(|text| text.bytes().all(|byte| byte.is_ascii_hexdigit()));
            let Some(value) = text.and_then(|text| u32::from_str_radix(text, 16).ok()) else {
                return;
            };
            let [mask, r, g, b] = value.to_be_bytes();
            self.masked += usize::from(mask != u8::MAX);
            self.colors.push([r, g, b].map(|x| f32::from(x) / 255.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_eight_digits_give_colours() {
        let mut paint = Polypaint::default();
        paint.add(b" ffff0000 is no colour");
        paint.add(b"7f00ff00ff0000ff12\r");
        paint.add(b"+f00ff00");
        let [red, green, blue] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!((paint.colors, paint.masked), (vec![red, green, blue], 1));
    }
}
