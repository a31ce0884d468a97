//! Bad scenarios and what is said about each: line, column, key, what was got and what is allowed.

use std::path::Path;

use perilune_engine::scenario::{SearchPath, resolve};
use tempfile::TempDir;

/// A scenario without a fault. `dem.tif` lies beside it; nothing opens it here.
const GOOD: &str = r#"(
    title: "a test",
    terrain: (dems: [File(path: "dem.tif")]),
    surface: (photometry: Lambert, albedo: Constant(0.12)),
    trajectory: Waypoints(points: [
        (t_s: 0, latitude_deg: -89.5, longitude_deg: 0, height_m: 2000),
        (t_s: 60, latitude_deg: -89.6, longitude_deg: 0, height_m: 1000),
    ]),
    pointing: (towards: Nadir),
    camera: (columns: 64, rows: 48, focal_length_mm: 50, pixel_pitch_um: 10),
    exposures: Series(start: "2026-08-01T00:00:00 UTC", step_s: 20, count: 4),
    outputs: (planes: [radiance, depth]),
)
"#;

const TRAJECTORY: &str = "Waypoints(points: [
        (t_s: 0, latitude_deg: -89.5, longitude_deg: 0, height_m: 2000),
        (t_s: 60, latitude_deg: -89.6, longitude_deg: 0, height_m: 1000),
    ])";

/// What is wrong, how the good scenario is changed to show it, and what is then said.
struct Case(&'static str, &'static str, &'static str, &'static str);

