//! Where the camera and the lights are at each exposure.

use hifitime::{Epoch, Unit};

use super::lights::{Lit, Sky};
use super::{Error, scene};
use crate::camera::Pose;
use crate::ephemeris::aem::Aem;
use crate::ephemeris::attitude::{AttitudeTable, Pointing, Quaternion, Top};
use crate::ephemeris::trajectory::{Elements, Oem, SpkObject, SplineEnds, Trajectory, TwoBody, Waypoints};
use crate::ephemeris::{Almanac, BodyFrame, Source, utc_text};
use crate::geometry::{BodyFixed, Direction, Geodetic, Position};
use crate::horizon::ElevationBand;
use crate::render::{Light, View};
use crate::scenario::{self, HeightAbove, Scenario, Towards};
use crate::shadow::QuantizedLight;
use crate::terrain::Surface;

/// An exposure: its instant, the Sun over the terrain's centre, and what a renderer sees at that instant.
#[derive(Debug, Clone)]
pub struct Exposure {
    /// Of the scenario's sweep, counted from 0.
    pub point: usize,
    pub epoch: Epoch,
    /// Of the camera, against the turning body.
    pub velocity_m_s: glam::DVec3,
    pub sun: Source,
    /// Share of the Sun's light that the Earth leaves; `None`: nobody asked, or no kernel has the Earth.
    pub eclipse_share: Option<f64>,
    pub view: View,
    /// At times from the epoch, in order, while an image takes its time; none: the view's all the time.
    pub moving_lights: Vec<(f64, Vec<Light>)>,
}

impl Exposure {
    /// The view at a time from the epoch.
    pub fn view_at(&self, time_s: f64, pose: &Pose) -> View {
        let view = self.view.from(pose);
        let later = self.moving_lights.partition_point(|(at_s, _)| *at_s < time_s);
        let beside = self.moving_lights[later.saturating_sub(1)..].iter().take(2);
        let nearest = beside.min_by(|a, b| (a.0 - time_s).abs().total_cmp(&(b.0 - time_s).abs()));
        nearest.map_or(view.clone(), |(_, lights)| View { lights: lights.clone(), ..view })
    }

    /// The lights as methods see them that find horizons in advance: all that the image is lit by, in their order.
    pub fn quantized_lights(&self) -> Vec<Vec<QuantizedLight>> {
        let own = [&self.view.lights].into_iter().chain(self.moving_lights.iter().map(|(_, lights)| lights));
        let quantized = |light: &Light| QuantizedLight::new(light.position, light.angular_radius_rad);
        let mut all: Vec<Vec<_>> = own.map(|lights| lights.iter().map(quantized).collect()).collect();
        all.dedup();
        all
    }
}

/// Where the camera is at any epoch, and how it is turned.
#[derive(Debug)]
pub struct Motion {
    trajectory: Path,
    pointing: Attitude,
}

/// Where it comes from.
#[derive(Debug)]
enum Path {
    Trajectory(Trajectory),
    /// Poses of an image's exposures in the middle of their times, at times from the image's middle.
    Poses(Vec<(f64, Pose)>),
}

/// All exposures of a scenario at all points of its sweep, before any of them is rendered, and each point's motion.
pub fn exposures(
    points: &[Scenario],
    almanac: &Almanac,
    frame: &BodyFrame,
    surface: &Surface,
    centre: Geodetic,
) -> Result<(Vec<Exposure>, Vec<Motion>), Error> {
    let (outcomes, motions) = outcomes(points, almanac, frame, surface, centre)?;
    Ok((outcomes.into_iter().collect::<Result<_, _>>()?, motions))
}

/// As [`exposures`], each with what stands against it.
#[allow(clippy::type_complexity)]
pub fn outcomes(
    points: &[Scenario],
    almanac: &Almanac,
    frame: &BodyFrame,
    surface: &Surface,
    centre: Geodetic,
) -> Result<(Vec<Result<Exposure, Error>>, Vec<Motion>), Error> {
    let (mut all, mut motions) = (Vec::new(), Vec::new());
    for (point, scenario) in points.iter().enumerate() {
        let first = all.len();
        let (outcomes, motion) = of_point(scenario, [point, first], almanac, frame, surface, centre)?;
        all.extend(outcomes);
        motions.push(motion);
    }
    Ok((all, motions))
}

