//! Horizon tiles on disk.
//!
//! A tile is a TIFF that GDAL and Python open: [`super::pages`] of whole numbers and a JSON [`Header`] with all that a
//! decoder needs. The specification of the file, from which `tests/vectors/decode.py` was written, stands below.
//!
//! A tile is found by its [`Key`]: the SHA-256 of the heights, the map, the settings, the encoding and the format
//! version. A tile is whole or absent ([`crate::files`]).
//!
#![doc = include_str!("FORMAT.md")]

use std::fs::{self, File};
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use tiff::decoder::{Decoder, Limits};
use tiff::encoder::{Compression, DeflateLevel, Predictor, TiffEncoder};
use tiff::tags::Tag;

use super::error::Error;
use super::georeference;
use super::header::{FORMAT, Header};
use super::key::{FORMAT_VERSION, Key};
use super::pack::HorizonMap;
use super::pages::{self, GDAL_METADATA, Page};
use crate::files::{self, NewFile};

/// Where the tile of a key lies in a directory.
pub fn path_for(directory: &Path, key: &Key) -> PathBuf {
    directory.join(format!("horizon_{}.tif", &key.as_str()[..16]))
}

/// Writes a tile under its final name once it is whole.
pub fn write(path: &Path, header: &Header, map: &HorizonMap) -> Result<(), Error> {
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
    }
    let mut file = BufWriter::new(NewFile::create(path).map_err(|source| Error::write(path, source))?);
    encode(&mut file, header, map).map_err(|source| match source {
        tiff::TiffError::IoError(source) => Error::write(path, source),
        source => Error::Encode { path: path.into(), source },
    })?;
    let file = file.into_inner().map_err(|error| Error::write(path, error.into_error()))?;
    file.commit().map(|_| ()).map_err(|source| Error::write(path, source))
}

fn encode(file: &mut BufWriter<NewFile>, header: &Header, map: &HorizonMap) -> tiff::TiffResult<()> {
    // The last 2 % of a water-filled texel's codes would take as long as all else.
    let effort = if map.encoding.gain_bits() > 0 { DeflateLevel::Balanced } else { DeflateLevel::Best };
    let mut file = TiffEncoder::new(file)?.with_compression(Compression::Deflate(effort));
    let header = Header { pages: pages::pages(map).map(|page| page.header).collect(), ..header.clone() };
    let description = serde_json::to_string(&header).expect("a header is plain data");
    for (index, page) in pages::pages(map).enumerate() {
        // Fields are differences from coarser pages already.
        let is_residual = page.header.field.is_some();
        file = file.with_predictor(if is_residual { Predictor::None } else { Predictor::Horizontal });
        page.write(&mut file, |tags| {
            if index == 0 {
                tags.write_tag(Tag::ImageDescription, description.as_str())?;
            }
            // Where texels have gains there is no one scale.
            if let Some(metadata) = page.gdal_metadata().filter(|_| map.encoding.gain_bits() == 0) {
                tags.write_tag(Tag::Unknown(GDAL_METADATA), metadata.as_str())?;
            }
            // The pictures that people look at: the mean, or the first sample, and the bound.
            let is_shown = page.header.scale == 1 && (index == 0 || index + 1 == header.pages.len());
            match header.map.georeference(header.rows) {
                Some(map) if is_shown => georeference::write_tags(tags, &map),
                _ => Ok(()),
            }
        })?;
    }
    Ok(())
}

/// Bytes that a byte of deflate can stand for, at most (RFC 1951: a pair of codes of two bits for 258 bytes).
const DEFLATE_RATIO: usize = 1032;
/// Bytes of a page that a reader holds beside its values.
const WORKING_BYTES: usize = 1 << 20;

/// Reads a tile with its header.
///
/// What a file claims is held against its length before memory is taken for it: a page takes less than 2100 times the file's
/// bytes, and no map is made before all of its pages are read.
pub fn read(path: &Path) -> Result<(Header, HorizonMap), Error> {
    let file = File::open(path).map_err(|source| Error::read(path, source))?;
    let length = file.metadata().map_err(|source| Error::read(path, source))?.len();
    let texels_at_most = usize::try_from(length).unwrap_or(usize::MAX).saturating_mul(DEFLATE_RATIO);
    let decode = |source| Error::Decode { path: path.into(), source };
    let mut decoder = Decoder::new(BufReader::new(file)).map_err(decode)?;
    let description = decoder.get_tag_ascii_string(Tag::ImageDescription).map_err(decode)?;
    let header = parse(path, &description)?;
    header.check(texels_at_most).map_err(|reason| Error::header(path, reason))?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = (2 * header.columns * header.rows).max(limits.ifd_value_size);
    limits.intermediate_buffer_size = limits.decoding_buffer_size.saturating_add(WORKING_BYTES);
    decoder = decoder.with_limits(limits);
    let mut pages = Vec::new();
    for (index, page) in header.pages.iter().enumerate() {
        if index > 0 {
            decoder.next_image().map_err(decode)?;
        }
        let (got, expected) = (decoder.dimensions().map_err(decode)?, (page.columns as u32, page.rows as u32));
        if got != expected {
            return Err(Error::Page { path: path.into(), page: index, got, expected });
        }
        let values = pages::read_values(&mut decoder, page.columns).map_err(decode)?;
        let values = values.ok_or_else(|| Error::header(path, format!("page {index} does not hold whole numbers")))?;
        pages.push(Page { header: page.clone(), values });
    }
    let map = pages::map(&pages, header.encoding, header.columns, header.rows, header.errors);
    let map = map.ok_or_else(|| Error::header(path, format!("its pages are not those of {}", header.encoding)))?;
    Ok((header, map))
}

fn parse(path: &Path, description: &str) -> Result<Header, Error> {
    let json: serde_json::Value = serde_json::from_str(description).map_err(|error| Error::header(path, error))?;
    if json["format"] != FORMAT {
        return Err(Error::header(path, "no format name"));
    }
    let got = json["format_version"].as_u64().and_then(|version| u32::try_from(version).ok()).unwrap_or(0);
    if got != FORMAT_VERSION {
        return Err(Error::Version { path: path.into(), got, expected: FORMAT_VERSION });
    }
    let header: Header = serde_json::from_value(json).map_err(|error| Error::header(path, error))?;
    if header.growth != header.encoding.growth() {
        return Err(Error::header(path, format!("its growth is not that of {}", header.encoding)));
    }
    Ok(header)
}

/// Reads the tile of a key.
pub fn read_of(directory: &Path, key: &Key) -> Result<HorizonMap, Error> {
    let path = path_for(directory, key);
    let (header, map) = read(&path)?;
    if header.key != *key {
        return Err(Error::OtherKey { path, got: header.key.as_str().into(), expected: key.as_str().into() });
    }
    files::cache::touch(&path);
    Ok(map)
}