const STRUCTURE: &[Case] = &[
    Case(
        "unknown key",
        "columns: 64,",
        "colums: 64, columns: 64,",
        "10:14: camera.colums is not a key here; did you mean columns?; allowed: auto_exposure, band_nm, columns, \
         correction, distortion, exposure_s, f_number, field_of_view_deg, focal_length_mm, isd, moments, pixel_pitch_um, \
         preset, principal_point, psf, response, rows, samples_per_pixel, shutter, transmission, vignetting",
    ),
    Case(
        "unknown key at the top",
        "title: \"a test\"",
        "title: \"a test\", tides: 3",
        "2:22: tides is not a key here; allowed: ambient, body, bounce, camera, detector, earthshine, exposures, \
         frame, hazards, horizon, kernels, landmarks, outputs, pointing, refine, seed, shadows, split, sun, surface, sweep, terrain, title, \
         trajectory, view_rays",
    ),
    Case(
        "runs of too many mips",
        "title: \"a test\"",
        "title: \"a test\", shadows: MaximumMipmaps(runs: [5, 16])",
        "2:56: shadows.runs[1] = 16 is outside [1, 15]",
    ),
    Case(
        "a spectrum without a band",
        "title: \"a test\"",
        "title: \"a test\", sun: (spectrum: E490)",
        "2:38: sun.spectrum needs camera.band_nm or camera.response; without a band all of sunlight counts",
    ),
    Case(
        "a spectrum and an irradiance",
        "title: \"a test\"",
        "title: \"a test\", sun: (spectrum: E490, irradiance_w_m2: 500)",
        "2:38: sun.spectrum contradicts irradiance_w_m2; give one of the two",
    ),
    Case(
        "a band beyond the spectrum",
        "columns: 64,",
        "band_nm: (300, 700), columns: 64,",
        "10:23: camera.band_nm reaches from 300 to 700 nm; TSIS-1 HSRS v2, 1 nm has 350 to 2500 nm",
    ),
    Case(
        "a phase function beside a law that has its own",
        "photometry: Lambert,",
        "photometry: HapkeMoon, phase_function: Moon,",
        "4:54: surface.phase_function needs a model without a phase function of its own",
    ),
    Case("missing key", "rows: 48, ", "", "10:13: camera.rows is missing"),
    Case(
        "missing section",
        "    camera: (columns: 64, rows: 48, focal_length_mm: 50, pixel_pitch_um: 10),\n",
        "",
        "1:1: camera is missing",
    ),
    Case("key written twice", "rows: 48", "rows: 48, rows: 49", "10:37: camera.rows is written twice"),
    Case(
        "text for a number",
        "columns: 64",
        "columns: \"wide\"",
        "10:23: camera.columns = \"wide\" is not a whole number",
    ),
    Case(
        "fraction for a whole number",
        "columns: 64",
        "columns: 64.5",
        "10:23: camera.columns = 64.5 is not a whole number",
    ),
    Case("number for text", "title: \"a test\"", "title: 7", "2:12: title = 7 is not text in quotes"),
    Case("number for a switch", "planes: [", "tiff: 1, planes: [", "12:21: outputs.tiff = 1 is not true or false"),
    Case(
        "number for a struct",
        "camera: (columns: 64, rows: 48, focal_length_mm: 50, pixel_pitch_um: 10)",
        "camera: 3",
        "10:13: camera = 3 is not a group of keys, as in (key: …)",
    ),
    Case(
        "a method with keys without parentheses",
        "title: \"a test\",",
        "title: \"a test\", shadows: Swath,",
        "2:31: shadows = Swath is not Swath()",
    ),
    Case(
        "number for a list",
        "planes: [radiance, depth]",
        "planes: radiance",
        "12:23: outputs.planes = radiance is not a list in [ ]",
    ),
    Case(
        "text for an enum",
        "towards: Nadir",
        "towards: \"Nadir\"",
        "9:25: pointing.towards = \"Nadir\" is not one of Nadir, At, AlongVelocity, Quaternion, Table, Aem",
    ),
    Case(
        "misspelt variant",
        "towards: Nadir",
        "towards: Nadier",
        "9:25: pointing.towards = Nadier is not one of Nadir, At, AlongVelocity, Quaternion, Table, Aem; did you mean \
         Nadir?",
    ),
    Case(
        "refinement of what has no known error",
        "title: \"a test\"",
        "title: \"a test\", refine: true, shadows: Sweep()",
        "2:30: refine needs shadows from horizon maps with all their coefficients and no visibility, whose errors are known",
    ),
    Case(
        "unknown plane",
        "[radiance, depth]",
        "[radiance, dept]",
        "12:34: outputs.planes[1] = dept is not one of radiance, spectral_radiance, ground_irradiance, \
         spectral_ground_irradiance, radiance_factor, focal_plane_irradiance, digital_number, \
         noise_free_digital_number, sun_fraction, sun_fraction_sigma, hit, dem_gap, depth, range, normal, latitude, \
         longitude, height, incidence, emission, phase, ground_sample_distance, sun_illumination_mask, \
         ellipsoid_incidence, ellipsoid_emission, slope, aspect, north_azimuth, sun_azimuth, subsolar_ground_azimuth, \
         flow, covisible, flow_back, covisible_back, shadow_change, hazard_slope, hazard_roughness, hazard_sunlit, \
         hazard, invented_height; did you mean depth?",
    ),
    Case(
        "variant without its content",
        "towards: Nadir",
        "towards: At",
        "9:25: pointing.towards = At is not At(latitude_deg, longitude_deg)",
    ),
    Case(
        "content where none belongs",
        "photometry: Lambert",
        "photometry: Lambert(0.1)",
        "4:27: surface.photometry = Lambert(…) is not Lambert without parentheses",
    ),
    Case(
        "band of one number",
        "columns: 64",
        "band_nm: (400), columns: 64",
        "10:23: camera.band_nm has 1 entries, allowed are 2 to 2",
    ),
];

