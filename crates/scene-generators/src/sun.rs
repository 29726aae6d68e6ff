//! The sun's position, as `gensky` and `gendaylit` compute it.
//!
//! There are two methods. The simple one (declination and equation of time as sines of the day of
//! the year, after the IES Lighting Handbook) needs no year. The more accurate one is the
//! Astronomical Almanac's, good to 0.01° from 1950 to 2050: J. J. Michalsky, "The Astronomical
//! Almanac's algorithm for approximate solar position (1950–2050)", Solar Energy 40 (3), 1988.
//! Times are hours from local midnight, angles radians; azimuth is measured from south, towards the
//! west.

use std::f64::consts::PI;

const DEGREE: f64 = PI / 180.0;
/// Rotation of the earth per hour, radians.
const HOUR: f64 = PI / 12.0;

/// A site and its clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    /// Radians north of the equator.
    pub(crate) latitude: f64,
    /// Radians west of Greenwich.
    pub(crate) longitude: f64,
    /// Standard meridian of the clock, radians west of Greenwich.
    pub(crate) meridian: f64,
}

impl Default for Site {
    /// Radiance's default site, Berkeley, California.
    fn default() -> Self {
        Site { latitude: 0.66, longitude: 2.13, meridian: 120.0 * DEGREE }
    }
}

/// A time by the local clock or by the sun.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// For the Almanac's method; `None` selects the simple one.
    pub(crate) year: Option<i64>,
    /// 1 to 12.
    pub(crate) month: usize,
    /// 1 to 31.
    pub(crate) day: i64,
    pub(crate) hour: f64,
    /// Whether `hour` is solar time.
    pub(crate) by_the_sun: bool,
}

/// The sun's declination and the solar time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sun {
    pub(crate) declination: f64,
    /// Hours; 12 when the sun is in the south.
    pub(crate) solar_time: f64,
}

impl Moment {
    /// The day of the year, from 1; every February has 28 days.
    pub(crate) fn day_of_year(&self) -> i64 {
        day_of_year(self.month, self.day)
    }

    pub(crate) fn sun(&self, site: &Site) -> Sun {
        let (declination, adjusted) = match self.year {
            Some(year) => self.almanac(year, site),
            None => {
                let day = self.day_of_year() as f64;
                (simple_declination(day), self.hour + simple_time_adjustment(day, site))
            }
        };
        Sun { declination, solar_time: if self.by_the_sun { self.hour } else { adjusted } }
    }

    /// Declination and solar time by Michalsky's algorithm.
    fn almanac(&self, year: i64, site: &Site) -> (f64, f64) {
        let leap_day = i64::from(self.month > 2 && year % 4 == 0);
        let since_1949 = year - 1949;
        let days = self.day_of_year() + leap_day + since_1949 * 365 + since_1949 / 4;
        let universal_hour = self.hour + site.meridian / HOUR;
        // Days since noon UT on 1 January 2000.
        let date = days as f64 + universal_hour / 24.0 + (2_432_916.5 - 2_451_545.0);
        let mean_longitude = (280.460 * DEGREE + 0.985_647_4 * DEGREE * date).rem_euclid(2.0 * PI);
        let mean_anomaly = (357.528 * DEGREE + 0.985_600_3 * DEGREE * date).rem_euclid(2.0 * PI);
        let longitude =
            mean_longitude + 1.915 * DEGREE * mean_anomaly.sin() + 0.020 * DEGREE * (2.0 * mean_anomaly).sin();
        let obliquity = 23.439 * DEGREE - 4e-7 * DEGREE * date;
        let right_ascension = (longitude.sin() * obliquity.cos()).atan2(longitude.cos());
        let time_of_day = 24.0 * (date - date.floor()) + 12.0;
        let sidereal = 6.697_375 + 0.065_709_824_2 * date + time_of_day - site.longitude / HOUR;
        let solar_time = (sidereal - right_ascension / HOUR + 12.0).rem_euclid(24.0);
        ((obliquity.sin() * longitude.sin()).asin(), solar_time)
    }
}

/// The day of the year, from 1, of a month from 1; every February has 28 days.
pub(crate) fn day_of_year(month: usize, day: i64) -> i64 {
    const DAYS_BEFORE: [i64; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];
    DAYS_BEFORE[month.saturating_sub(1).min(11)] + day
}

/// Declination from the day of the year.
pub(crate) fn simple_declination(day: f64) -> f64 {
    0.4093 * ((2.0 * PI / 365.0) * (day - 81.0)).sin()
}

/// Hours to add to the clock for solar time: the equation of time and the longitude correction.
pub(crate) fn simple_time_adjustment(day: f64, site: &Site) -> f64 {
    0.170 * ((4.0 * PI / 373.0) * (day - 80.0)).sin() - 0.129 * ((2.0 * PI / 355.0) * (day - 8.0)).sin()
        + (12.0 / PI) * (site.meridian - site.longitude)
}

impl Sun {
    /// Altitude above the horizon.
    pub(crate) fn altitude(&self, site: &Site) -> f64 {
        let (latitude, declination) = (site.latitude, self.declination);
        let hour_angle = self.solar_time * HOUR;
        (latitude.sin() * declination.sin() - latitude.cos() * declination.cos() * hour_angle.cos()).asin()
    }

    /// Azimuth from south, towards the west.
    pub(crate) fn azimuth(&self, site: &Site) -> f64 {
        let (latitude, declination) = (site.latitude, self.declination);
        let hour_angle = self.solar_time * HOUR;
        -(declination.cos() * hour_angle.sin())
            .atan2(-latitude.cos() * declination.sin() - latitude.sin() * declination.cos() * hour_angle.cos())
    }
}

/// Unit vector towards the sun: x east, y north, z up.
pub(crate) fn direction(altitude: f64, azimuth: f64) -> [f64; 3] {
    [-azimuth.sin() * altitude.cos(), -azimuth.cos() * altitude.cos(), altitude.sin()]
}

/// A sky of the CIE whose radiance depends on the sun.
#[derive(Clone, Copy)]
pub(crate) enum CieSky {
    Clear,
    Intermediate,
}

/// Mean horizontal radiance of the sky times π, divided by zenith radiance, as fourth-degree
/// polynomials of the solar altitude; for the intermediate or the clear sky. The coefficients are
/// `gensky`'s.
pub(crate) fn sky_normalization(altitude: f64, sky: CieSky) -> f64 {
    const CLEAR: [f64; 5] = [2.766521, 0.547665, -0.369832, 0.009237, 0.059229];
    const INTERMEDIATE: [f64; 5] = [3.5556, -2.7152, -1.3081, 1.0660, 0.60227];
    let x = (altitude - PI / 4.0) / (PI / 4.0);
    let coefficients = match sky {
        CieSky::Clear => CLEAR,
        CieSky::Intermediate => INTERMEDIATE,
    };
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}
