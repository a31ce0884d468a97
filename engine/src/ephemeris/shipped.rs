//! The kernels that the program carries, and where a kernel's bytes come from.

use std::path::{Path, PathBuf};

/// Names of the default kernels: positions, constants, and the orientation of the Moon of DE440 with its frames.
pub const DEFAULT_KERNELS: [&str; 4] =
    ["perilune_2020_2040.bsp", "perilune_iau.tpc", "moon_pa_de440_2000_2030.bpc", "moon_de440_220930.tf"];

/// A kernel inside the program.
#[derive(Debug, PartialEq, Eq)]
pub struct ShippedKernel {
    /// Its name as a file.
    pub name: &'static str,
    pub bytes: &'static [u8],
}

pub(super) static SHIPPED: [ShippedKernel; 4] = [
    ShippedKernel { name: DEFAULT_KERNELS[0], bytes: include_bytes!("../../../kernels/perilune_2020_2040.bsp") },
    ShippedKernel { name: DEFAULT_KERNELS[1], bytes: include_bytes!("../../../kernels/perilune_iau.tpc") },
    ShippedKernel { name: DEFAULT_KERNELS[2], bytes: include_bytes!("../../../kernels/moon_pa_de440_2000_2030.bpc") },
    ShippedKernel { name: DEFAULT_KERNELS[3], bytes: include_bytes!("../../../kernels/moon_de440_220930.tf") },
];

/// Where a kernel's bytes come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KernelSource {
    File(PathBuf),
    /// The program itself.
    Shipped(&'static ShippedKernel),
}

impl KernelSource {
    /// The shipped kernel of that name, where there is one.
    pub fn shipped(name: &str) -> Option<Self> {
        SHIPPED.iter().find(|kernel| kernel.name == name).map(Self::Shipped)
    }

    /// Where the kernel lies, for messages; of a shipped one its name alone.
    pub fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Shipped(kernel) => Path::new(kernel.name),
        }
    }
}

impl From<PathBuf> for KernelSource {
    fn from(path: PathBuf) -> Self {
        Self::File(path)
    }
}

/// The default kernels: from the folder `SIM_KERNELS`, else from `kernels` here where `sim kernels make` has written them,
/// else those that the program carries.
pub fn default_kernels() -> Vec<KernelSource> {
    let folder = std::env::var_os("SIM_KERNELS").map(PathBuf::from).or_else(|| {
        let here = PathBuf::from("kernels");
        here.join(DEFAULT_KERNELS[0]).is_file().then_some(here)
    });
    match folder {
        Some(folder) => DEFAULT_KERNELS.map(|name| KernelSource::File(folder.join(name))).to_vec(),
        None => SHIPPED.iter().map(KernelSource::Shipped).collect(),
    }
}