const RANGES: &[Case] = &[
    Case(
        "azimuths no step apart",
        "title: \"a test\",",
        "title: \"a test\", shadows: Swath(azimuth_step_deg: 0),",
        "2:55: shadows.azimuth_step_deg = 0 is outside [0.01, 5] deg",
    ),
    Case(
        "samples no step apart",
        "title: \"a test\",",
        "title: \"a test\", shadows: SingleAzimuth(spacing: 0),",
        "2:54: shadows.spacing = 0 is outside [0.1, 100]",
    ),
    Case(
        "negative focal length",
        "focal_length_mm: 50",
        "focal_length_mm: -50",
        "10:54: camera.focal_length_mm = -50 is outside [1, 10000] mm",
    ),
    Case(
        "focal length in metres",
        "focal_length_mm: 50",
        "focal_length_mm: 0.05",
        "10:54: camera.focal_length_mm = 0.05 is outside [1, 10000] mm",
    ),
    Case("NaN", "height_m: 1000", "height_m: NaN", "7:68: trajectory.points[1].height_m = NaN is not finite"),
    Case("infinity", "height_m: 1000", "height_m: inf", "7:68: trajectory.points[1].height_m = inf is not finite"),
    Case(
        "negative infinity",
        "focal_length_mm: 50",
        "focal_length_mm: -inf",
        "10:54: camera.focal_length_mm = -inf is not finite",
    ),
    Case(
        "latitude beyond the pole",
        "latitude_deg: -89.6",
        "latitude_deg: -90.6",
        "7:33: trajectory.points[1].latitude_deg = -90.6 is outside [-90, 90] deg",
    ),
    Case(
        "longitude beyond a turn",
        "longitude_deg: 0, height_m: 1000",
        "longitude_deg: 720, height_m: 1000",
        "7:55: trajectory.points[1].longitude_deg = 720 is outside [-360, 360] deg",
    ),
    Case("no columns", "columns: 64", "columns: 0", "10:23: camera.columns = 0 is outside [1, 16384]"),
    Case("negative rows", "rows: 48", "rows: -48", "10:33: camera.rows = -48 is outside [1, 65536]"),
    Case("albedo above one", "Constant(0.12)", "Constant(12)", "4:53: surface.albedo = 12 is outside [0, 1]"),
    Case("no exposures", "count: 4", "count: 0", "11:76: exposures.count = 0 is outside [1, 100000]"),
    Case("step back in time", "step_s: 20", "step_s: -20", "11:65: exposures.step_s = -20 is outside [1e-6, 1e9] s"),
    Case(
        "empty list of exposures",
        "Series(start: \"2026-08-01T00:00:00 UTC\", step_s: 20, count: 4)",
        "List([])",
        "11:21: exposures has 0 entries, allowed are 1 to 100000",
    ),
    Case("no outputs", "[radiance, depth]", "[]", "12:23: outputs.planes has 0 entries, allowed are 1 to 64"),
    Case(
        "no elevation model",
        "[File(path: \"dem.tif\")]",
        "[]",
        "3:21: terrain.dems has 0 entries, allowed are 1 to 8",
    ),
    Case(
        "no waypoints",
        "        (t_s: 0, latitude_deg: -89.5, longitude_deg: 0, height_m: 2000),\n        \
         (t_s: 60, latitude_deg: -89.6, longitude_deg: 0, height_m: 1000),\n    ",
        "",
        "5:35: trajectory.points has 0 entries, allowed are 1 to 100000",
    ),
    Case(
        "field of view of a half turn",
        "focal_length_mm: 50",
        "field_of_view_deg: 180",
        "10:56: camera.field_of_view_deg = 180 is outside [1e-4, 170] deg",
    ),
    Case(
        "Sun below the scale",
        "pointing:",
        "sun: (irradiance_w_m2: -1361),\n    pointing:",
        "9:28: sun.irradiance_w_m2 = -1361 is outside [0, 1e6] W m-2",
    ),
    Case(
        "radius of zero",
        "pointing:",
        "body: Custom(name: \"x\", naif_id: 9, equatorial_radius_m: 0, polar_radius_m: 1),\n    frame: \"X\",\n    \
         pointing:",
        "9:62: body.equatorial_radius_m = 0 is outside [1, 1e9] m",
    ),
];

