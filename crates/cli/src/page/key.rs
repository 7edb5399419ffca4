//! Legend key of a method in charts and tables: a colour and a shape, so that colour-blind readers
//! can rely on the shapes.

use maud::{Markup, html};
use meshlod::Method;

/// Shapes within a circle of radius 5 around the origin, of about equal size.
const SHAPES: [&str; 10] = [
    "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z",
    "M-3.5-3.5h7v7h-7z",
    "M0-4.8L4.4 3.4h-8.8z",
    "M0-5L4.6 0L0 5L-4.6 0z",
    "M0 4.8L4.4-3.4h-8.8z",
    "M-1.5-4.6h3v3.1h3.1v3h-3.1v3.1h-3v-3.1h-3.1v-3h3.1z",
    "M-4.6 0L-2.3-4h4.6L4.6 0L2.3 4h-4.6z",
    "M-2.2-5L0-2.8L2.2-5L5-2.2L2.8 0L5 2.2L2.2 5L0 2.8L-2.2 5L-5 2.2L-2.8 0L-5-2.2z",
    "M0-5L1.4-1.6L5-1.5L2.2.8L3.1 4.3L0 2.3L-3.1 4.3L-2.2.8L-5-1.5L-1.4-1.6z",
    "M-4.2-4.4h8.4L1.2 0L4.2 4.4h-8.4L-1.2 0z",
];

/// Returns the marker shape of a method as an SVG path around the origin.
pub fn shape(method: Method) -> &'static str {
    SHAPES[place(method)]
}

/// Returns the CSS class that sets the colour of a method.
pub fn class(method: Method) -> String {
    format!("m{}", place(method))
}

/// Draws the coloured marker of a method inside a line of text.
pub fn key(method: Method) -> Markup {
    html! {
        svg class=(format!("key {}", class(method))) viewBox="-5 -5 10 10" aria-hidden="true" {
            path d=(shape(method)) {}
        }
    }
}

/// Returns the index of a method among all, so that it looks the same on every page.
fn place(method: Method) -> usize {
    let place = Method::ALL.iter().position(|&other| other == method).unwrap_or(0);
    place % SHAPES.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_methods_look_alike() {
        let mut looks = Method::ALL.map(|method| (class(method), shape(method)));
        looks.sort();
        assert!(looks.windows(2).all(|pair| pair[0].0 != pair[1].0 && pair[0].1 != pair[1].1));
    }
}