/// The exposures at a point, the first of which is the dataset's `first`.
#[allow(clippy::type_complexity)]
fn of_point(
    scenario: &Scenario,
    [point, first]: [usize; 2],
    almanac: &Almanac,
    frame: &BodyFrame,
    surface: &Surface,
    centre: Geodetic,
) -> Result<(Vec<Result<Exposure, Error>>, Motion), Error> {
    let motion = Motion::new(scenario, almanac, frame, surface)?;
    let sky = Sky { scenario, almanac, frame, centre };
    let reach_s = scene::timing(scenario).reach_s(scenario.camera.longest_exposure_s());
    let seconds = scene::timing(scenario).seconds();
    let exposure = |(index, &epoch): (usize, &Epoch)| {
        let index = first + index;
        // The middle last: it is the view's. Poses in between are met while rendering, within the same spans.
        let ends = if reach_s > 0.0 { vec![-reach_s, reach_s, 0.0] } else { vec![0.0] };
        let mut middle = None;
        for offset_s in ends {
            let here = motion.state(almanac, frame, epoch, offset_s)?;
            check_clearance(surface, index, epoch, here.0.position)?;
            middle = Some(here);
        }
        let (pose, velocity_m_s) = middle.expect("the middle is among the ends");
        let Lit { sun, eclipse_share, lights } = sky.at(epoch)?;
        let view = View { exposure: index as u64, ..scene::view(scenario, pose, lights)? };
        let moving_lights = sky.during(epoch, &seconds)?;
        Ok(Exposure { point, epoch, velocity_m_s, sun, eclipse_share, view, moving_lights })
    };
    Ok((scenario.exposures.iter().enumerate().map(exposure).collect(), motion))
}

impl Motion {
    fn new(scenario: &Scenario, almanac: &Almanac, frame: &BodyFrame, surface: &Surface) -> Result<Self, Error> {
        let pointing = pointing(scenario, frame, surface)?;
        let trajectory = match (&scenario.trajectory, &scenario.camera.isd) {
            (scenario::Trajectory::Isd, Some(isd)) => {
                let bands = isd.shutter.pieces(scenario.camera.rows).into_iter().flatten();
                Path::Poses(bands.map(|band| band.time_s).zip(isd.camera.poses.iter().copied()).collect())
            }
            _ => Path::Trajectory(trajectory(scenario, almanac, frame, surface)?),
        };
        Ok(Self { trajectory, pointing })
    }

    /// The pose at a time from an exposure's epoch.
    pub fn pose(&self, almanac: &Almanac, frame: &BodyFrame, epoch: Epoch, offset_s: f64) -> Result<Pose, Error> {
        Ok(self.state(almanac, frame, epoch, offset_s)?.0)
    }

    /// The same with the velocity against the turning body, in m/s.
    fn state(
        &self,
        almanac: &Almanac,
        frame: &BodyFrame,
        epoch: Epoch,
        offset_s: f64,
    ) -> Result<(Pose, glam::DVec3), Error> {
        let trajectory = match &self.trajectory {
            Path::Trajectory(trajectory) => trajectory,
            Path::Poses(poses) => return Ok((nearest(poses, offset_s), mean_velocity_m_s(poses))),
        };
        let epoch = if offset_s == 0.0 { epoch } else { epoch + offset_s * Unit::Second };
        let (position, velocity_m_s) = trajectory.state(almanac, frame, epoch)?;
        let camera_from_body = match &self.pointing {
            Attitude::Law(law) => law.camera_from_body(&frame.body, epoch, position, velocity_m_s)?,
            Attitude::Message(message) => message.camera_from_body(almanac, frame, epoch)?,
        };
        Ok((Pose { position, camera_from_body }, velocity_m_s))
    }

