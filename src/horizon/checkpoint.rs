//! What an interrupted build needs to go on.
//!
//! The file holds the tile's key, the number of azimuths done, the sums and the sampled profiles, and a SHA-256 over all of
//! it. Whatever does not match is ignored: the build starts afresh.

use std::fs;
use std::path::PathBuf;

use bytemuck::{cast_slice, pod_read_unaligned};
use sha2::{Digest, Sha256};

use super::build::State;
use super::error::Error;
use super::store::Key;

/// The checkpoint file of one tile.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    key: Key,
}

impl Checkpoint {
    pub fn new(path: PathBuf, key: Key) -> Self {
        Self { path, key }
    }

    pub fn save(&self, state: &State) -> Result<(), Error> {
        let mut bytes = self.key.as_str().as_bytes().to_vec();
        bytes.extend((state.done as u64).to_le_bytes());
        state.sums.groups.iter().for_each(|group| bytes.extend_from_slice(cast_slice(&group.sums)));
        bytes.extend_from_slice(cast_slice(&state.sample.elevations_rad));
        let digest = Sha256::digest(&bytes);
        bytes.extend_from_slice(&digest);
        let writing = self.path.with_extension("partial.writing");
        let saved = fs::write(&writing, bytes).and_then(|()| fs::rename(&writing, &self.path));
        saved.map_err(|source| {
            // The first error is the one to report.
            let _ = fs::remove_file(&writing);
            Error::write(&self.path, source)
        })
    }

    /// Puts a state where a saved one left off; leaves it as it is where there is none that fits. The sums of a state
    /// past its first `along_rows` azimuths are transposed.
    pub fn resume(&self, state: &mut State, along_rows: usize) {
        let Ok(bytes) = fs::read(&self.path) else { return };
        let key = self.key.as_str().as_bytes();
        let floats =
            state.sums.groups.iter().map(|group| group.sums.len()).sum::<usize>() + state.sample.elevations_rad.len();
        if bytes.len() != key.len() + 8 + 4 * floats + 32 {
            return;
        }
        let (body, digest) = bytes.split_at(bytes.len() - 32);
        if Sha256::digest(body).as_slice() != digest || !body.starts_with(key) {
            return;
        }
        let (done, mut rest) = body[key.len()..].split_at(8);
        state.done = u64::from_le_bytes(done.try_into().expect("eight bytes")) as usize;
        if state.done > along_rows {
            state.sums.transpose();
        }
        let groups = state.sums.groups.iter_mut().map(|group| &mut group.sums);
        for floats in groups.chain([&mut state.sample.elevations_rad]) {
            let (mine, others) = rest.split_at(4 * floats.len());
            floats.iter_mut().zip(mine.chunks_exact(4)).for_each(|(float, bytes)| *float = pod_read_unaligned(bytes));
            rest = others;
        }
    }

    /// Nothing is lost if it stays.
    pub fn remove(&self) {
        let _ = fs::remove_file(&self.path);
    }
}
