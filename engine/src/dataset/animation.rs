//! The previews in order, as a GIF of 256 greys.

use std::path::Path;
use std::time::Duration;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, GrayImage, ImageError};

use super::error::DatasetError;
use super::preview::Thumbnail;

const FRAME_TIME: Duration = Duration::from_millis(150);

/// The bytes of an animation that repeats for ever.
pub fn encode(path: &Path, thumbnails: &[(usize, Thumbnail)]) -> Result<Vec<u8>, DatasetError> {
    frames(thumbnails).map_err(|source| DatasetError::EncodeImage { path: path.to_path_buf(), source })
}

fn frames(thumbnails: &[(usize, Thumbnail)]) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new(&mut bytes);
    encoder.set_repeat(Repeat::Infinite)?;
    for (_, thumbnail) in thumbnails {
        let (columns, rows) = (thumbnail.columns as u32, thumbnail.rows as u32);
        let grey = GrayImage::from_raw(columns, rows, thumbnail.grey.clone()).expect("a thumbnail fills its rows");
        let rgba = image::DynamicImage::from(grey).into_rgba8();
        encoder.encode_frame(Frame::from_parts(rgba, 0, 0, Delay::from_saturating_duration(FRAME_TIME)))?;
    }
    drop(encoder);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::AnimationDecoder;

    #[test]
    fn every_grey_of_every_frame_comes_back() {
        let ramp =
            |offset: u8| Thumbnail { columns: 16, rows: 16, grey: (0..=255_u8).map(|grey| grey ^ offset).collect() };
        let thumbnails = [(0, ramp(0)), (1, ramp(85))];
        let bytes = encode(Path::new("a"), &thumbnails).unwrap();
        let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(bytes)).unwrap();
        let frames = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 2);
        for (frame, (_, thumbnail)) in frames.iter().zip(&thumbnails) {
            let greys: Vec<u8> = frame.buffer().pixels().map(|pixel| pixel.0[0]).collect();
            assert_eq!(greys, thumbnail.grey);
        }
    }
}
