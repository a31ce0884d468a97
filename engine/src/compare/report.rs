//! What a comparison found, as a page, as JSON and on the screen.
//!
//! The first line says whether the albedo map holds the compared photograph. Then come what was fitted, the numbers, the
//! shadows, the variants of the physics; then pictures, one over the other in turns (the blink), and profiles.

use std::path::{Path, PathBuf};

use serde_json::{Value as Json, json};

use super::pose::PoseFit;
use super::resolution::SLOPE_SIGMA;
use super::study::{AlbedoSource, Comparison};
use super::{Error, Freedom, figures};
use crate::dataset;
use crate::report::page::{Figure, STYLE, base64, table_html};
use crate::report::plot::{Axis, Curve, Plot, escaped};
use crate::report::{Table, Value};

/// Turns of photograph and render, one over the other.
const BLINK_STYLE: &str = ".blink { position: relative; display: inline-block; } \
    .blink img + img { position: absolute; left: 0; top: 0; animation: blink 1.6s steps(1) infinite; } \
    @keyframes blink { 0% { opacity: 0; } 50% { opacity: 1; } }";

impl Comparison {
    /// Fairness first: what the render knew of the photograph.
    pub fn first_line(&self) -> String {
        match &self.albedo {
            AlbedoSource::Constant => "Albedo: the same everywhere; no image went into the render.".into(),
            AlbedoSource::Map(source) => format!("Albedo from {source}."),
            AlbedoSource::HoldsPhoto { map, reason } => format!(
                "NOT A FAIR COMPARISON (forced): the albedo map holds the compared photograph, for {reason}. {map}."
            ),
        }
    }

    /// What was fitted to the photograph.
    pub fn fitted_line(&self) -> String {
        let motion = match self.registration.freedom {
            Freedom::Nothing => "no motion of the image",
            Freedom::Shift => "a shift of the image",
            Freedom::Similarity => "shift, rotation and scale of the image",
        };
        let pose = if self.fitted_pose.is_some() { "turn and focal length of the camera; then " } else { "" };
        format!("Fitted to the photograph: {pose}{motion}; photometric response: {}. Nothing else.", self.model.name())
    }

    /// Whether the photograph agrees with the Sun; empty where it was not asked.
    fn sun_line(&self) -> Option<String> {
        let sun = self.sun.as_ref()?;
        let turn = |turn: Option<f64>| turn.map_or("nowhere near".to_owned(), |turn| format!("{turn:+.1} deg"));
        let [azimuth, elevation] = sun.best_turn_deg.map(turn);
        let verdict =
            if sun.agrees { "The photograph agrees with the Sun" } else { "THE PHOTOGRAPH WANTS ANOTHER SUN" };
        Some(format!(
            "{verdict}: it is most like a render with the Sun turned by {azimuth} in azimuth and {elevation} in elevation."
        ))
    }

    pub fn notes(&self) -> Vec<String> {
        let r = &self.resolution;
        let mut notes = vec![self.first_line(), self.fitted_line()];
        if !self.registration.settled {
            notes.push(
                "REGISTRATION FAILED: no motion brings photograph and render together; they are compared unmoved."
                    .into(),
            );
        }
        notes.extend(self.sun_line());
        notes.extend([
            format!("Geometry: {}. Elevation: {}.", self.geometry, self.dems.join(", ")),
            format!("Render: {} reflectance, by {}.", self.law, self.adapter),
            format!(
                "Photograph {} x {} of {:.0} m, elevation posted at {:.0} m; compared at {} x {} of {:.0} m, both \
                 smoothed by {:.0} m as the model's slopes are. High-pass: less a Gaussian of {:.1} px.",
                r.photo_px[0],
                r.photo_px[1],
                r.photo_pixel_m,
                r.posting_m,
                r.compared_px[0],
                r.compared_px[1],
                r.compared_pixel_m,
                SLOPE_SIGMA * r.posting_m,
                r.high_pass_px
            ),
        ]);
        notes
    }