const MEANING: &[Case] = &[
    Case(
        "terrain nearer than sweeps begin",
        "title: \"a test\"",
        "title: \"a test\", shadows: TowardsSun(by: Sweep(near: 3))",
        "2:31: shadows.near = 3 is neither 0 nor at least 8: nearer than that lines a posting apart do not meet what they pass",
    ),
    Case(
        "coefficients that fill no page",
        "title: \"a test\"",
        "title: \"a test\", shadows: Series(coefficients: 10)",
        "2:52: shadows.coefficients = 10 is not 4, 8, 12 or 16: four make a page of texels",
    ),
    Case(
        "more coefficients than the encoding has",
        "title: \"a test\"",
        "title: \"a test\", shadows: Series(coefficients: 12), horizon: Settings(encoding: Fm8)",
        "2:52: shadows.coefficients needs 12 coefficients, which horizon.encoding fm8 has not; fm12 or more and f12 or more \
         have them",
    ),
    Case(
        "a preset of an encoding without coefficients",
        "title: \"a test\"",
        "title: \"a test\", shadows: Preset(Low), horizon: Settings(encoding: W21)",
        "2:31: shadows needs 8 coefficients, which horizon.encoding w21 has not; fm8 or more and f8 or more have them",
    ),
    Case(
        "a format twice",
        "planes: [radiance, depth]",
        "formats: [Fits, Npz, Fits]",
        "12:36: outputs.formats[2] = Fits is listed twice",
    ),
    Case(
        "a sweep of nothing",
        "pointing:",
        "sweep: (design: Grid),\n    pointing:",
        "9:12: sweep needs something that varies, as in sun_azimuth_deg: Range(from: 0, to: 360)",
    ),
    Case(
        "a sweep of a Sun that the kernels place",
        "pointing:",
        "sweep: (design: Grid, sun_azimuth_deg: Values([10])),\n    pointing:",
        "9:44: sweep.sun_azimuth_deg needs sun.fixed, which says the rest of where the Sun stands",
    ),
    Case(
        "a grid without values",
        "pointing:",
        "sweep: (design: Grid, albedo: Range(from: 0.1, to: 0.2)),\n    pointing:",
        "9:35: sweep.albedo needs Values or Steps: a grid has points at given values only",
    ),
    Case(
        "an albedo above 1",
        "pointing:",
        "sweep: (design: Uniform(count: 3), albedo: Range(from: 0.1, to: 1.2)),\n    pointing:",
        "9:48: sweep.albedo = 0.1 to 1.2 is not within [0, 1]",
    ),
    Case(
        "a sweep without end",
        "pointing:",
        "sweep: (design: Grid, north_m: Steps(from: 0, to: 1, count: 1000), east_m: Steps(from: 0, to: 1, count: 1000)),\n    \
         pointing:",
        "9:21: sweep.design = 1000000 points make 4000000 images, at most 1000000 are allowed",
    ),
    Case(
        "a split that is none",
        "pointing:",
        "split: (train: 0.8, validation: 0.1, test: 0.2, cell_m: 1000),\n    pointing:",
        "9:12: split = 1.1000 is what train, validation and test add up to, want 1 within 0.001",
    ),
    Case("empty title", "\"a test\"", "\" \"", "2:12: title = \"\" must say what the sequence shows"),
    Case(
        "two optics",
        "pixel_pitch_um: 10",
        "pixel_pitch_um: 10, field_of_view_deg: 20",
        "10:97: camera.field_of_view_deg contradicts focal_length_mm; give one of the two",
    ),
    Case(
        "no optics",
        "focal_length_mm: 50, ",
        "",
        "10:13: camera needs focal_length_mm with pixel_pitch_um, or field_of_view_deg",
    ),
    Case("no pixel pitch", ", pixel_pitch_um: 10", "", "10:54: camera.focal_length_mm needs pixel_pitch_um"),
    Case(
        "samples not a square",
        "columns: 64",
        "samples_per_pixel: 5, columns: 64",
        "10:33: camera.samples_per_pixel = 5 is not a square number, as are 1, 4, 9, 16",
    ),
    Case(
        "image too large",
        "columns: 64, rows: 48",
        "columns: 16384, rows: 16384",
        "10:23: camera.columns = 16384 with 16384 rows has 268435456 pixels, allowed are 67108864",
    ),
    Case(
        "band upside down",
        "columns: 64",
        "band_nm: (700, 400), columns: 64",
        "10:23: camera.band_nm = (700, 400) must rise from its lower to its upper end within [100, 20000] nm",
    ),
    Case(
        "band in micrometres",
        "columns: 64",
        "band_nm: (0.4, 0.7), columns: 64",
        "10:23: camera.band_nm = (0.4, 0.7) must rise from its lower to its upper end within [100, 20000] nm",
    ),
    Case(
        "epoch without a scale",
        "00:00 UTC",
        "00:00",
        "11:30: exposures.start = \"2026-08-01T00:00:00\" is not an epoch with its scale, as in 2026-08-01T00:00:00 UTC \
         or 2026-08-01T00:00:00 TDB",
    ),
    Case(
        "31 June",
        "2026-08-01",
        "2026-06-31",
        "11:30: exposures.start = \"2026-06-31T00:00:00 UTC\" is not an epoch with its scale, as in \
         2026-08-01T00:00:00 UTC or 2026-08-01T00:00:00 TDB",
    ),
    Case(
        "epochs not in order",
        "Series(start: \"2026-08-01T00:00:00 UTC\", step_s: 20, count: 4)",
        "List([\"2026-08-01T00:00:30Z\", \"2026-08-01T00:00:30 UTC\"])",
        "11:46: exposures[1] = \"2026-08-01T00:00:30 UTC\" is not later than the epoch before it",
    ),
    Case(
        "waypoints not in order",
        "t_s: 60",
        "t_s: 0",
        "7:15: trajectory.points[1].t_s = 0 is not later than the 0 s before it",
    ),
    Case(
        "exposures after the path",
        "count: 4",
        "count: 5",
        "7:15: trajectory.points[1].t_s = 60 is before the last exposure at 80 s",
    ),
    Case(
        "exposures before the path",
        "t_s: 0",
        "t_s: 5",
        "6:15: trajectory.points[0].t_s = 5 is after the first exposure at 0 s",
    ),
    Case(
        "quaternion of zero",
        "towards: Nadir",
        "towards: Quaternion(w: 0, x: 0, y: 0, z: 0)",
        "9:25: pointing.towards = (w: 0, x: 0, y: 0, z: 0) has length 0.0000, allowed is 1 within 0.001",
    ),
    Case(
        "quaternion too long",
        "towards: Nadir",
        "towards: Quaternion(w: 1, x: 0.1, y: 0, z: 0)",
        "9:25: pointing.towards = (w: 1, x: 0.1, y: 0, z: 0) has length 1.0050, allowed is 1 within 0.001",
    ),
    Case(
        "attitudes not in order",
        "towards: Nadir",
        "towards: Table(points: [(t_s: 99, w: 1, x: 0, y: 0, z: 0), (t_s: 99, w: 1, x: 0, y: 0, z: 0)])",
        "9:81: pointing.towards.points[1].t_s = 99 is not later than the 99 s before it",
    ),
    Case(
        "Sun held over no terrain",
        "    terrain: (dems: [File(path: \"dem.tif\")]),\n",
        "    sun: (fixed: (azimuth_deg: 0, elevation_deg: 1)),\n",
        "3:18: sun.fixed needs terrain: the Sun is held in the sky of the terrain's centre",
    ),
    Case(
        "body without a frame",
        "pointing:",
        "body: Custom(name: \"x\", naif_id: 9, equatorial_radius_m: 1, polar_radius_m: 1),\n    pointing:",
        "9:11: body needs frame, the name of its body-fixed frame",
    ),
    Case(
        "frame that is no name",
        "pointing:",
        "frame: \"moon me\",\n    pointing:",
        "9:12: frame = \"moon me\" is not a frame's name, as in MOON_ME_DE440_ME421",
    ),
    Case(
        "no kernels in the list",
        "pointing:",
        "kernels: [],\n    pointing:",
        "9:14: kernels = [] names no kernel; leave the key out for the shipped ones",
    ),
    Case(
        "coarse elevation model first",
        "File(path: \"dem.tif\")",
        "File(path: \"dem.tif\", posting_m: 20), File(path: \"dem.tif\", posting_m: 5)",
        "3:93: terrain.dems[1].posting_m = 5 is not coarser than the 20 m of dems[0]; the finest comes first",
    ),
    Case(
        "whole body before a part",
        "File(path: \"dem.tif\")",
        "Cube(path: \"dem.tif\"), File(path: \"dem.tif\")",
        "3:22: terrain.dems[0] covers the whole body, so it must be the last",
    ),
    Case(
        "globe beside another model",
        "File(path: \"dem.tif\")",
        "Globe(path: \"dem.tif\"), File(path: \"dem.tif\")",
        "3:22: terrain.dems[0] must be the only model: it has all levels",
    ),
    Case(
        "velocity of a camera that stands still",
        "Waypoints(points: [
        (t_s: 0, latitude_deg: -89.5, longitude_deg: 0, height_m: 2000),
        (t_s: 60, latitude_deg: -89.6, longitude_deg: 0, height_m: 1000),
    ]),
    pointing: (towards: Nadir",
        "Waypoints(points: [(t_s: 0, latitude_deg: -89.5, longitude_deg: 0, height_m: 2000)]),
    pointing: (towards: AlongVelocity",
        "6:25: pointing.towards needs a trajectory that moves: of two waypoints or more",
    ),
    Case(
        "plane listed twice",
        "[radiance, depth]",
        "[radiance, sun_fraction, radiance]",
        "12:48: outputs.planes[2] = radiance is listed twice",
    ),
    Case(
        "spacecraft without a kernel",
        TRAJECTORY,
        "Spk(naif_id: -85)",
        "5:17: trajectory needs path: the shipped kernels hold no spacecraft",
    ),
    Case(
        "parabola",
        TRAJECTORY,
        "Orbit(epoch: \"2026-08-01T00:00:00 TDB\", semi_major_axis_m: 2e6, eccentricity: 1, inclination_deg: 90, \
         node_deg: 0, periapsis_deg: 0, true_anomaly_deg: 0)",
        "5:95: trajectory.eccentricity = 1 is a parabola, which these elements cannot describe; give a State",
    ),
    Case(
        "hyperbola with a positive axis",
        TRAJECTORY,
        "Orbit(epoch: \"2026-08-01T00:00:00 TDB\", semi_major_axis_m: 2e6, eccentricity: 2, inclination_deg: 90, \
         node_deg: 0, periapsis_deg: 0, true_anomaly_deg: 0)",
        "5:76: trajectory.semi_major_axis_m = 2000000 must be positive for an ellipse and negative for a hyperbola",
    ),
    Case(
        "orbit inside the Moon",
        TRAJECTORY,
        "State(epoch: \"2026-08-01T00:00:00 TDB\", position_m: (1000, 0, 0), velocity_m_s: (0, 1600, 0))",
        "5:69: trajectory.position_m = [1000, 0, 0] is inside the body, whose polar radius is 1737400 m",
    ),
    Case(
        "NaN in a vector",
        TRAJECTORY,
        "State(epoch: \"2026-08-01T00:00:00 TDB\", position_m: (2e6, NaN, 0), velocity_m_s: (0, 1600, 0))",
        "5:75: trajectory.position_m[1] = NaN is not finite",
    ),
    Case(
        "detector without a pitch",
        "focal_length_mm: 50, pixel_pitch_um: 10),",
        "field_of_view_deg: 20, band_nm: (400, 700)),\n    detector: (quantum_efficiency: 0.5, full_well_e: 1e4, \
         gain_e_per_dn: 10, bits: 12),",
        "11:15: detector needs camera.pixel_pitch_um: electrons are counted per area of a pixel",
    ),
    Case(
        "offset beyond the bits",
        "focal_length_mm: 50, pixel_pitch_um: 10),",
        "focal_length_mm: 50, pixel_pitch_um: 10, band_nm: (400, 700)),\n    detector: (quantum_efficiency: 0.5, \
         full_well_e: 1e4, gain_e_per_dn: 10, offset_dn: 255, bits: 8),",
        "11:89: detector.offset_dn = 255 is not below 255, the largest number of 8 bits",
    ),
];