    /// Poses at times from an exposure's epoch: of each band, of each moment.
    pub fn poses(
        &self,
        almanac: &Almanac,
        frame: &BodyFrame,
        epoch: Epoch,
        times_s: &[Vec<f64>],
    ) -> Result<Vec<Vec<Pose>>, Error> {
        let of_band = |times: &Vec<f64>| times.iter().map(|&time| self.pose(almanac, frame, epoch, time)).collect();
        times_s.iter().map(of_band).collect()
    }
}

/// From the first pose to the last; none of a camera that has but one.
fn mean_velocity_m_s(poses: &[(f64, Pose)]) -> glam::DVec3 {
    let [(from_s, from), .., (until_s, until)] = poses else { return glam::DVec3::ZERO };
    (until.position.vector_m() - from.position.vector_m()) / (until_s - from_s)
}

/// The one whose time is nearest: bands are asked for at their own times, the image's middle between two of them.
fn nearest(poses: &[(f64, Pose)], offset_s: f64) -> Pose {
    let distance = |(time_s, _): &&(f64, Pose)| (time_s - offset_s).abs();
    poses.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("an ISD has a pose").1
}

/// A band of a larger reach leaves out nothing that a skyline has.
const WIDEST_BAND_RAD: f64 = std::f64::consts::FRAC_PI_3;

/// The elevations that the Sun's disc reaches in the exposures, where the scenario asks for horizons within them.
pub fn band(scenario: &Scenario, exposures: &[Exposure]) -> Result<Option<ElevationBand>, Error> {
    if !scenario.horizon.band {
        return Ok(None);
    }
    let others = [
        (scenario.earthshine_albedo.is_some(), "earthshine comes from elsewhere"),
        (scenario.ambient.is_some(), "ambient light comes from elsewhere"),
        (scenario.bounce.is_some(), "bounced light comes from elsewhere"),
    ];
    if let Some((_, why)) = others.into_iter().find(|(is_there, _)| *is_there) {
        return Err(Error::NoBand { why });
    }
    let of_exposure = |exposure: &Exposure| -> Vec<_> {
        let moving =
            exposure.moving_lights.iter().filter_map(|(_, lights)| Direction::new(lights[0].position.vector_m()));
        [exposure.sun.direction].into_iter().chain(moving).map(|sun| (sun, exposure.sun.angular_radius_rad)).collect()
    };
    let suns: Vec<_> = exposures.iter().flat_map(of_exposure).collect();
    let band = ElevationBand::about(&suns).filter(|band| band.reach_rad < WIDEST_BAND_RAD);
    let why = "over its exposures the Sun goes through more than 120°, so that hardly an elevation could be left out";
    band.map(Some).ok_or(Error::NoBand { why })
}

fn check_clearance(surface: &Surface, index: usize, epoch: Epoch, position: Position<BodyFixed>) -> Result<(), Error> {
    let body = &surface.terrain.body;
    let height_m = body.geodetic_from_position(position).height_m;
    let ground_m = body.geodetic_from_position(surface.below(position)).height_m;
    if height_m > ground_m {
        return Ok(());
    }
    Err(Error::BelowGround { exposure: index, epoch_utc: utc_text(epoch), height_m, ground_m })
}

/// The point with its height counted from the reference surface.
fn on_body(surface: &Surface, point: Geodetic, above: HeightAbove) -> Position<BodyFixed> {
    let body = &surface.terrain.body;
    let position = body.position_from_geodetic(point);
    match above {
        HeightAbove::Spheroid => position,
        HeightAbove::Terrain => {
            let ground_m = body.geodetic_from_position(surface.below(position)).height_m;
            body.position_from_geodetic(Geodetic { height_m: ground_m + point.height_m, ..point })
        }
    }
}

