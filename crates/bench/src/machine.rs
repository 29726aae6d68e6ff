//! The machine of the measurements.

use crate::radsight::Radsight;
use std::fs;
use std::process::Command;

/// A few lines about the machine and the programs.
pub(crate) fn describe(radsight: &Radsight, radiance: &Result<String, String>) -> String {
    let first_line = |command: &mut Command| {
        let output = command.output().ok().filter(|output| output.status.success());
        output.map(|output| String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or_default().to_owned())
    };
    let unknown = || "unknown".to_owned();
    let cores = std::thread::available_parallelism().map_or_else(|_| unknown(), |count| count.to_string());
    let rustc = first_line(Command::new("rustc").arg("--version")).unwrap_or_else(unknown);
    let own = first_line(&mut radsight.command(&["--version"])).unwrap_or_else(unknown);
    let peer = match radiance {
        Ok(version) => version.clone(),
        Err(reason) => format!("missing: {reason}"),
    };
    format!(
        "machine   {}, {cores} cores, load {}\nprograms  {own}; {rustc}\nRadiance  {peer}\n",
        processor(&fs::read_to_string("/proc/cpuinfo").unwrap_or_default()).unwrap_or("unknown processor"),
        load().unwrap_or_else(unknown),
    )
}

/// Runnable processes, averaged over the last minute, as the system counts them.
fn load() -> Option<String> {
    fs::read_to_string("/proc/loadavg").ok()?.split(' ').next().map(str::to_owned)
}

fn processor(cpuinfo: &str) -> Option<&str> {
    cpuinfo.lines().find_map(|line| Some(line.strip_prefix("model name")?.split_once(':')?.1.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_found_in_its_line() {
        assert_eq!(processor("processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\n"), Some("Some CPU @ 2 GHz"));
        assert_eq!(processor(""), None);
    }
}
