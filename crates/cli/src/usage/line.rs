//! A command line as it was typed.

use std::ffi::OsString;

use clap::{Arg, Command};

/// Words of a command line, with the verb among them.
pub struct TypedLine {
    /// All words after the name of the program.
    pub words: Vec<String>,
    /// Verb with its options, if there is one.
    pub verb: Option<Command>,
    /// All verbs.
    pub program: Command,
}

impl TypedLine {
    pub fn of(arguments: &[OsString], mut program: Command) -> Self {
        let words: Vec<String> =
            arguments.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
        program.build();
        let verb = words.iter().find_map(|word| program.find_subcommand(word)).cloned();
        Self { words, verb, program }
    }

    pub fn verb_name(&self) -> Option<&str> {
        self.verb.as_ref().map(Command::get_name)
    }

    /// Returns an option of the verb by its long name.
    pub fn option(&self, name: &str) -> Option<&Arg> {
        long_option(self.verb.as_ref()?, name)
    }

    /// Returns the words after the verb that are no options, up to the first option.
    pub fn paths(&self) -> Vec<&str> {
        let paths = self.words.iter().map(String::as_str);
        let paths = paths.skip_while(|word| Some(*word) == self.verb_name());
        paths.take_while(|word| !word.starts_with('-')).collect()
    }

    /// Returns the word before the first one that is `word`.
    pub fn before(&self, word: &str) -> Option<&str> {
        let at = self.words.iter().position(|other| other == word)?;
        Some(&self.words[at.checked_sub(1)?])
    }

    /// Reports whether the verb reads one file and writes another.
    pub fn reads_and_writes(&self) -> bool {
        let places = self.verb.iter().flat_map(Command::get_positionals);
        places.map(|place| place.get_id().as_str()).eq(["input", "output"])
    }

    /// Returns the verb with its places: `meshlod simplify <IN> <OUT>`.
    pub fn form(&self) -> Option<String> {
        let verb = self.verb.as_ref()?;
        let places: Vec<String> = verb.get_positionals().map(ToString::to_string).collect();
        Some(format!("meshlod {} {}", verb.get_name(), places.join(" ")))
    }
}

/// Returns an option of a verb by its long name.
pub fn long_option<'c>(verb: &'c Command, name: &str) -> Option<&'c Arg> {
    verb.get_arguments().find(|arg| arg.get_long() == Some(name))
}
