//! Picture in an HTML page, which fills the window when it is clicked.
//!
//! Pages run no script: the picture is the summary of a `details` element, which is drawn over the
//! page while it is open. So it works with a key, too, and the picture is in the page once.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};
use meshlod::picture::Picture;

/// Picture that is embedded in an HTML page.
pub struct InlinePicture {
    /// PNG of the picture as a data URI.
    uri: String,
    /// Alternative text of the picture for screen readers, and its caption when it is enlarged.
    alt: String,
    /// Width and height in pixels.
    size: [u32; 2],
}

impl InlinePicture {
    pub fn new(picture: &Picture, alt: String) -> Self {
        let uri = format!("data:image/png;base64,{}", STANDARD.encode(picture.png()));
        Self { uri, alt, size: [picture.width(), picture.height()] }
    }

    /// Shows the picture as wide as its column.
    pub fn image(&self) -> Markup {
        let [width, height] = self.size;
        html! { img src=(self.uri) alt=(self.alt) width=(width) height=(height) loading="lazy"; }
    }

    /// Shows the picture as wide as its column; a click enlarges it.
    pub fn zoomable(&self) -> Markup {
        let [width, height] = self.size;
        html! {
            // All that are open at once would lie on each other.
            details.zoom name="zoom" style=(format!("aspect-ratio: {width} / {height}")) {
                summary { (self.image()) span aria-hidden="true" { (self.alt) } }
            }
        }
    }
}
