//! The date in the headers of what is written.

use std::time::SystemTime;

/// Greenwich date and time as Radiance's headers have them: `2026:11:21 11:14:09`.
pub(crate) fn greenwich_time() -> String {
    let seconds = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_secs());
    written(seconds)
}

fn written(since_1970: u64) -> String {
    let (days, second) = (since_1970 / 86_400, since_1970 % 86_400);
    // Days from a first of March on repeat every 400 years; the year, the month and the day follow from the mean lengths
    // (Hinnant, "chrono-Compatible Low-Level Date Algorithms", civil_from_days).
    let from_march = days + 719_468;
    let (era, in_era) = (from_march / 146_097, from_march % 146_097);
    let year_of_era = (in_era - in_era / 1460 + in_era / 36_524 - in_era / 146_096) / 365;
    let in_year = in_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let months = (5 * in_year + 2) / 153;
    let day = in_year - (153 * months + 2) / 5 + 1;
    let month = if months < 10 { months + 3 } else { months - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year}:{month:02}:{day:02} {hour:02}:{minute:02}:{second:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leap_days_are_counted() {
        assert_eq!(written(0), "1970:01:01 00:00:00");
        assert_eq!(written(951_782_399), "2000:02:28 23:59:59");
        assert_eq!(written(951_782_400), "2000:02:29 00:00:00");
        assert_eq!(written(1_709_251_200), "2024:03:01 00:00:00");
        assert_eq!(written(1_795_259_649), "2026:11:21 11:14:09");
    }
}