    pub fn tables(&self) -> Vec<Table> {
        let mut tables = vec![self.registration_table()];
        tables.extend(self.pose_tables());
        tables.push(self.numbers_table());
        tables.push(self.scales_table());
        tables.extend(self.shadow_tables());
        if !self.ablation.is_empty() {
            tables.push(self.ablation_table());
        }
        for (name, title, bins) in [
            ("incidence", "Residual against local incidence", &self.by_incidence),
            ("slope", "Residual against slope", &self.by_slope),
        ] {
            let columns = [("from", "deg"), ("until", "deg"), ("pixels", ""), ("mean", "DN"), ("sigma", "DN")];
            let mut table = Table::new(name, title, &columns);
            for bin in bins {
                let row = [bin.from_deg, bin.until_deg, bin.pixels as f64, bin.mean, bin.sigma];
                table.rows.push(row.map(Value::from).to_vec());
            }
            tables.push(table);
        }
        tables
    }

    /// The motion, in pixels and on the ground.
    fn registration_table(&self) -> Table {
        let columns = [("motion", ""), ("fitted", ""), ("sigma", ""), ("unit", "")];
        let mut table = Table::new("registration", "Where the photograph's pixels lie on the render", &columns);
        let (found, sigma) = (self.registration.motion, self.registration.sigma);
        let pixel_m = self.resolution.compared_pixel_m;
        for (name, value, error, unit) in [
            ("shift along columns", found.shift_px[0], sigma.shift_px[0], "px"),
            ("shift along rows", found.shift_px[1], sigma.shift_px[1], "px"),
            ("rotation", found.rotation_rad.to_degrees(), sigma.rotation_rad.to_degrees(), "deg"),
            ("scale", 100.0 * found.scale, 100.0 * sigma.scale, "%"),
            ("shift along columns, on the ground", found.shift_px[0] * pixel_m, sigma.shift_px[0] * pixel_m, "m"),
            ("shift along rows, on the ground", found.shift_px[1] * pixel_m, sigma.shift_px[1] * pixel_m, "m"),
        ] {
            table.rows.push(vec![name.into(), value.into(), error.into(), unit.into()]);
        }
        table
    }

    /// The pose that was taken, and the one that explains what is left.
    fn pose_tables(&self) -> Vec<Table> {
        let of = |name, title, pose: &PoseFit| {
            let mut table = Table::new(name, title, &[("camera", ""), ("found", ""), ("sigma", ""), ("unit", "")]);
            let turn = |axis: usize| [pose.turn_rad[axis], pose.turn_sigma_rad[axis]].map(f64::to_degrees);
            let focal = [pose.focal, pose.focal_sigma];
            // Seen smaller by a shorter focal length or from farther away.
            let range = focal.map(|share| share * self.resolution.range_m);
            for (name, [value, sigma], unit) in [
                ("roll, about the boresight", turn(2), "deg"),
                ("pitch, about the image's right", turn(0), "deg"),
                ("yaw, about the image's down", turn(1), "deg"),
                ("focal length, longer by", focal.map(|share| 100.0 * share), "%"),
                ("or: nearer by", range, "m"),
            ] {
                table.rows.push(vec![name.into(), value.into(), sigma.into(), unit.into()]);
            }
            table.rows.push(vec!["left of the motion".into(), pose.left_px.into(), Value::Missing, "px".into()]);
            table
        };
        let taken = self.fitted_pose.as_ref().map(|pose| of("fitted_pose", "The pose that was fitted and taken", pose));
        let left = self.pose.as_ref().map(|pose| of("pose", "The pose that explains the motion", pose));
        taken.into_iter().chain(left).collect()
    }

    fn numbers_table(&self) -> Table {
        let mut table = Table::new(
            "responses",
            "Likeness under each photometric response",
            &[
                ("response", ""),
                ("correlation", ""),
                ("high-pass correlation", ""),
                ("normalised RMS", "%"),
                ("residual sigma", "DN"),
                ("within 3 sigma", "%"),
                ("SSIM", ""),
                ("FLIP", ""),
                ("Jung sigma", ""),
                ("Jung within 3 sigma", "%"),
            ],
        );
        for (model, _, n) in &self.responses {
            let mut row = vec![Value::from(model.name())];
            row.extend(
                [
                    n.correlation,
                    n.high_pass_correlation,
                    100.0 * n.normalised_rms,
                    n.residual_sigma,
                    100.0 * n.within_3_sigma,
                    n.ssim,
                    n.flip,
                    n.jung.sigma,
                    100.0 * n.jung.within_3_sigma,
                ]
                .map(Value::from),
            );
            table.rows.push(row);
        }
        table
    }

