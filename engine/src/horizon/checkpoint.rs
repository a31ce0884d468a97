//! What an interrupted build needs to go on, and the sums of one that is short of memory.
//!
//! The file holds the tile's key, the number of azimuths done, the sampled profiles and the sums, and a SHA-256 over all of
//! it. Whatever does not match is ignored: the build starts afresh. A kill leaves a whole one ([`crate::files`]).
//!
//! A build whose sums do not fit into its memory adds planes by writing the file anew, a piece of the sums at a time. Numbers are
//! added in the same order either way: to the same bytes.

use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use bytemuck::{cast_slice, cast_slice_mut};
use sha2::{Digest, Sha256};

use super::axis::Major;
use super::elevation_plane::ElevationPlane;
use super::error::Error;
use super::fit::Accumulator;
use super::fit::sums::{Stored, Sums};
use super::key::Key;
use super::measure::Sample;
use crate::files::NewFile;

/// Numbers that are in memory at a time while the file is written anew.
const PIECE: usize = 1 << 18;

/// What a build has reached.
#[derive(Debug, Clone)]
pub struct State {
    /// Azimuths added, in the builder's order.
    pub done: usize,
    pub sums: Accumulator,
    pub sample: Sample,
}

/// The checkpoint file of one tile.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    key: Key,
}

/// Writes to a file and hashes what it writes.
struct Hashed {
    file: BufWriter<NewFile>,
    hash: Sha256,
}

impl Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.file.write_all(bytes)
    }
}

impl Checkpoint {
    pub fn new(path: PathBuf, key: Key) -> Self {
        Self { path, key }
    }

    /// Writes the state with planes added to its sums. Sums on disk are in the new file then; those in memory stay as they are
    /// and no planes may be given.
    pub fn save(&self, state: &mut State, planes: &[ElevationPlane], major: Major) -> Result<(), Error> {
        let saved = self.write(state, planes, major);
        saved.map(|file| self.refer(state, file)).map_err(|source| Error::write(&self.path, source))
    }

    /// The file written, which stays open where another process replaces it.
    fn write(&self, state: &State, planes: &[ElevationPlane], major: Major) -> io::Result<File> {
        let mut to = Hashed { file: BufWriter::new(NewFile::create(&self.path)?), hash: Sha256::new() };
        to.write(self.key.as_str().as_bytes())?;
        to.write(&(state.done as u64).to_le_bytes())?;
        to.write(cast_slice(&state.sample.elevations_rad))?;
        let planes = &state.sums.fitted(planes);
        let mut piece = Vec::new();
        for (index, group) in state.sums.groups.iter().enumerate() {
            let strip = group.strip();
            let step = (PIECE / strip).max(1) * strip;
            for first in (0..group.sums.length()).step_by(step) {
                piece.resize(step.min(group.sums.length() - first), 0.0);
                group.sums.read(first, &mut piece)?;
                state.sums.add_to(index, first / strip, &mut piece, planes, major);
                to.write(cast_slice(&piece))?;
            }
        }
        let Hashed { mut file, hash } = to;
        file.write_all(&hash.finalize())?;
        file.into_inner().map_err(io::IntoInnerError::into_error)?.commit()
    }

    /// Bytes before the sums.
    fn head(&self, state: &State) -> usize {
        self.key.as_str().len() + 8 + 4 * state.sample.elevations_rad.len()
    }

    /// Lets sums on disk be those of a file.
    fn refer(&self, state: &mut State, file: File) {
        let mut start = self.head(state) as u64;
        let opened = Arc::new(Mutex::new(file));
        for group in &mut state.sums.groups {
            let length = group.sums.length();
            if let Sums::Disk { file, .. } = &mut group.sums {
                *file = Some(Stored { file: Arc::clone(&opened), start });
            }
            start += 4 * length as u64;
        }
    }

    /// Puts a state where a saved one left off; leaves it as it is where there is none that fits.
    pub fn resume(&self, state: &mut State) {
        if self.is_whole(state).unwrap_or(false) {
            // What has just been read to its end can be read again; else the build starts afresh.
            let fresh = state.clone();
            if self.read(state).is_err() {
                *state = fresh;
            }
        }
    }

    fn read(&self, state: &mut State) -> io::Result<()> {
        let mut file = BufReader::new(File::open(&self.path)?);
        io::copy(&mut Read::by_ref(&mut file).take(self.key.as_str().len() as u64), &mut io::sink())?;
        let mut done = [0; 8];
        file.read_exact(&mut done)?;
        state.done = u64::from_le_bytes(done) as usize;
        file.read_exact(cast_slice_mut(&mut state.sample.elevations_rad))?;
        for group in &mut state.sums.groups {
            if let Sums::Memory(sums) = &mut group.sums {
                file.read_exact(cast_slice_mut(sums))?;
            }
        }
        self.refer(state, file.into_inner());
        Ok(())
    }

    /// Whether there is a file of this tile, of the right size and with the right digest.
    fn is_whole(&self, state: &State) -> io::Result<bool> {
        let mut file = BufReader::with_capacity(1 << 20, File::open(&self.path)?);
        let floats: usize = state.sums.groups.iter().map(|group| group.sums.length()).sum();
        let length = (self.head(state) + 4 * floats) as u64;
        let key = self.key.as_str().as_bytes();
        let mut found = vec![0; key.len()];
        file.read_exact(&mut found)?;
        if file.get_ref().metadata()?.len() != length + 32 || found != key {
            return Ok(false);
        }
        let mut hash = Sha256::new();
        hash.update(&found);
        io::copy(&mut Read::by_ref(&mut file).take(length - key.len() as u64), &mut hash)?;
        let mut digest = [0; 32];
        file.read_exact(&mut digest)?;
        Ok(hash.finalize().as_slice() == digest)
    }

    /// Nothing is lost if it stays.
    pub fn remove(&self) {
        let _ = fs::remove_file(&self.path);
    }
}
