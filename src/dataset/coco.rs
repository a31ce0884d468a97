//! Craters of all images as one COCO file, and as the table of NASA's crater detection challenge.
//!
//! Boxes and masks are COCO's: counted from the outer corner of the image's first pixel, clipped to the image, the mask run
//! lengths down the columns. A mask holds the pixels whose centres lie in the ellipse, seen or hidden; an ellipse that holds none
//! inside the image has no annotation. `ellipse` is `[cx, cy, a, b, theta]` in pixels and radians, from right towards down, and
//! `conic` a matrix, both for the centre of the first pixel at (0, 0), as in the landmarks' files; so is the table.
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
    let size = [file.columns, file.rows];
    let (counts, area) = mask(landmark, size);
    let [low, high] = landmark
        .ellipse
        .bounds_px()
        .map(|corner| (corner + 0.5).clamp(DVec2::ZERO, DVec2::new(file.columns as f64, file.rows as f64)));
    let ellipse = landmark.ellipse;
    let ([cx, cy], [a, b]) = (ellipse.centre_px, ellipse.semi_axes_px);
    (area > 0).then(|| {
        json!({
            "id": id,
            "image_id": image,
            "category_id": 1,
            "bbox": [low.x, low.y, high.x - low.x, high.y - low.y],
            "area": area,
            "iscrowd": 0,
            "segmentation": { "size": [file.rows, file.columns], "counts": counts },
            "ellipse": [cx, cy, a, b, ellipse.angle_rad],
            "conic": landmark.conic,
            "crater": landmark.id,
            "diameter_px": landmark.diameter_px,
            "diameter_m": landmark.diameters_m[0],
            "incidence_deg": landmark.incidence_deg,
            "occluded": landmark.occluded,
            "in_shadow": landmark.in_shadow,
            "truncated": landmark.truncated,
        })
    })
}

/// Runs of pixels outside and inside in turn, down the columns, and how many are inside.
fn mask(landmark: &Landmark, [columns, rows]: [usize; 2]) -> (Vec<usize>, usize) {
    let [low, high] = landmark.ellipse.bounds_px();
    let range = |low: f64, high: f64, count: usize| {
        let end = |at: f64| at.clamp(0.0, count as f64) as usize;
        end(low.ceil())..end((high + 1.0).floor())
    };
    let (mut counts, mut area, mut done) = (Vec::new(), 0, 0);
    for column in range(low.x, high.x, columns) {
        let inside = |row: &usize| landmark.conic.value(DVec2::new(column as f64, *row as f64)) <= 0.0;
        // An ellipse is convex: a column of it is one run.
        let mut run = range(low.y, high.y, rows).filter(inside);
        let Some(first) = run.next() else { continue };
        let length = 1 + run.count();
        let start = column * rows + first;
        match counts.last_mut() {
            // Reaches the bottom of a column and goes on at the top of the next.
            Some(last) if start == done => *last += length,
            _ => counts.extend([start - done, length]),
        }
        area += length;
        done = start + length;
    }
    counts.push(columns * rows - done);
    (counts, area)
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
