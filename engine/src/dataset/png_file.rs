//! PNG files with a line of text in their header.

use std::io::Cursor;
use std::path::Path;

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use super::error::DatasetError;

/// PNG's signature and the IHDR chunk: 8 + 4 + 4 + 13 + 4 bytes. What says how samples are meant follows, and text.
const HEADER_BYTES: usize = 33;

/// How samples become light.
#[derive(Debug, Clone, Copy)]
enum Transfer {
    /// IEC 61966-2-1.
    Srgb,
    Linear,
}

/// 16 bits a pixel, row by row, linear in light.
pub fn encode_16(path: &Path, size: [usize; 2], dn: &[u16], comment: &str) -> Result<Vec<u8>, DatasetError> {
    // `image` takes samples in the machine's byte order.
    encode(path, size, bytemuck::cast_slice(dn), ExtendedColorType::L16, Transfer::Linear, comment)
}

/// 8 bits of sRGB a pixel, row by row.
pub fn encode_8(path: &Path, size: [usize; 2], dn: &[u8], comment: &str) -> Result<Vec<u8>, DatasetError> {
    encode(path, size, dn, ExtendedColorType::L8, Transfer::Srgb, comment)
}

/// 8 bits of sRGB's red, green and blue a pixel, row by row.
pub fn encode_rgb_8(path: &Path, size: [usize; 2], rgb: &[u8], comment: &str) -> Result<Vec<u8>, DatasetError> {
    encode(path, size, rgb, ExtendedColorType::Rgb8, Transfer::Srgb, comment)
}

fn encode(
    path: &Path,
    [columns, rows]: [usize; 2],
    bytes: &[u8],
    color: ExtendedColorType,
    transfer: Transfer,
    comment: &str,
) -> Result<Vec<u8>, DatasetError> {
    let mut file = Cursor::new(Vec::new());
    PngEncoder::new(&mut file)
        .write_image(bytes, columns as u32, rows as u32, color)
        .map_err(|source| DatasetError::EncodeImage { path: path.to_path_buf(), source })?;
    let mut file = file.into_inner();
    let chunks = [transfer.chunks(), text_chunk("Comment", comment)].concat();
    file.splice(HEADER_BYTES..HEADER_BYTES, chunks);
    Ok(file)
}

impl Transfer {
    /// `sRGB` with perceptual intent, and for readers that do not know it `gAMA` of 1/2.2, or 1 (PNG specification, third
    /// edition, 11.3.2).
    fn chunks(self) -> Vec<u8> {
        let gamma = |gamma_100_000: u32| chunk(b"gAMA", &gamma_100_000.to_be_bytes());
        match self {
            Self::Srgb => [chunk(b"sRGB", &[0]), gamma(45_455)].concat(),
            Self::Linear => gamma(100_000),
        }
    }
}

/// Length, type, data, CRC.
fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [kind, data].concat();
    [&(data.len() as u32).to_be_bytes(), body.as_slice(), &crc_32(&body).to_be_bytes()].concat()
}

/// A tEXt chunk: keyword, 0, text (PNG specification, third edition, 11.3.3.2).
fn text_chunk(keyword: &str, text: &str) -> Vec<u8> {
    // tEXt is Latin-1; what is not ASCII has no place in it.
    let text = text.bytes().map(|byte| if byte.is_ascii() { byte } else { b'?' });
    let data: Vec<u8> = keyword.bytes().chain([0]).chain(text).collect();
    chunk(b"tEXt", &data)
}

/// The comment of a PNG file, if it has one.
pub fn comment(bytes: &[u8]) -> Option<String> {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes(length.try_into().ok()?) as usize;
        let chunk = bytes.get(at + 4..at + 8 + length)?;
        if let Some(text) = chunk.strip_prefix(b"tEXtComment\0") {
            return Some(String::from_utf8_lossy(text).into_owned());
        }
        at += 12 + length;
    }
    None
}

/// CRC-32 of ISO 3309, bit by bit: chunks of text are short.
fn crc_32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms.
    #[test]
    fn the_checksum_of_123456789_is_cbf43926() {
        assert_eq!(crc_32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn pixels_and_comment_come_back() {
        let dn: Vec<u16> = (0..12).map(|pixel| pixel * 5000).collect();
        let file = encode_16(Path::new("a"), [4, 3], &dn, "white = 1 W m-2").unwrap();
        assert_eq!(comment(&file).as_deref(), Some("white = 1 W m-2"));
        let back = image::load_from_memory(&file).unwrap().into_luma16();
        assert_eq!((back.width(), back.height()), (4, 3));
        assert_eq!(back.into_raw(), dn);
    }

    /// PNG specification, third edition: `sRGB` of one byte, `gAMA` in 1/100000.
    #[test]
    fn files_say_how_their_samples_are_meant() {
        let has = |file: &[u8], bytes: &[u8]| file.windows(bytes.len()).any(|window| window == bytes);
        let eyes = encode_8(Path::new("a"), [2, 1], &[1, 2], "").unwrap();
        assert!(has(&eyes, b"\0\0\0\x01sRGB\0") && has(&eyes, b"\0\0\0\x04gAMA\0\0\xb1\x8f"));
        let linear = encode_16(Path::new("a"), [2, 1], &[1, 2], "").unwrap();
        assert!(!has(&linear, b"sRGB") && has(&linear, b"\0\0\0\x04gAMA\0\x01\x86\xa0"));
    }
}
