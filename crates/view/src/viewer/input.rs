//! Keys and mouse, as in Blender.

use egui::{Key, Modifiers, PointerButton};

use crate::stage::Side;

/// Command of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Command {
    Look(Side),
    Orbit(OrbitStep),
    FrameAll,
    FrameSelected,
    CycleShading,
    ToggleWireframe,
    ToggleFly,
    CycleSides,
    FreezeCamera,
    TogglePanel,
    SavePicture,
    ToggleHelp,
    NextFile,
    Leave,
}

/// Turn of the camera by 15°.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OrbitStep {
    Left,
    Right,
    Up,
    Down,
}

/// Effect of a drag of the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DragAction {
    Orbit,
    Pan,
    Zoom,
}

/// Key and its command; also a line of the help.
pub(crate) struct Binding {
    pub key: Key,
    pub modifiers: Modifiers,
    pub command: Command,
    /// Keys as the help writes them; empty for a second key of the line above.
    pub keys: &'static str,
    pub help: &'static str,
}

const fn bind(
    key: Key,
    modifiers: Modifiers,
    command: Command,
    [keys, help]: [&'static str; 2],
) -> Binding {
    Binding { key, modifiers, command, keys, help }
}

const NONE: Modifiers = Modifiers::NONE;
const CTRL: Modifiers = Modifiers::CTRL;
const SHIFT: Modifiers = Modifiers::SHIFT;
const AGAIN: [&str; 2] = ["", ""];

/// All keys.
pub(crate) const BINDINGS: [Binding; 26] = [
    bind(Key::Num1, NONE, Command::Look(Side::Front), ["1", "Front, with Ctrl back"]),
    bind(Key::Num1, CTRL, Command::Look(Side::Back), AGAIN),
    bind(Key::Num3, NONE, Command::Look(Side::Right), ["3", "Right, with Ctrl left"]),
    bind(Key::Num3, CTRL, Command::Look(Side::Left), AGAIN),
    bind(Key::Num7, NONE, Command::Look(Side::Top), ["7", "Top, with Ctrl bottom"]),
    bind(Key::Num7, CTRL, Command::Look(Side::Bottom), AGAIN),
    bind(Key::Num4, NONE, Command::Orbit(OrbitStep::Left), ["4 6 8 2", "Turn by 15°"]),
    bind(Key::Num6, NONE, Command::Orbit(OrbitStep::Right), AGAIN),
    bind(Key::Num8, NONE, Command::Orbit(OrbitStep::Up), AGAIN),
    bind(Key::Num2, NONE, Command::Orbit(OrbitStep::Down), AGAIN),
    bind(Key::Home, NONE, Command::FrameAll, ["Home", "Show everything"]),
    bind(Key::Period, NONE, Command::FrameSelected, [".", "Show what is selected"]),
    bind(Key::Z, NONE, Command::CycleShading, ["Z", "Smooth or flat, with Shift wireframe"]),
    bind(Key::Z, SHIFT, Command::ToggleWireframe, AGAIN),
    bind(Key::Tab, NONE, Command::CycleSides, ["Tab", "Original, level, side by side"]),
    bind(Key::Tab, CTRL, Command::NextFile, ["Ctrl Tab", "Next file"]),
    bind(Key::C, NONE, Command::FreezeCamera, ["C", "Freeze the camera of the level of detail"]),
    bind(Key::Backtick, SHIFT, Command::ToggleFly, ["Shift `", "Fly: W A S D, Q E, mouse to look"]),
    bind(Key::F, SHIFT, Command::ToggleFly, AGAIN),
    bind(Key::N, NONE, Command::TogglePanel, ["N", "Side panel"]),
    bind(Key::F12, NONE, Command::SavePicture, ["F12", "Save a picture"]),
    bind(Key::S, CTRL, Command::SavePicture, AGAIN),
    bind(Key::F1, NONE, Command::ToggleHelp, ["F1 or ?", "This help"]),
    bind(Key::Questionmark, NONE, Command::ToggleHelp, AGAIN),
    bind(Key::Slash, SHIFT, Command::ToggleHelp, AGAIN),
    bind(Key::Escape, NONE, Command::Leave, ["Esc", "Leave flight, help, selection"]),
];

/// Mouse, as the help lists it.
pub(crate) const MOUSE_HELP: [[&str; 2]; 5] = [
    ["Drag", "Turn, with the left or the middle button"],
    ["Shift drag", "Move; also with the right button"],
    ["Ctrl drag", "Zoom"],
    ["Wheel", "Zoom towards the pointer"],
    ["Double click", "Show everything"],
];

/// Returns the commands of the keys that were pressed in a frame.
pub(crate) fn commands(input: &mut egui::InputState) -> Vec<Command> {
    let mut found = Vec::new();
    for event in &input.events {
        if let egui::Event::Key { key, pressed: true, repeat, modifiers, .. } = event
            && let Some(command) = command_of(*key, *modifiers)
            && (!repeat || matches!(command, Command::Orbit(_)))
        {
            found.push(command);
        }
    }
    found
}

/// Returns the command of a key; `None` if it has none.
pub(crate) fn command_of(key: Key, modifiers: Modifiers) -> Option<Command> {
    let is_pressed = |binding: &&Binding| {
        // A question mark needs Shift on most keyboards.
        let is_typed = binding.key == Key::Questionmark && !modifiers.ctrl && !modifiers.alt;
        binding.key == key && (modifiers.matches_exact(binding.modifiers) || is_typed)
    };
    BINDINGS.iter().find(is_pressed).map(|binding| binding.command)
}

/// Returns the effect of a drag with a button.
pub(crate) fn drag_action(button: PointerButton, modifiers: Modifiers) -> Option<DragAction> {
    match button {
        PointerButton::Primary | PointerButton::Middle if modifiers.shift => Some(DragAction::Pan),
        PointerButton::Primary | PointerButton::Middle if modifiers.ctrl => Some(DragAction::Zoom),
        PointerButton::Primary | PointerButton::Middle => Some(DragAction::Orbit),
        PointerButton::Secondary => Some(DragAction::Pan),
        _ => None,
    }
}

/// Returns the direction of flight from the keys that are held: right, up, forward.
pub(crate) fn flight(input: &egui::InputState) -> [f64; 3] {
    let axis = |more: Key, less: Key| {
        f64::from(u8::from(input.key_down(more))) - f64::from(u8::from(input.key_down(less)))
    };
    [axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_blender() {
        for (key, modifiers, command) in [
            (Key::Num1, NONE, Some(Command::Look(Side::Front))),
            (Key::Num1, CTRL, Some(Command::Look(Side::Back))),
            (Key::Num7, CTRL, Some(Command::Look(Side::Bottom))),
            (Key::Home, NONE, Some(Command::FrameAll)),
            (Key::Backtick, SHIFT, Some(Command::ToggleFly)),
            (Key::Questionmark, SHIFT, Some(Command::ToggleHelp)),
            (Key::S, CTRL, Some(Command::SavePicture)),
            (Key::S, NONE, None),
            (Key::F5, NONE, None),
        ] {
            assert_eq!(command_of(key, modifiers), command, "{key:?} {modifiers:?}");
        }
    }

    #[test]
    fn no_key_has_two_commands() {
        for (i, a) in BINDINGS.iter().enumerate() {
            let same = |b: &Binding| (b.key, b.modifiers) == (a.key, a.modifiers);
            assert!(!BINDINGS[i + 1..].iter().any(same), "{:?}", a.key);
        }
    }

    #[test]
    fn drags_orbit_pan_and_zoom() {
        use PointerButton::{Extra1, Middle, Primary, Secondary};
        assert_eq!(drag_action(Middle, NONE), Some(DragAction::Orbit));
        assert_eq!(drag_action(Primary, NONE), Some(DragAction::Orbit));
        assert_eq!(drag_action(Middle, SHIFT), Some(DragAction::Pan));
        assert_eq!(drag_action(Middle, CTRL), Some(DragAction::Zoom));
        assert_eq!(drag_action(Secondary, NONE), Some(DragAction::Pan));
        assert_eq!(drag_action(Extra1, NONE), None);
    }
}