fn trajectory(
    scenario: &Scenario,
    almanac: &Almanac,
    frame: &BodyFrame,
    surface: &Surface,
) -> Result<Trajectory, Error> {
    let gm = |written: &Option<f64>| written.map_or_else(|| almanac.gravitational_parameter_m3_s2(&frame.body), Ok);
    Ok(match &scenario.trajectory {
        scenario::Trajectory::Waypoints { points, height_above } => {
            let start = points[0].epoch;
            let offset = |epoch: Epoch| (epoch - start).to_unit(Unit::Second);
            let mut points: Vec<_> =
                points.iter().map(|p| (offset(p.epoch), on_body(surface, p.point, *height_above))).collect();
            if let [(from_s, alone)] = points[..] {
                // One point is a camera that stands still, from the first exposure to the last.
                let [first, last] = [scenario.exposures.first(), scenario.exposures.last()];
                let reach_s = scene::timing(scenario).reach_s(scenario.camera.longest_exposure_s());
                let until_s = last.map_or(from_s, |epoch| offset(*epoch)).max(from_s) + 1.0 + reach_s;
                points[0].0 = first.map_or(from_s, |epoch| offset(*epoch)).min(from_s) - reach_s;
                points.push((until_s, alone));
            }
            Trajectory::Waypoints(Waypoints::new(start, &points, SplineEnds::Natural)?)
        }
        scenario::Trajectory::Spk { naif_id, .. } => Trajectory::Spk(SpkObject { naif_id: *naif_id }),
        scenario::Trajectory::Oem { path } => Trajectory::Oem(Oem::read(path)?),
        scenario::Trajectory::Orbit { epoch, elements, gm_m3_s2 } => {
            let elements = Elements {
                semi_major_axis_m: elements.semi_major_axis_m,
                eccentricity: elements.eccentricity,
                inclination_rad: elements.inclination_rad,
                ascending_node_rad: elements.node_rad,
                argument_of_periapsis_rad: elements.periapsis_rad,
                true_anomaly_rad: elements.true_anomaly_rad,
            };
            Trajectory::TwoBody(TwoBody::from_elements(*epoch, elements, gm(gm_m3_s2)?)?)
        }
        scenario::Trajectory::State { epoch, position_m, velocity_m_s, gm_m3_s2 } => {
            Trajectory::TwoBody(TwoBody::from_state(*epoch, *position_m, *velocity_m_s, gm(gm_m3_s2)?)?)
        }
        scenario::Trajectory::Isd => unreachable!("an ISD has poses, not a trajectory"),
    })
}

/// Where the camera looks.
#[derive(Debug)]
enum Attitude {
    Law(Pointing),
    Message(Aem),
}

fn pointing(scenario: &Scenario, frame: &BodyFrame, surface: &Surface) -> Result<Attitude, Error> {
    let roll_rad = scenario.pointing.roll_rad;
    let top = |default: Top| match scenario.pointing.top {
        None => default,
        Some(scenario::Top::North) => Top::North,
        Some(scenario::Top::Velocity) => Top::Velocity,
        Some(scenario::Top::Up) => Top::Up,
    };
    Ok(Attitude::Law(match &scenario.pointing.towards {
        Towards::Nadir => Pointing::Nadir { top: top(Top::North), roll_rad },
        Towards::AlongVelocity => Pointing::AlongVelocity { top: top(Top::Up), roll_rad },
        Towards::At { point, height_above } => {
            let point = frame.body.geodetic_from_position(on_body(surface, *point, *height_above));
            Pointing::AtPoint { point, top: top(Top::Up), roll_rad }
        }
        Towards::Table(rows) => {
            let start = rows[0].0;
            let quaternion = |q: &glam::DQuat| Quaternion::from_wxyz([q.w, q.x, q.y, q.z]);
            let rows = rows
                .iter()
                .map(|(epoch, q)| Ok(((*epoch - start).to_unit(Unit::Second), quaternion(q)?)))
                .collect::<Result<Vec<_>, Error>>()?;
            match rows[..] {
                [(_, fixed)] => Pointing::Fixed(fixed),
                _ => Pointing::Table(AttitudeTable::new(start, &rows)?),
            }
        }
        Towards::Aem { path } => return Ok(Attitude::Message(Aem::read(path)?)),
    }))
}