const FILES: &[Case] = &[
    Case(
        "missing elevation model",
        "dem.tif",
        "dem/moon.tif",
        "3:33: terrain.dems[0].path = \"dem/moon.tif\" is not found in HERE, data; LOLA heights, to be had from \
         example.org",
    ),
    Case(
        "directory for a file",
        "dem.tif",
        "folder.tif",
        "3:33: terrain.dems[0].path = \"folder.tif\" is a directory, not a file",
    ),
    Case(
        "missing albedo map",
        "Constant(0.12)",
        "Map(path: \"/none.tif\")",
        "4:54: surface.albedo.path = \"/none.tif\" is not found",
    ),
    Case(
        "missing kernel",
        "pointing:",
        "kernels: [\"a.bsp\"],\n    pointing:",
        "9:15: kernels[0] = \"a.bsp\" is not found in HERE, data",
    ),
    Case(
        "missing orbit ephemeris",
        TRAJECTORY,
        "Oem(path: \"x.oem\")",
        "5:27: trajectory.path = \"x.oem\" is not found in HERE, data",
    ),
];

const SYNTAX: &[Case] = &[
    Case("missing bracket", "depth]", "depth", "12:39: expected comma"),
    Case("missing comma", "test\",", "test\"", "3:5: expected comma"),
    Case("open string", "test\"", "test", "3:34: expected comma"),
    Case("text after the end", "]),\n)\n", "]),\n)\n)\n", "13:2: non-whitespace trailing characters"),
    Case("seed too large", "pointing:", "seed: 99999999999999999999,\n    pointing:", "9:11: integer is out of bounds"),
];

