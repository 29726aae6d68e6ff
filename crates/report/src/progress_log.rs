//! The progress output of `rpict -t`, ours and Radiance's.
//!
//! A line is `rpict: 1024 rays, 12.50% after 0.001u 0.000s 0.002r hours on host (PID 7)`: user
//! time, system time and elapsed time. Other lines are messages.

/// One progress line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Rays so far.
    pub rays: f64,
    /// The finished share, 0 to 1.
    pub share: f64,
    /// Processor time, s.
    pub processor_s: f64,
    /// Elapsed time, s.
    pub elapsed_s: f64,
}

/// A parsed log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgressLog {
    /// Its progress lines, in order.
    pub progress: Vec<Progress>,
    /// Its other lines.
    pub messages: Vec<String>,
}

/// Seconds in an hour.
const HOUR: f64 = 3600.0;

impl ProgressLog {
    /// Parses a log.
    #[must_use]
    pub fn read(text: &str) -> ProgressLog {
        let mut log = ProgressLog::default();
        for line in text.lines().filter(|line| !line.trim().is_empty()) {
            match progress(line) {
                Some(progress) => log.progress.push(progress),
                None => log.messages.push(line.to_owned()),
            }
        }
        log
    }
}

fn progress(line: &str) -> Option<Progress> {
    let (_, said) = line.split_once(": ")?;
    let (rays, said) = said.split_once(" rays, ")?;
    let (percent, said) = said.split_once("% after ")?;
    let (times, _) = said.split_once(" hours")?;
    let mut hours = [0.0; 3];
    let letters = ['u', 's', 'r'];
    for (index, word) in times.split_whitespace().enumerate() {
        // A number without a letter is elapsed time, printed where no other time is known.
        let (place, number) = match letters.iter().position(|letter| word.ends_with(*letter)) {
            Some(place) => (place, &word[..word.len() - 1]),
            None if index == 0 => (2, word),
            None => return None,
        };
        hours[place] = non_negative(number)?;
    }
    Some(Progress {
        rays: non_negative(rays)?,
        share: 0.01 * non_negative(percent)?,
        processor_s: HOUR * (hours[0] + hours[1]),
        elapsed_s: HOUR * hours[2],
    })
}

fn non_negative(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_and_messages_are_separated() {
        let log = ProgressLog::read(
            "rpict: warning - no output\nrpict: 0 rays, 0.00% after 0.000u 0.000s 0.000r hours on h (PID 1)\n\
             rpict: 4096 rays, 50.00% after 0.500u 0.100s 0.250r hours on h (PID 1)\nrpict: x rays, 1% after 1u hours\n",
        );
        assert_eq!(log.messages, ["rpict: warning - no output", "rpict: x rays, 1% after 1u hours"]);
        let last = log.progress[1];
        assert_eq!((log.progress.len(), last.rays, last.share, last.elapsed_s), (2, 4096.0, 0.5, 900.0));
        assert!((last.processor_s - 2160.0).abs() < 1e-9);
    }
}
