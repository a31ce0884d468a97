//! Illumination of one place, by its traced skyline.

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use super::lit::Lit;
use super::track::{Seen, Track};
use crate::geometry::{Body, Direction, Geodetic};
use crate::horizon::settings::direction;
use crate::horizon::trace::Tracer;
use crate::photometry::SolarDisk;
use crate::terrain::Gnomonic;

/// Skylines of a place are traced this many to the turn.
const AZIMUTHS: usize = 1440;

/// One step at a place; angles in radians, azimuths clockwise from north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    pub sun_azimuth_rad: f64,
    pub sun_elevation_rad: f64,
    /// Of the skyline at the Sun's azimuth.
    pub skyline_rad: f64,
    /// Share of the Sun's light that is seen.
    pub share: f64,
    pub lit: bool,
    pub earth_azimuth_rad: f64,
    pub earth_elevation_rad: f64,
    pub earth_seen: bool,
}

/// A place with its skyline.
#[derive(Debug, Clone)]
pub struct Place<'a> {
    map: &'a Gnomonic,
    /// Lifted point of the ground.
    foot: DVec3,
    /// East, north and up in body-fixed axes.
    local: [DVec3; 3],
    skyline_rad: Vec<f64>,
}

impl<'a> Place<'a> {
    /// The place at a latitude and longitude; `None` where the terrain does not reach.
    pub fn new(body: &Body, map: &'a Gnomonic, tracer: &Tracer, at: Geodetic) -> Option<Self> {
        let at_m = map.lifted_from_body(body.position_from_geodetic(Geodetic { height_m: 0.0, ..at }))?.truncate();
        Some(Self::of_foot(body, map, tracer, tracer.foot(at_m)?))
    }

    /// The place at a lifted point of the ground.
    pub fn of_foot(body: &Body, map: &'a Gnomonic, tracer: &Tracer, foot: DVec3) -> Self {
        let at = body.geodetic_from_position(map.body_from_lifted(foot));
        let skyline = |i: usize| tracer.skyline(foot, direction(TAU * i as f64 / AZIMUTHS as f64)).elevation_rad;
        let axes = body.local_from_body(at).matrix();
        let local = [axes.row(0), axes.row(1), axes.row(2)];
        Self { map, foot, local, skyline_rad: (0..AZIMUTHS).into_par_iter().map(skyline).collect() }
    }

    /// All steps of a track.
    pub fn moments(&self, track: &Track, disk: &SolarDisk, lit: Lit) -> Vec<Moment> {
        let moment = |((sun, earth), &sunlight): ((&Seen, &Seen), &f64)| {
            let (sun_elevation_rad, skyline_rad) = self.above(sun.towards);
            let (earth_elevation_rad, beneath_rad) = self.above(earth.towards);
            let radii = (sun_elevation_rad - skyline_rad) / sun.angular_radius_rad;
            Moment {
                sun_azimuth_rad: self.azimuth_rad(sun.towards),
                sun_elevation_rad,
                skyline_rad,
                share: sunlight * disk.visible_above(-radii),
                lit: radii > lit.threshold(disk, sunlight),
                earth_azimuth_rad: self.azimuth_rad(earth.towards),
                earth_elevation_rad,
                earth_seen: earth_elevation_rad > beneath_rad,
            }
        };
        track.sun.iter().zip(&track.earth).zip(&track.sunlight).map(moment).collect()
    }

    /// (azimuth clockwise from north, elevation) of the skyline, by azimuth.
    pub fn skyline(&self) -> impl Iterator<Item = [f64; 2]> {
        let at_m = self.foot.truncate();
        let azimuth_rad = |i: usize| {
            let d = direction(TAU * i as f64 / AZIMUTHS as f64);
            // The direction along the ground that the map direction stands for.
            let along = d.extend(0.0);
            let up = self.map.up(at_m).unit();
            let level = self.map.map_from_body.inverse().turn(along - along.dot(up) * up);
            self.azimuth_rad(level)
        };
        let mut points: Vec<_> =
            self.skyline_rad.iter().enumerate().map(|(i, elevation_rad)| [azimuth_rad(i), *elevation_rad]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points.into_iter()
    }

    /// Elevation of a direction, and of the skyline beneath it.
    fn above(&self, towards: DVec3) -> (f64, f64) {
        let towards = self.map.map_from_body.turn(towards);
        let at_m = self.foot.truncate();
        let elevation_rad = self.map.up(at_m).unit().dot(towards).clamp(-1.0, 1.0).asin();
        let Some(towards) = Direction::new(towards) else { return (elevation_rad, 0.0) };
        let d = self.map.map_direction(at_m, towards);
        let turns = d.x.atan2(d.y).rem_euclid(TAU) / TAU * AZIMUTHS as f64;
        let low = turns as usize % AZIMUTHS;
        let share = turns - turns.floor();
        let skyline = &self.skyline_rad;
        (elevation_rad, (1.0 - share) * skyline[low] + share * skyline[(low + 1) % AZIMUTHS])
    }

    fn azimuth_rad(&self, towards: DVec3) -> f64 {
        self.local[0].dot(towards).atan2(self.local[1].dot(towards)).rem_euclid(TAU)
    }
}

/// A place's light over a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    pub lit_share: f64,
    pub disc_share: f64,
    pub longest_night_h: f64,
    pub earth_share: f64,
}

impl Summary {
    pub fn of(moments: &[Moment], step_h: f64) -> Self {
        let steps = moments.len() as f64;
        let share = |holds: &dyn Fn(&Moment) -> bool| moments.iter().filter(|m| holds(m)).count() as f64 / steps;
        let nights = moments.split(|moment| moment.lit).map(<[Moment]>::len);
        Self {
            lit_share: share(&|moment| moment.lit),
            disc_share: moments.iter().map(|moment| moment.share).sum::<f64>() / steps,
            longest_night_h: nights.max().unwrap_or(0) as f64 * step_h,
            earth_share: share(&|moment| moment.earth_seen),
        }
    }
}