/// The problems found after replacing `from` by `to`, without the file's name.
fn problems(from: &str, to: &str) -> String {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("dem.tif"), "").unwrap();
    std::fs::create_dir(folder.path().join("folder.tif")).unwrap();
    assert!(GOOD.contains(from), "the good scenario has no {from:?}");
    let text = GOOD.replacen(from, to, 1);
    let places = SearchPath { beside: folder.path().into(), data: vec!["data".into()] };
    let about = |name: &str| (name == "moon.tif").then(|| "LOLA heights, to be had from example.org".to_string());
    match resolve(Path::new("x.ron"), &text, &places, &about) {
        Ok(_) => String::new(),
        Err(error) => {
            let text = error.to_string().replace(&folder.path().display().to_string(), "HERE");
            text.lines().map(|line| line.trim_start_matches("x.ron:")).collect::<Vec<_>>().join("\n")
        }
    }
}

fn check(cases: &[Case]) {
    let wrong: Vec<String> = cases
        .iter()
        .map(|Case(what, from, to, said)| (what, problems(from, to), said))
        .filter(|(_, got, said)| got != *said)
        .map(|(what, got, said)| format!("{what}:\n  {got}\ninstead of\n  {said}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_good_scenario_has_no_problem() {
    assert_eq!(problems("title", "title"), "");
}

#[test]
fn wrong_keys_types_and_variants_are_named_with_their_place() {
    check(STRUCTURE);
}

#[test]
fn numbers_outside_their_range_are_named_with_range_and_unit() {
    check(RANGES);
}

#[test]
fn values_that_contradict_each_other_are_named() {
    check(MEANING);
}

#[test]
fn files_that_are_not_there_are_named_with_where_they_can_be_had() {
    check(FILES);
}

#[test]
fn broken_text_is_reported_where_it_breaks() {
    check(SYNTAX);
}

#[test]
fn all_problems_are_reported_together_in_the_order_of_lines() {
    let said = problems("columns: 64, rows: 48, focal_length_mm: 50", "columns: 0, focal_length_mm: -50");
    assert_eq!(
        said,
        "10:13: camera.rows is missing\n10:23: camera.columns = 0 is outside [1, 16384]\n\
         10:43: camera.focal_length_mm = -50 is outside [1, 10000] mm"
    );
    let said = problems(
        "rows: 48, focal_length_mm: 50, pixel_pitch_um: 10),\n    exposures: Series(start: \"2026-08-01T00:00:00 UTC\"",
        "rows: 48, samples_per_pixel: 3),\n    exposures: Series(start: \"tomorrow\"",
    );
    assert_eq!(said.lines().count(), 3, "{said}");
}

/// Every character dropped, every number replaced by what a tired user may write: always a message, never a panic.
#[test]
fn no_damage_to_a_scenario_makes_the_check_panic() {
    let places = SearchPath { beside: "nowhere".into(), data: Vec::new() };
    let check = |text: &str| drop(resolve(Path::new("x.ron"), text, &places, &|_| None));
    for (index, dropped) in GOOD.char_indices() {
        check(&format!("{}{}", &GOOD[..index], &GOOD[index + dropped.len_utf8()..]));
        check(&GOOD[..index]);
    }
    let is_number = |char: char| char.is_ascii_digit() || matches!(char, '-' | '.');
    let starts =
        GOOD.match_indices(": ").map(|(index, _)| index + 2).filter(|start| GOOD[*start..].starts_with(is_number));
    for start in starts {
        let end = start + GOOD[start..].find(|char| !is_number(char)).expect("the text goes on");
        for number in
            ["NaN", "inf", "-inf", "0", "-1", "1e300", "-1e300", "1e-300", "4294967295", "1_000", "0x10", "+5"]
        {
            check(&format!("{}{number}{}", &GOOD[..start], &GOOD[end..]));
        }
    }
}
