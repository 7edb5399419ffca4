//! Syntax of MTL statements: keywords, options and image names.

/// Returns the keyword of a statement in lower case, since exporters disagree on its case; empty
/// for comments and blank lines.
pub(super) fn word_of(line: &str) -> String {
    let word = split_word(line.trim_start()).0;
    if word.starts_with('#') { String::new() } else { word.to_ascii_lowercase() }
}

/// Splits off the first word of a text and the following blanks.
pub(super) fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// Reports whether statements with this word name an image.
pub(super) fn names_image(word: &str) -> bool {
    // `map_aat` turns on anti-aliasing.
    word.starts_with("map_") && word != "map_aat"
        || ["bump", "disp", "decal", "refl", "norm"].contains(&word)
}

/// Option of a statement that names an image, with its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MapOption<'a> {
    /// Name of the option, with its dash.
    pub name: &'a str,
    /// Values of the option, with blanks between them.
    pub values: &'a str,
}

/// Splits an image statement into its options and the rest, which contains the name.
pub(super) fn options(line: &str) -> (Vec<MapOption<'_>>, &str) {
    let mut rest = split_word(line.trim_start()).1;
    let mut options = Vec::new();
    while rest.starts_with('-') {
        let (name, start) = split_word(rest);
        // Otherwise it is not an option but a name that begins with a dash.
        let Some([least, most]) = option_values(name) else { break };
        let mut behind = start;
        for count in 0..most {
            let (value, after) = split_word(behind);
            if count >= least && value.parse::<f32>().is_err() {
                break;
            }
            behind = after;
        }
        options.push(MapOption { name, values: start[..start.len() - behind.len()].trim_end() });
        rest = behind;
    }
    (options, rest)
}

/// Returns the least and largest number of values of an option; `None` if there is no such option.
fn option_values(name: &str) -> Option<[usize; 2]> {
    match name {
        "-mm" => Some([2, 2]),
        "-o" | "-s" | "-t" => Some([1, 3]),
        "-blendu" | "-blendv" | "-boost" | "-bm" | "-cc" | "-clamp" | "-colorspace"
        | "-imfchan" | "-texres" | "-type" => Some([1, 1]),
        _ => None,
    }
}

/// Lists the possible image names at the end of a statement, likeliest first: all of it, the text
/// before a comment, the text in quotes, the text before options.
pub(super) fn image_names(rest: &str) -> Vec<&str> {
    let whole = rest.trim_end();
    let commented = whole.split_once(" #").map(|(name, _)| name.trim_end());
    let quoted = whole.strip_prefix('"').and_then(|rest| Some(rest.split_once('"')?.0));
    let optioned = whole.match_indices(" -").find_map(|(at, _)| {
        let is_known = option_values(split_word(&whole[at + 1..]).0).is_some();
        is_known.then(|| whole[..at].trim_end())
    });
    [Some(whole), commented, quoted, optioned]
        .into_iter()
        .flatten()
        .filter(|name| !name.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_end_where_the_name_begins() {
        let line = "  map_Kd -s 2 2 -o 0 0 0 -clamp on wood grain.png ";
        let (found, rest) = options(line);
        let found: Vec<(&str, &str)> = found.iter().map(|o| (o.name, o.values)).collect();
        assert_eq!(found, [("-s", "2 2"), ("-o", "0 0 0"), ("-clamp", "on")]);
        assert_eq!(image_names(rest), ["wood grain.png"]);
        assert_eq!(options("refl -type sphere -mm 0 1 a.png").1, "a.png");
        assert_eq!(options("norm -x.png"), (vec![], "-x.png"));
        assert_eq!(options("map_Kd"), (vec![], ""));
    }

    #[test]
    fn names_may_be_quoted_or_followed_by_a_comment() {
        assert_eq!(image_names("a.png # old"), ["a.png # old", "a.png"]);
        assert_eq!(image_names("\"a b.png\""), ["\"a b.png\"", "a b.png"]);
        assert_eq!(image_names("a -b.png -bm 0.3"), ["a -b.png -bm 0.3", "a -b.png"]);
        assert!(image_names("  ").is_empty());
    }

    #[test]
    fn words_have_no_case() {
        assert_eq!(word_of("\tMap_BUMP a"), "map_bump");
        assert_eq!(word_of("# Kd 1"), "");
        assert!(names_image("map_bump") && names_image("refl") && !names_image("map_aat"));
    }
}
