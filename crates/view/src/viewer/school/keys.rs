//! Keys of the window of a school.

use egui::{Key, Modifiers};
use meshlod::flock::select::PolicyName;

use super::app::SchoolApp;

/// Keys of the policies, in the order of [`PolicyName::ALL`].
const POLICY_KEYS: [(Key, &str); 11] = [
    (Key::Num1, "1"),
    (Key::Num2, "2"),
    (Key::Num3, "3"),
    (Key::Num4, "4"),
    (Key::Num5, "5"),
    (Key::Num6, "6"),
    (Key::Num7, "7"),
    (Key::Num8, "8"),
    (Key::Num9, "9"),
    (Key::Num0, "0"),
    (Key::Minus, "-"),
];

/// Keys and mouse, as the help lists them.
pub(crate) const HELP: [[&str; 2]; 12] = [
    ["Space", "Pause"],
    ["1 to 9, 0, -", "Policies, in the order of the list"],
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

/// Returns the name of the key of a policy.
pub(crate) fn key_of(policy: PolicyName) -> &'static str {
    let all = PolicyName::ALL.iter().zip(POLICY_KEYS);
    all.into_iter().find(|(name, _)| **name == policy).map_or("", |(_, (_, text))| text)
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
            _ => {
                let keys = POLICY_KEYS.iter().zip(PolicyName::ALL);
                if let Some((_, policy)) = keys.into_iter().find(|((known, _), _)| *known == key) {
                    controls.policy = policy;
                }
            }
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
        let keys = PolicyName::ALL.map(key_of);
        assert!(keys.iter().all(|key| !key.is_empty()));
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[i + 1..].contains(key), "{key}");
        }
        assert_eq!((key_of(PolicyName::None), key_of(PolicyName::Ours)), ("1", "-"));
    }
}
