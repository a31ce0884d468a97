//! Craters of all images as one COCO file, and as the table of NASA's crater detection challenge.
//!
//! A mask holds the image's pixels whose centres lie in the ellipse, seen or hidden, as run lengths down the columns; the box is
//! the mask's, counted from the outer corner of the first pixel, as COCO does. An ellipse that holds no pixel has no annotation.
//! `ellipse` is `[cx, cy, a, b, theta]` in pixels and radians, from right towards down, and `conic` a matrix, both for the centre
//! of the first pixel at (0, 0), as in the landmarks' files; so is the table.
//!
//! The challenge asks for the crispness of a rim, 0 (A) to 4 (C): fifths of the degradation `κt/R²` from 0 to 0.6, where all but
//! nothing of the crater is left; −1 where the list does not tell.
//!
//! # References
//! Lin et al. 2014, doi:10.1007/978-3-319-10602-1_48, and the format's page at cocodataset.org.

use glam::DVec2;
use serde_json::{Value as Json, json};

use super::landmarks::LandmarkFile;
use crate::labels::Landmark;

pub const FILE: &str = "annotations.coco.json";
pub const CSV_FILE: &str = "craters.csv";

const MOST_DEGRADED: f64 = 0.6;
const CLASSES: f64 = 5.0;

/// Exposure, name of the preview, landmarks.
type Labelled = (usize, String, LandmarkFile);

/// The COCO file.
pub fn annotations(title: &str, images: &[Labelled]) -> Json {
    let image = |(index, name, file): &Labelled| json!({ "id": index, "file_name": name, "width": file.columns, "height": file.rows, "frame_id": file.frame_id });
    let mut annotations = Vec::new();
    for (index, _, file) in images {
        for landmark in &file.landmarks {
            annotations.extend(annotation(annotations.len() + 1, *index, file, landmark));
        }
    }
    json!({
        "info": { "description": title, "conventions": "bbox and segmentation from the outer corner of the first pixel; \
                  ellipse [cx, cy, a, b, theta rad] and conic from its centre" },
        "categories": [{ "id": 1, "name": "crater", "supercategory": "landform" }],
        "images": images.iter().map(image).collect::<Vec<_>>(),
        "annotations": annotations,
    })
}

fn annotation(id: usize, image: usize, file: &LandmarkFile, landmark: &Landmark) -> Option<Json> {
    let Mask { counts, area, low, high } = Mask::of(landmark, [file.columns, file.rows])?;
    let ellipse = landmark.ellipse;
    let ([cx, cy], [a, b]) = (ellipse.centre_px, ellipse.semi_axes_px);
    Some(json!({
        "id": id,
        "image_id": image,
        "category_id": 1,
        "bbox": [low[0], low[1], high[0] + 1 - low[0], high[1] + 1 - low[1]],
        "area": area,
        "iscrowd": 0,
        "segmentation": { "size": [file.rows, file.columns], "counts": counts },
        "ellipse": [cx, cy, a, b, ellipse.angle_rad],
        "conic": landmark.conic,
        "crater": landmark.id,
        "diameter_px": landmark.diameter_px,
        "diameter_m": landmark.diameters_m[0],
        "degradation": landmark.degradation,
        "buried": landmark.buried,
        "incidence_deg": landmark.incidence_deg,
        "occluded": landmark.occluded,
        "in_shadow": landmark.in_shadow,
        "truncated": landmark.truncated,
    }))
}

/// The pixels whose centres an ellipse holds.
struct Mask {
    /// Runs outside and inside in turn, down the columns.
    counts: Vec<usize>,
    area: usize,
    /// First and last column and row.
    low: [usize; 2],
    high: [usize; 2],
}

impl Mask {
    /// `None` where there is no such pixel in the image.
    fn of(landmark: &Landmark, [columns, rows]: [usize; 2]) -> Option<Self> {
        let bounds = landmark.ellipse.bounds_px();
        let range = |axis: usize, count: usize| {
            let end = |at: f64| at.clamp(0.0, count as f64) as usize;
            end(bounds[0][axis].ceil())..end(bounds[1][axis].floor() + 1.0)
        };
        let mut mask = Self { counts: Vec::new(), area: 0, low: [columns, rows], high: [0, 0] };
        let mut done = 0;
        for column in range(0, columns) {
            let inside = |row: &usize| landmark.conic.value(DVec2::new(column as f64, *row as f64)) <= 0.0;
            // An ellipse is convex: a column of it is one run.
            let mut run = range(1, rows).filter(inside);
            let Some(first) = run.next() else { continue };
            let length = 1 + run.count();
            let start = column * rows + first;
            match mask.counts.last_mut() {
                // From the bottom of a column on to the top of the next.
                Some(last) if start == done => *last += length,
                _ => mask.counts.extend([start - done, length]),
            }
            mask.area += length;
            mask.low = [mask.low[0].min(column), mask.low[1].min(first)];
            mask.high = [column, mask.high[1].max(first + length - 1)];
            done = start + length;
        }
        mask.counts.push(columns * rows - done);
        (mask.area > 0).then_some(mask)
    }
}

/// A line a landmark, in the challenge's columns.
pub fn challenge_csv(images: &[Labelled]) -> String {
    let mut text =
        "ellipseCenterX(px),ellipseCenterY(px),ellipseSemimajor(px),ellipseSemiminor(px),ellipseRotation(deg),\
                    inputImage,crater_classification\n"
            .to_owned();
    for (_, name, file) in images {
        for Landmark { ellipse, degradation, .. } in &file.landmarks {
            let ([x, y], [a, b]) = (ellipse.centre_px, ellipse.semi_axes_px);
            let rotation_deg = ellipse.angle_rad.to_degrees();
            let class =
                degradation.map_or(-1.0, |worn| (CLASSES * worn / MOST_DEGRADED).floor().clamp(0.0, CLASSES - 1.0));
            let image = name.trim_end_matches(".png");
            text += &format!("{x:.3},{y:.3},{a:.3},{b:.3},{rotation_deg:.3},{image},{class}\n");
        }
    }
    text
}
