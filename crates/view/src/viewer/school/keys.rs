//! Keys of the window of a school.

use egui::{Key, Modifiers};
use meshlod::flock::select::PolicyName;

use super::app::SchoolApp;

/// Keys and mouse, without the keys of the policies.
const HELP: [[&str; 2]; 11] = [
    ["Space", "Pause"],
    ["S", "Split screen: levels on the left, full detail on the right"],
    ["C", "Camera: path of the film, or orbit"],
    ["I", "Impostors"],
    ["N", "Side panel"],
    ["G", "Graphs"],
    ["Drag", "Orbit around the school; move an obstacle under the pointer"],
    ["Shift drag", "Move the camera; also with the right button"],
    ["Wheel, Ctrl drag", "Zoom"],
    ["F1 or ?", "This help"],
    ["Esc", "Close this help"],
];

/// Returns keys and mouse, as the help lists them.
pub(crate) fn help() -> Vec<[String; 2]> {
    let mut lines = HELP.map(|line| line.map(String::from)).to_vec();
    lines.insert(1, [policy_keys(), "Policies, in the order of the list".into()]);
    lines
}

/// Returns the keys of the policies, as the help lists them: runs of characters by their ends.
fn policy_keys() -> String {
    let mut runs: Vec<[char; 2]> = Vec::new();
    for key in PolicyName::ALL.map(PolicyName::key) {
        match runs.last_mut() {
            Some([_, last]) if u32::from(*last) + 1 == u32::from(key) => *last = key,
            _ => runs.push([key; 2]),
        }
    }
    let text = |[first, last]: [char; 2]| match first == last {
        true => first.to_string(),
        false => format!("{first} to {last}"),
    };
    runs.into_iter().map(text).collect::<Vec<_>>().join(", ")
}

/// Returns the policy that a key chooses.
fn policy_of(key: Key) -> Option<PolicyName> {
    let chooses = |policy: &PolicyName| Key::from_name(&policy.key().to_string()) == Some(key);
    PolicyName::ALL.into_iter().find(chooses)
}

impl SchoolApp {
    /// Does what the keys of a frame ask for.
    pub fn take_keys(&mut self, ctx: &egui::Context) {
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        for (key, modifiers) in pressed(ctx) {
            self.take_key(key, modifiers);
        }
    }

    fn take_key(&mut self, key: Key, modifiers: Modifiers) {
        if modifiers.ctrl || modifiers.alt {
            return;
        }
        let controls = &mut self.controls;
        match key {
            Key::Space => controls.is_paused = !controls.is_paused,
            Key::S => controls.is_split = !controls.is_split,
            Key::I => controls.has_impostors = !controls.has_impostors,
            Key::N => controls.has_panel = !controls.has_panel,
            Key::G => controls.has_graphs = !controls.has_graphs,
            Key::C => self.toggle_orbit(),
            Key::F1 | Key::Questionmark => controls.has_help = !controls.has_help,
            Key::Slash if modifiers.shift => controls.has_help = !controls.has_help,
            Key::Escape => controls.has_help = false,
            _ => controls.policy = policy_of(key).unwrap_or(controls.policy),
        }
    }
}

fn pressed(ctx: &egui::Context) -> Vec<(Key, Modifiers)> {
    ctx.input(|input| {
        let keys = input.events.iter().filter_map(|event| match event {
            egui::Event::Key { key, pressed: true, repeat: false, modifiers, .. } => {
                Some((*key, *modifiers))
            }
            _ => None,
        });
        keys.collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_policy_has_a_key_of_its_own() {
        for policy in PolicyName::ALL {
            let key = Key::from_name(&policy.key().to_string());
            assert_eq!(key.and_then(policy_of), Some(policy), "{policy}");
        }
        assert_eq!(
            (policy_of(Key::Num1), policy_of(Key::Minus)),
            (Some(PolicyName::None), Some(PolicyName::Ours),)
        );
        assert_eq!(policy_of(Key::Q), None);
        assert_eq!(policy_keys(), "1 to 9, 0, -");
    }
}
