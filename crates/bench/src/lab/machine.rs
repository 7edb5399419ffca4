//! Date and machine of a measurement.

use std::process::Command;

/// Date of a measurement and description of the machine.
pub struct Machine {
    /// Date of the measurement, as 2026-01-31.
    pub date: String,
    /// Processor, number of cores, and compiler version.
    pub what: String,
}

/// Returns today's date and a description of this machine.
pub fn describe() -> Machine {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let rustc = output("rustc", &["--version"]).unwrap_or_default();
    Machine {
        date: output("date", &["+%F"]).unwrap_or_else(|| "undated".to_owned()),
        what: format!("{}, {cores} cores, {rustc}", processor()),
    }
}

fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or("unknown processor", |(_, name)| name).to_owned()
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
