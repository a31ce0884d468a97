//! Reads the planes of a FITS file as [`super::fits_file`] writes it: image extensions of 32-bit floats with names.
//!
//! # References
//! FITS Standard 4.0, chapters 3, 4 and 7.

const BLOCK_BYTES: usize = 2880;
const CARD_BYTES: usize = 80;

/// Columns, rows, and values by name.
pub type Planes = ([usize; 2], Vec<(String, Vec<f32>)>);

/// `None`: it is no such file.
pub fn read(bytes: &[u8]) -> Option<Planes> {
    let (mut at, mut size, mut channels) = (0, [0, 0], Vec::new());
    while at < bytes.len() {
        let header = Header::read(bytes.get(at..)?)?;
        at += header.bytes;
        let sides: Vec<usize> =
            (1..=header.number("NAXIS")?).map(|axis| header.number(&format!("NAXIS{axis}"))).collect::<Option<_>>()?;
        if let [columns, rows] = sides[..] {
            let length = columns.checked_mul(rows)?.checked_mul(4)?;
            let values = bytes.get(at..at.checked_add(length)?)?.chunks_exact(4);
            let values = values.map(|value| f32::from_be_bytes([value[0], value[1], value[2], value[3]])).collect();
            (header.text("BITPIX")? == "-32").then_some(())?;
            size = [columns, rows];
            channels.push((header.text("EXTNAME")?, values));
            at = (at + length).next_multiple_of(BLOCK_BYTES);
        }
    }
    Some((size, channels))
}

/// The cards of a header, and its length.
struct Header<'a> {
    cards: Vec<&'a str>,
    bytes: usize,
}

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8]) -> Option<Self> {
        let mut cards = Vec::new();
        for card in bytes.chunks_exact(CARD_BYTES) {
            let card = std::str::from_utf8(card).ok()?;
            if card.trim_end() == "END" {
                let bytes = ((cards.len() + 1) * CARD_BYTES).next_multiple_of(BLOCK_BYTES);
                return Some(Self { cards, bytes });
            }
            cards.push(card);
        }
        None
    }

    /// A value without quotes and comment.
    fn text(&self, key: &str) -> Option<String> {
        let card = self.cards.iter().find(|card| card.get(..8).is_some_and(|name| name.trim_end() == key))?;
        let value = card.get(10..)?.trim_start();
        let value = match value.strip_prefix('\'') {
            Some(quoted) => quoted.split_once('\'')?.0,
            None => value.split('/').next()?,
        };
        Some(value.trim_end().to_owned())
    }

    fn number(&self, key: &str) -> Option<usize> {
        self.text(key)?.parse().ok()
    }
}
