//! The error of `simplify --error` as text: what was asked for, and what is proved.

use meshlod::jobs::ProvedError;

use crate::text::numbers::value;

/// Formats a warning that says what holds instead, and what would help.
pub fn warning(error: &ProvedError) -> String {
    let asked = value(error.asked);
    let Some(proved) = error.proved else {
        return format!("--error {asked} is not proved: a surface has no area to measure");
    };
    let proved = value(proved);
    let help = match error.is_rounded_away() {
        true => {
            "the coordinates written are rounded by more than half of that; ply, obj, off \
            and smf take --precision f64"
        }
        false => {
            "a larger error can be kept, and lindstrom-turk and qem keep smaller ones without \
            --exact-volume and locks"
        }
    };
    format!("--error {asked}: only {proved} is proved; {help}")
}

/// Formats the lines with what was asked for and what is proved.
pub fn text(error: &ProvedError) -> String {
    let proved = error.proved.map_or("nothing".into(), |proved| {
        let plural = if error.rounds == 1 { "" } else { "s" };
        match error.rounds {
            0 => value(proved),
            rounds => format!("{} (mended in {rounds} round{plural})", value(proved)),
        }
    });
    format!("error_asked: {}\nerror_proved: {proved}\n", value(error.asked))
}
