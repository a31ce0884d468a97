//! The pictures of a report, as PNG.

use image::{Rgb, RgbImage};

use super::numbers::{range, shown};
use super::study::Comparison;
use super::{Error, ScalarImage};
use crate::report;
use crate::report::Figure;

/// Grey of a pixel without a value.
const MISSING: u8 = 96;

/// Photograph and render on one scale, their difference, and shadow against shadow.
pub fn pictures(comparison: &Comparison) -> Result<Vec<Figure>, Error> {
    let Comparison { photo, fitted, sun_fraction, confusion, .. } = comparison;
    let scale = range(photo);
    let mut pictures = vec![
        picture("photograph", "The photograph", grey(&shown(photo, scale)))?,
        picture("render", "The render, registered and fitted, on the photograph's scale", grey(&shown(fitted, scale)))?,
    ];
    let width = scale[1] - scale[0];
    let difference = photo.zip(fitted, |photo, fitted| (photo - fitted) / width);
    let caption = "Photograph less render: red brighter, blue darker; full colour at half the photograph's range";
    pictures.push(picture("difference", caption, coloured(&difference))?);
    if let Some(confusion) = confusion {
        let caption = "Shadows: black in both, red only in the render, blue only in the photograph";
        pictures.push(picture("shadows", caption, shadows(photo, fitted, sun_fraction, confusion.threshold))?);
    }
    Ok(pictures)
}

fn picture(name: &str, caption: &str, image: RgbImage) -> Result<Figure, Error> {
    let mut png = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut png, image::ImageFormat::Png)
        .map_err(|source| report::Error::Png { name: name.into(), source })?;
    Ok(Figure { name: name.into(), caption: caption.into(), png: png.into_inner() })
}

fn image_of(image: &ScalarImage, colour: impl Fn(usize) -> [u8; 3]) -> RgbImage {
    let (columns, rows) = (image.columns as u32, image.rows as u32);
    RgbImage::from_fn(columns, rows, |column, row| Rgb(colour((row * columns + column) as usize)))
}

fn grey(image: &ScalarImage) -> RgbImage {
    image_of(image, |i| {
        let value = image.values[i];
        [if value.is_nan() { MISSING } else { (255.0 * value).round() as u8 }; 3]
    })
}

/// −½ blue, 0 white, ½ red.
fn coloured(difference: &ScalarImage) -> RgbImage {
    image_of(difference, |i| {
        let value = difference.values[i];
        let pale = (255.0 * (1.0 - (2.0 * value.abs()).min(1.0))).round() as u8;
        match value {
            value if value.is_nan() => [MISSING; 3],
            value if value > 0.0 => [255, pale, pale],
            _ => [pale, pale, 255],
        }
    })
}

fn shadows(photo: &ScalarImage, fitted: &ScalarImage, sun_fraction: &ScalarImage, threshold: f64) -> RgbImage {
    image_of(photo, |i| {
        let (photo, fraction) = (photo.values[i], sun_fraction.values[i]);
        if (photo + fraction + fitted.values[i]).is_nan() {
            return [MISSING; 3];
        }
        match (photo < threshold, fraction < 0.5) {
            (true, true) => [0, 0, 0],
            (false, true) => [220, 50, 32],
            (true, false) => [0, 90, 181],
            (false, false) => [235; 3],
        }
    })
}