    fn scales_table(&self) -> Table {
        let columns =
            [("wavelength", "m"), ("pixels", "px"), ("correlation", ""), ("contrast, render over photograph", "")];
        let mut table = Table::new("scales", "Likeness size by size", &columns);
        for scale in &self.scales {
            let wavelength_m = scale.wavelength_px * self.resolution.compared_pixel_m;
            let row = [wavelength_m, scale.wavelength_px, scale.correlation, scale.contrast];
            table.rows.push(row.map(Value::from).to_vec());
        }
        table
    }

    fn shadow_tables(&self) -> Vec<Table> {
        let mut tables = Vec::new();
        if let Some(c) = &self.confusion {
            let columns = [("photograph", ""), ("render dark", "%"), ("render lit", "%")];
            let title = format!("Shadow and light; overlap of shadows {:.1} %", 100.0 * c.overlap);
            let mut table = Table::new("confusion", &title, &columns);
            let shares = |a: f64, b: f64| [100.0 * a, 100.0 * b].map(Value::from);
            for (name, [a, b]) in
                [("dark", shares(c.both_dark, c.only_photo_dark)), ("lit", shares(c.only_render_dark, c.both_lit))]
            {
                table.rows.push(vec![name.into(), a, b]);
            }
            tables.push(table);
        }
        if let Some(d) = &self.displacement {
            let columns = [("shadow edges, towards the Sun", ""), ("pixels", "px"), ("ground", "m")];
            let title = format!("Displacement of {} shadow edges; {:.1} % unmatched", d.edges, 100.0 * d.unmatched);
            let mut table = Table::new("edges", &title, &columns);
            for (name, px, m) in [
                ("median", d.median_px, d.median_m),
                ("spread (half of 16 % to 84 %)", d.spread_px, d.spread_m),
                ("95 % of sizes", d.p95_absolute_px, d.p95_absolute_m),
            ] {
                table.rows.push(vec![name.into(), px.into(), m.into()]);
            }
            tables.push(table);
        }
        tables
    }

    fn ablation_table(&self) -> Table {
        let mut table = Table::new(
            "ablation",
            "Which physics the photograph wants: one part changed a row. Excess: mean square residual over the first row's",
            &[
                ("variant", ""),
                ("correlation", ""),
                ("high-pass correlation", ""),
                ("normalised RMS", "%"),
                ("SSIM", ""),
                ("FLIP", ""),
                ("excess", "%"),
                ("error", "%"),
                ("high-pass excess", "%"),
                ("high-pass error", "%"),
            ],
        );
        for row in &self.ablation {
            let n = &row.numbers;
            let mut cells = vec![Value::from(row.name.as_str())];
            let (all, fine) = (row.excess, row.high_pass_excess);
            let shares = [n.normalised_rms, all.share, all.error, fine.share, fine.error].map(|share| 100.0 * share);
            let [rms, rest @ ..] = shares;
            cells.extend([n.correlation, n.high_pass_correlation, rms, n.ssim, n.flip].map(Value::from));
            cells.extend(rest.map(Value::from));
            table.rows.push(cells);
        }
        table
    }

    /// All numbers, for programs.
    pub fn json(&self) -> Json {
        json!({
            "photograph": self.photo_name,
            "notes": self.notes(),
            "fair": !matches!(self.albedo, AlbedoSource::HoldsPhoto { .. }),
            "law": self.law,
            "sun": self.sun,
            "resolution": {
                "photograph_px": self.resolution.photo_px,
                "photograph_pixel_m": self.resolution.photo_pixel_m,
                "posting_m": self.resolution.posting_m,
                "compared_px": self.resolution.compared_px,
                "compared_pixel_m": self.resolution.compared_pixel_m,
                "high_pass_px": self.resolution.high_pass_px,
            },
            "registration": self.registration,
            "pose": self.pose,
            "fitted_pose": self.fitted_pose,
            "response": self.response,
            "numbers": self.numbers,
            "scales": self.scales,
            "responses": self.responses.iter().map(|(model, response, numbers)| {
                json!({ "model": model, "response": response, "numbers": numbers })
            }).collect::<Vec<_>>(),
            "shadows": { "confusion": self.confusion, "edges": self.displacement },
            "ablation": self.ablation,
            "residuals": { "incidence": self.by_incidence, "slope": self.by_slope },
            "profiles": self.profiles,
        })
    }

