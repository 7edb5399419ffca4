//! Options in the forms that serde gives them: names, defaults, and what is refused.

use std::fmt::Debug;

use meshlod::flock::select::PolicyName;
use meshlod::flock::select::policies::Factors;
use meshlod_school::evaluate::{Arm, EvaluationOptions};
use meshlod_school::scene::{ScenarioName, ScenarioOptions};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, from_value, json, to_value};

/// Checks that a part of the options fills up to the whole, that no field must be given, and that a
/// misspelt one is refused.
fn check_options<T>(options: &T, part: Value)
where
    T: Serialize + DeserializeOwned + Default + PartialEq + Debug,
{
    let written = to_value(options).unwrap();
    for (field, value) in part.as_object().unwrap() {
        assert_eq!(&written[field], value, "{field}");
    }
    let read = |json: Value| from_value::<T>(json);
    assert_eq!(&read(written).unwrap(), options);
    assert_eq!(&read(part).unwrap(), options);
    assert_eq!(read(json!({})).unwrap(), T::default());
    let refused = read(json!({ "misspelt": 1 })).unwrap_err().to_string();
    assert!(refused.contains("unknown field `misspelt`"), "{refused}");
}

#[test]
fn options_of_schools() {
    check_options(&ScenarioOptions { members: 9, ..Default::default() }, json!({ "members": 9 }));
    let arms = vec![Arm::VisibleOnly(PolicyName::Ours), Arm::Paper(Factors::All), Arm::Random];
    check_options(
        &EvaluationOptions { arms, ..Default::default() },
        json!({ "arms": [{ "visible-only": "ours" }, { "paper": "all" }, "random"], "pairs": 4 }),
    );
}

#[test]
fn names_are_those_that_print() {
    for name in ScenarioName::ALL {
        let written = to_value(name).unwrap();
        assert_eq!(written, name.to_string());
        assert_eq!(from_value::<ScenarioName>(written).unwrap(), name);
    }
}
