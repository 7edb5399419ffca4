//! Volume that a simplification could not conserve, as JSON and text.

use meshlod::Method;
use meshlod::simplify::{Unconserved, VolumeLoss};
use serde_json::{Value, json};

use crate::numbers::{count, plural, value};

/// Returns the contractions that could not conserve the volume as JSON; `null` for a method that
/// does not aim to.
pub fn unconserved_json(method: Method, loss: &VolumeLoss) -> Value {
    let json =
        || json!({ "at_boundaries": with_bounds(&loss.open), "held": with_bounds(&loss.held) });
    method.conserves_volume().then(json).into()
}

fn with_bounds(some: &Unconserved) -> Value {
    let bounds =
        (some.contractions > 0).then(|| json!({ "min": some.bounds.min, "max": some.bounds.max }));
    json!({ "contractions": some.contractions, "bounds": bounds })
}

/// Describes the contractions in which a volume-conserving method could not conserve the volume;
/// `None` if there are none.
pub fn unconserved_text(method: Method, loss: &VolumeLoss) -> Option<String> {
    let kinds = [(&loss.open, "at boundaries"), (&loss.held, "constrained by seams or locks")];
    let some = kinds.iter().filter(|(some, _)| some.contractions > 0);
    let texts: Vec<String> = some.map(|(some, what)| place(some, what)).collect();
    (method.conserves_volume() && !texts.is_empty())
        .then(|| format!("volume not conserved by {}", texts.join("; ")))
}

fn place(some: &Unconserved, what: &str) -> String {
    let point = |point: [f64; 3]| point.map(value).join(" ");
    format!(
        "{} contraction{} {what}, within the box from {} to {}",
        count(some.contractions),
        plural(some.contractions),
        point(some.bounds.min),
        point(some.bounds.max),
    )
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::Bounds;

    use super::*;

    #[test]
    fn only_a_method_that_promises_to_conserve_says_where_it_could_not() {
        let bounds = Bounds { min: [0.0, -1.0, 0.5], max: [1.0; 3] };
        let loss =
            VolumeLoss { held: Unconserved { contractions: 1, bounds }, ..VolumeLoss::default() };
        let text = "volume not conserved by 1 contraction constrained by seams or locks, within the \
                    box from 0 -1 0.5 to 1 1 1";
        assert_eq!(unconserved_text(Method::LeeJang, &loss).as_deref(), Some(text));
        assert_eq!(unconserved_text(Method::Qem, &loss), None);
        assert_eq!(unconserved_text(Method::LeeJang, &VolumeLoss::default()), None);
        let json = |method| unconserved_json(method, &loss);
        assert_eq!(json(Method::LeeJang)["held"]["contractions"], 1);
        assert!(json(Method::LeeJang)["at_boundaries"]["bounds"].is_null());
        assert!(json(Method::Qem).is_null());
    }
}