    /// For the screen.
    pub fn text(&self) -> String {
        let notes = self.notes().join("\n");
        let tables = self.tables();
        let shown = tables.iter().filter(|table| !["incidence", "slope"].contains(&table.name));
        shown.fold(notes + "\n", |text, table| text + "\n" + &table.text())
    }

    fn plots(&self) -> Vec<Plot> {
        let mut plots: Vec<Plot> = self
            .profiles
            .iter()
            .enumerate()
            .map(|(i, profile)| {
                let curve = |name: &str, column: usize| Curve {
                    name: name.into(),
                    points: profile.points.iter().map(|point| [point[0], point[column]]).collect(),
                    joined: true,
                };
                let [x, y] = profile.from_px;
                Plot {
                    title: format!("Profile {} across a shadow, from column {x:.0}, row {y:.0} towards the Sun", i + 1),
                    x: Axis::linear("distance [px]"),
                    y: Axis::linear("brightness [DN]"),
                    curves: vec![curve("photograph", 1), curve("render", 2)],
                }
            })
            .collect();
        if let Some(displacement) = &self.displacement {
            plots.push(histogram(&displacement.displacements_px));
        }
        plots
    }

    fn html(&self, pictures: &[Figure]) -> String {
        let title = format!("{} held against its render", self.photo_name);
        let mut body = format!("<h1>{}</h1>\n", escaped(&title));
        self.notes().iter().for_each(|note| body += &format!("<p>{}</p>\n", escaped(note)));
        body += "<figure><div class='blink'>";
        pictures.iter().take(2).for_each(|picture| body += &img(picture));
        body += "</div><figcaption>Photograph and render in turns</figcaption></figure>\n";
        for picture in pictures {
            let caption = escaped(&picture.caption);
            body += &format!("<figure>{}<figcaption>{caption}</figcaption></figure>\n", img(picture));
        }
        self.tables().iter().for_each(|table| body += &table_html(table));
        self.plots().iter().for_each(|plot| body += &format!("<figure>\n{}</figure>\n", plot.svg()));
        format!(
            "<!doctype html>\n<html lang='en'><meta charset='utf-8'><title>{}</title>\n\
             <style>{STYLE} {BLINK_STYLE}</style>\n<body>\n{body}</body></html>\n",
            escaped(&title)
        )
    }

    /// Writes `compare.html`, `compare.json` and the pictures. Returns their paths.
    pub fn write(&self, directory: &Path) -> Result<Vec<PathBuf>, Error> {
        dataset::check_writable(directory)?;
        let pictures = figures::pictures(self)?;
        let json = serde_json::to_string_pretty(&self.json()).expect("text and numbers");
        let mut files =
            vec![("html".to_owned(), self.html(&pictures).into_bytes()), ("json".into(), json.into_bytes())];
        files.extend(pictures.into_iter().map(|picture| (format!("{}.png", picture.name), picture.png)));
        let mut paths = Vec::new();
        for (end, bytes) in files {
            let path = directory.join(format!("compare.{end}"));
            dataset::write_whole(&path, &bytes)?;
            paths.push(path);
        }
        Ok(paths)
    }
}

fn img(picture: &Figure) -> String {
    format!("<img alt='{}' src='data:image/png;base64,{}'>", escaped(&picture.caption), base64(&picture.png))
}

/// How many edges lie how far.
fn histogram(displacements_px: &[f64]) -> Plot {
    const STEP_PX: f64 = 0.5;
    let half = (super::edges::REACH_PX / STEP_PX) as i32;
    let count = |k: i32| displacements_px.iter().filter(|d| (**d / STEP_PX).round() as i32 == k).count();
    let points = (-half..=half).map(|k| [f64::from(k) * STEP_PX, count(k) as f64]).collect();
    Plot {
        title: "Shadow edges of the photograph, from the render's towards the Sun".into(),
        x: Axis::linear("displacement [px]"),
        y: Axis::linear("edges"),
        curves: vec![Curve { name: "edges".into(), points, joined: true }],
    }
}
