//! Tips for what a verb needs and did not get.

use clap::Error;
use clap::error::{ContextKind, ContextValue};

use crate::usage::line::TypedLine;

/// Says what to add.
pub fn tip(error: &Error, line: &TypedLine) -> Option<String> {
    let ContextValue::Strings(missing) = error.get(ContextKind::InvalidArg)? else { return None };
    let lacks = |name: &str| missing.iter().any(|arg| arg.contains(name));
    let (verb, paths) = (line.verb_name()?, line.paths());
    match verb {
        _ if lacks("--faces") && lacks("--error") => {
            Some("say how far, such as --ratio 10%, --faces 5k or --error 0.1%".into())
        }
        _ if lacks("--faces") => {
            Some("say how far, such as --ratio 10%,1% or --faces 5k,500".into())
        }
        "batch" => {
            Some("the last path is the folder to write to: meshlod batch 'in/*.ply' out".into())
        }
        "measure" if paths.len() == 1 => {
            Some(format!("a distance is between two meshes: meshlod measure {} <B>", paths[0]))
        }
        _ if lacks("<OUT") && paths.len() == 1 => {
            Some(format!("name the file to write after {}", paths[0]))
        }
        _ => None,
    }
}
