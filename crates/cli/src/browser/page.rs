//! The viewer's page with a model in it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::browser::VIEWER;

/// Greatest size of a model in a page, in bytes: browsers have limits for the length of a text.
pub const MOST_BYTES: usize = 256 << 20;

const MODEL: &str = "<!--model-->";
const TITLE: &str = "<title>meshlod</title>";

/// Returns a page that shows an `.mlod` file and needs nothing else; `name` is that of the file.
pub fn with_model(name: &str, model: &[u8]) -> String {
    let name = escaped(name);
    let title = format!("<title>{name} – meshlod</title>");
    let (before, after) = VIEWER.split_once(MODEL).unwrap_or((VIEWER, ""));
    let mut page = before.replacen(TITLE, &title, 1);
    page.reserve(model.len() / 3 * 4 + after.len() + 256);
    page += &format!("<script id=\"model\" type=\"text/plain\" data-name=\"{name}\">");
    STANDARD.encode_string(model, &mut page);
    page += "</script>";
    page += after;
    page
}

/// Returns a text as HTML has it, in attributes too.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_its_model_and_no_markup_of_its_name() {
        assert_eq!((VIEWER.matches(MODEL).count(), VIEWER.matches(TITLE).count()), (1, 1));
        let page = with_model("a\"><script>.mlod", b"bytes of a model");
        assert!(page.contains("<title>a&quot;&gt;&lt;script&gt;.mlod – meshlod</title>"));
        assert!(page.contains(&format!(">{}</script>", STANDARD.encode("bytes of a model"))));
        assert_eq!(page.matches("<script").count(), VIEWER.matches("<script").count() + 1);
    }
}
