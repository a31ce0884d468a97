//! Where sums are kept while azimuths are added: in memory, or in the build's checkpoint.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

use bytemuck::cast_slice_mut;

/// The sums of one group.
#[derive(Debug, Clone)]
pub enum Sums {
    Memory(Vec<f32>),
    /// Zeros as long as there is no file.
    Disk {
        length: usize,
        file: Option<Stored>,
    },
}

/// Sums within a file, in the machine's byte order: a checkpoint stays on its machine.
#[derive(Debug, Clone)]
pub struct Stored {
    pub file: Arc<Mutex<File>>,
    /// Where the first sum lies, in bytes.
    pub start: u64,
}

impl Sums {
    pub fn length(&self) -> usize {
        match self {
            Self::Memory(sums) => sums.len(),
            Self::Disk { length, .. } => *length,
        }
    }

    /// Reads sums in turn, from index `first` on.
    pub fn read(&self, first: usize, sums: &mut [f32]) -> io::Result<()> {
        match self {
            Self::Memory(all) => sums.copy_from_slice(&all[first..first + sums.len()]),
            Self::Disk { file: None, .. } => sums.fill(0.0),
            Self::Disk { file: Some(Stored { file, start }), .. } => {
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                file.seek(SeekFrom::Start(start + 4 * first as u64))?;
                file.read_exact(cast_slice_mut(sums))?;
            }
        }
        Ok(())
    }

    /// Sums in turn from index `first` on, borrowed where they are in memory.
    pub fn at(&self, first: usize, length: usize) -> Cow<'_, [f32]> {
        match self {
            Self::Memory(all) => Cow::Borrowed(&all[first..first + length]),
            Self::Disk { .. } => {
                let mut sums = vec![0.0; length];
                self.read(first, &mut sums).expect("an open file of this process holds what was written to it");
                Cow::Owned(sums)
            }
        }
    }
}
