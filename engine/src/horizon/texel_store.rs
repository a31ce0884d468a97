//! A map whose texels lie in memory, or in a file from which some rows are fetched at a time.
//!
//! A few rows of a map are a map themselves: cut on a multiple of the coarsest texel and one such texel wider to each side, it
//! decodes to the same bytes in between.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufWriter, Read as _, Seek as _, SeekFrom, Write as _};
use std::ops::Range;
use std::path::Path;

use bytemuck::{cast_slice, cast_slice_mut};

use super::bound::Bounds;
use super::error::Error;
use super::pack::{HorizonMap, Texels};
use crate::files::NewFile;

/// Pixels of the coarsest texel's side.
const COARSEST: usize = 8;
/// Rows that are fetched at once.
const STRIP: usize = 64;

/// Where a map's texels are.
#[derive(Debug)]
pub enum TexelStore {
    Memory(HorizonMap),
    /// A map without texels, and the file that has them, level by level.
    Disk {
        map: HorizonMap,
        /// Never committed: it goes with the store, or after a kill as all temporary files go.
        file: NewFile,
    },
}

/// A strip of rows of a map.
#[derive(Debug)]
pub struct Strip<'a> {
    /// Rows that are right.
    pub rows: Range<usize>,
    pub map: Cow<'a, HorizonMap>,
    /// The map's row that is row 0 here.
    pub first: usize,
}

impl TexelStore {
    /// Puts a map's texels into a temporary file beside `path`.
    pub fn on_disk(mut map: HorizonMap, path: &Path) -> Result<Self, Error> {
        let written = || -> io::Result<NewFile> {
            let mut file = BufWriter::new(NewFile::create(path)?);
            for level in &map.levels {
                file.write_all(cast_slice(&level.words))?;
            }
            file.into_inner().map_err(io::IntoInnerError::into_error)
        };
        let file = written().map_err(|source| Error::write(path, source))?;
        map.levels.iter_mut().for_each(|level| level.words = Vec::new());
        Ok(Self::Disk { map, file })
    }

    /// The map, in memory or without its texels.
    pub fn map(&self) -> &HorizonMap {
        match self {
            Self::Memory(map) | Self::Disk { map, .. } => map,
        }
    }

    /// Strips that cover the map.
    pub fn strips(&self) -> impl Iterator<Item = Result<Strip<'_>, Error>> {
        let rows = self.map().rows;
        let step = if matches!(self, Self::Memory(_)) { rows } else { STRIP };
        (0..rows).step_by(step).map(move |first| self.strip(first..(first + step).min(rows)))
    }

    fn strip(&self, rows: Range<usize>) -> Result<Strip<'_>, Error> {
        match self {
            Self::Memory(map) => Ok(Strip { rows, map: Cow::Borrowed(map), first: 0 }),
            Self::Disk { map, file } => {
                let path = file.temporary();
                let wide = rows.start.saturating_sub(COARSEST)..(rows.end + COARSEST).min(map.rows);
                let cut = part(map, path, &wide).map_err(|source| Error::read(path, source))?;
                Ok(Strip { rows, first: wide.start, map: Cow::Owned(cut) })
            }
        }
    }

    /// The map with its texels; its file is gone.
    pub fn take(self) -> Result<HorizonMap, Error> {
        match self {
            Self::Memory(map) => Ok(map),
            Self::Disk { map, file } => {
                let path = file.temporary();
                let whole = part(&map, path, &(0..map.rows)).map_err(|source| Error::read(path, source))?;
                Ok(HorizonMap { levels: whole.levels, ..map })
            }
        }
    }
}

/// A map of some rows, the first a multiple of the coarsest texel.
fn part(map: &HorizonMap, path: &Path, rows: &Range<usize>) -> io::Result<HorizonMap> {
    let mut file = File::open(path)?;
    let mut start = 0;
    let mut levels = Vec::new();
    for (level, page) in map.levels.iter().zip(map.encoding.pages()) {
        let row = level.columns * level.words_per_texel;
        let mut cut = Texels::empty(map.columns, rows.len(), page);
        file.seek(SeekFrom::Start(4 * (start + rows.start / page.scale * row) as u64))?;
        file.read_exact(cast_slice_mut(&mut cut.words))?;
        levels.push(cut);
        start += row * level.rows;
    }
    let (columns, rows) = (map.columns, rows.len());
    let (encoding, fields, errors) = (map.encoding, map.fields.clone(), map.errors);
    Ok(HorizonMap { encoding, columns, rows, levels, fields, errors, bounds: Bounds::unknown(columns, 0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::decode::Decoder;
    use crate::horizon::pack::Encoding;
    use crate::horizon::pack::tests::noise;
    use glam::DVec2;

    #[test]
    fn strips_decode_to_the_rows_of_the_whole_map() {
        let folder = tempfile::tempdir().unwrap();
        let directions = [DVec2::Y, DVec2::from_angle(0.4)];
        for encoding in [Encoding::Fm16, Encoding::F8, Encoding::Raw12, Encoding::W21] {
            let map = noise(encoding, 21, 3 * STRIP + 5);
            let store = TexelStore::on_disk(map.clone(), &folder.path().join("texels")).unwrap();
            let whole = Decoder::new(&map, &directions);
            let mut next = 0;
            for strip in store.strips().map(Result::unwrap) {
                let decoder = Decoder::new(&strip.map, &directions);
                assert_eq!(strip.rows.start, next);
                next = strip.rows.end;
                assert!(strip.rows.clone().all(|row| decoder.row(row - strip.first) == whole.row(row)), "{encoding}");
            }
            assert_eq!(next, map.rows);
            assert!(store.take().unwrap() == map);
        }
    }
}
