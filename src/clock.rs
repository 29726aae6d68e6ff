//! The date in output headers.

use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};
use radsight_picture::Header;

/// The time format of Radiance's headers: `2026:11:21 11:14:09`.
const FORM: &str = "%Y:%m:%d %H:%M:%S";

/// Adds the time of creation: local (`CAPDATE`) and Greenwich (`GMT`).
pub(crate) fn push_date(header: &mut Header) {
    let now = Timestamp::now();
    push_date_of(header, &now.to_zoned(local_zone()));
}

/// The local time in the format of Radiance's headers.
pub(crate) fn now_local() -> String {
    Timestamp::now().to_zoned(local_zone()).strftime(FORM).to_string()
}

/// The time zone of the machine or of the variable `TZ`.
///
/// To find the name of a zone, which no header has, takes a walk through the folder of all zones.
fn local_zone() -> TimeZone {
    let of_machine = || TimeZone::tzif("Local", &std::fs::read("/etc/localtime").ok()?).ok();
    match std::env::var_os("TZ") {
        None if cfg!(unix) => of_machine().unwrap_or_else(TimeZone::system),
        _ => TimeZone::system(),
    }
}

fn push_date_of(header: &mut Header, local: &Zoned) {
    let greenwich = local.with_time_zone(TimeZone::UTC);
    header.push_variable("CAPDATE", &format!(" {}", local.strftime(FORM)));
    header.push_variable("GMT", &format!(" {}", greenwich.strftime(FORM)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_have_the_local_date_and_that_of_greenwich() {
        let mut header = Header::default();
        let moment = Timestamp::from_second(1_795_303_449).expect("a second of this century");
        push_date_of(&mut header, &moment.to_zoned(TimeZone::fixed(jiff::tz::offset(-8))));
        let lines: Vec<&[u8]> = header.lines().collect();
        assert_eq!(lines, [&b"CAPDATE= 2026:11:21 15:24:09"[..], b"GMT= 2026:11:21 23:24:09"]);
    }
}
