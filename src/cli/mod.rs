//! The program's subcommands, one file each: arguments in, text and exit code out.

use std::error::Error;
use std::io::Write as _;

use perilune_engine::dataset::DatasetError;
use perilune_engine::geometry::Geodetic;
use perilune_engine::gpu::GpuError;
use perilune_engine::pipeline;
use perilune_engine::render::RenderError;
use perilune_engine::shadow::DeviceError;

pub mod bars;
pub mod bench;
pub mod cache;
pub mod check;
mod common;
pub mod compare;
pub mod failure;
pub mod horizon;
pub mod illuminate;
pub mod inspect;
pub mod interrupt;
pub mod kernels;
pub mod limits;
mod ranges;
pub mod run;
pub mod scenarios;
pub mod schema;
pub mod sun;
pub mod terrain;

/// What a subcommand returns: any error, printed by `main` as one line.
pub type Outcome = Result<(), Box<dyn Error>>;

/// Several problems at once, a line each.
#[derive(Debug)]
pub struct Problems(pub Vec<String>);

impl std::fmt::Display for Problems {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(&self.0.join("\n"))
    }
}

impl Error for Problems {}

/// Prints a line. `println!` would panic when the reader goes away, as in `sim sun … | head`; `main` ends quietly.
pub fn print_line(line: impl std::fmt::Display) -> std::io::Result<()> {
    writeln!(std::io::stdout(), "{line}")
}

/// An argument `LAT,LON` in degrees.
pub fn place(text: &str) -> Result<Geodetic, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[latitude_deg, longitude_deg]) if latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 360.0 => {
            Ok(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0))
        }
        _ => Err("want a latitude in [-90, 90] and a longitude in [-360, 360], as in -89.5,120".into()),
    }
}

/// What a file is and where it can be had, for the error that misses it.
pub fn about(name: &str) -> Option<String> {
    let file = perilune_engine::ephemeris::known_file(name)?;
    let checksum = file.sha256.as_ref().map_or(String::new(), |sha256| format!(", SHA-256 {sha256}"));
    Some(format!("{}, from {}{checksum}", file.what, file.source))
}

/// An error and its causes on one line; what an error quotes of its cause is not said again.
pub fn chain(error: &dyn Error) -> String {
    let causes = std::iter::successors(error.source(), |cause: &&dyn Error| (*cause).source());
    causes.fold(one_line(error), |line, cause| match one_line(cause) {
        cause if line.contains(&cause) => line,
        cause => format!("{line}: {cause}"),
    })
}

/// Other libraries break their messages.
fn one_line(error: &dyn Error) -> String {
    error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ")
}

/// An error of the pipeline, and the flag that has to do with it.
#[derive(Debug)]
pub struct Flagged {
    pub error: pipeline::Error,
    flag: &'static str,
}

impl std::fmt::Display for Flagged {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} (see {})", chain(&self.error), self.flag)
    }
}

impl Error for Flagged {}

/// An error of the pipeline, with the flag that has to do with it.
pub fn with_flag(error: pipeline::Error) -> Box<dyn Error> {
    let flag = match &error {
        pipeline::Error::NoSuchExposures { .. } => "--frames",
        pipeline::Error::NoTiles { .. } => "--tiles",
        pipeline::Error::Dataset(DatasetError::OtherRun { .. } | DatasetError::ForeignFiles { .. }) => {
            "-o and --overwrite"
        }
        pipeline::Error::Gpu(GpuError::TooLarge { .. })
        | pipeline::Error::Render(
            RenderError::Gpu(GpuError::TooLarge { .. } | GpuError::CutShort { .. })
            | RenderError::Device(DeviceError::HostOnly(_) | DeviceError::Gpu(GpuError::TooLarge { .. })),
        ) => "--adapter cpu",
        _ => return Box::new(error),
    };
    Box::new(Flagged { error, flag })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone)]
    struct Said(&'static str, Option<Box<Said>>);

    impl std::fmt::Display for Said {
        fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str(self.0)
        }
    }

    impl Error for Said {
        fn source(&self) -> Option<&(dyn Error + 'static)> {
            self.1.as_ref().map(|cause| cause.as_ref() as _)
        }
    }

    #[test]
    fn no_cause_is_said_twice() {
        let full = || Box::new(Said("no space left", None));
        assert_eq!(chain(&Said("cannot write a", Some(full()))), "cannot write a: no space left");
        assert_eq!(chain(&Said("cannot write a: no space left", Some(full()))), "cannot write a: no space left");
        let middle = Box::new(Said("cannot write a", Some(full())));
        assert_eq!(chain(&Said("run", Some(middle.clone()))), "run: cannot write a: no space left");
        assert_eq!(chain(&Said("run: cannot write a", Some(middle))), "run: cannot write a: no space left");
    }

    #[test]
    fn an_error_is_one_line() {
        assert_eq!(chain(&Said("a\n  b", None)), "a b");
    }
}
