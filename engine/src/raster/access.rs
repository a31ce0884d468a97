//! Which names are opened, and by which of GDAL's drivers: local files only.
//!
//! A name is a file, a file within an archive (`/vsizip/a.zip/dem.tif`), or a part of a container
//! (`NETCDF:"dem.nc":z`). Names of databases and of places on the network are refused before GDAL sees them, and what a
//! local file refers to there (a VRT's sources, a WMS description) is not followed: a run reads what is named, at once
//! or not at all.

use std::path::{Path, PathBuf};
use std::sync::Once;

use gdal::{Dataset, DriverManager, Metadata};

use super::Error;

/// Blocks of files that GDAL may keep in memory, in MiB; by itself it takes a twentieth of the machine's.
const CACHE_MIB: &str = "64";

/// Settings of GDAL: its cache, the unit of heights in compound systems, and neither network nor code in files.
const SETTINGS: [(&str, &str); 6] = [
    ("GDAL_CACHEMAX", CACHE_MIB),
    ("GTIFF_REPORT_COMPD_CS", "YES"),
    ("GDAL_VRT_ENABLE_PYTHON", "NO"),
    ("GDAL_VRT_ENABLE_RAWRASTERBAND", "NO"),
    // A name that no address has: `/vsicurl/` and its kin read nothing.
    ("CPL_VSIL_CURL_ALLOWED_FILENAME", "none"),
    ("GDAL_HTTP_MAX_RETRY", "0"),
];

/// Drivers that read from databases and the network.
const REMOTE_DRIVERS: [&str; 14] = [
    "WMS",
    "WCS",
    "WMTS",
    "OGCAPI",
    "HTTP",
    "PLMOSAIC",
    "PLSCENES",
    "STACIT",
    "STACTA",
    "EEDAI",
    "DAAS",
    "NGW",
    "PostGISRaster",
    "GeoRaster",
];

/// Archives that GDAL looks into.
const ARCHIVES: [&str; 6] = ["/vsizip/", "/vsitar/", "/vsigzip/", "/vsi7z/", "/vsirar/", "/vsisparse/"];

/// Drivers whose parts have names of their own.
const CONTAINERS: [&str; 14] = [
    "NETCDF",
    "HDF5",
    "HDF5IMAGE",
    "HDF4",
    "HDF4_SDS",
    "HDF4_EOS",
    "GTIFF_DIR",
    "GTIFF_RAW",
    "GPKG",
    "NITF_IM",
    "PDS4",
    "ZARR",
    "BAG",
    "RASTERLITE",
];

/// GDAL's messages reach the user through our errors. By default it prints them to the terminal as well.
pub(super) fn keep_gdal_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        gdal::config::set_error_handler(|_, _, _| {});
        for (key, value) in SETTINGS {
            // Refused only for a name or a value with a NUL in it.
            let _ = gdal::config::set_config_option(key, value);
        }
        DriverManager::register_all();
        REMOTE_DRIVERS
            .iter()
            .filter_map(|name| DriverManager::get_driver_by_name(name).ok())
            .for_each(|driver| DriverManager::deregister_driver(&driver));
    });
}

/// A name of something within a local file.
#[derive(Debug, Clone, PartialEq)]
pub struct Within {
    /// As GDAL understands it.
    pub name: PathBuf,
    pub file: PathBuf,
}

impl Within {
    /// Takes a name apart; `find` says where a file lies. `None`: it is no such name, or its file is nowhere.
    pub fn find(name: &str, find: &dyn Fn(&str) -> Option<PathBuf>) -> Option<Self> {
        if let Some(archive) = ARCHIVES.iter().find(|archive| name.starts_with(**archive)) {
            let rest = &name[archive.len()..];
            let ends = rest.match_indices('/').map(|(at, _)| at).filter(|at| *at > 0).chain([rest.len()]);
            return ends.into_iter().find_map(|end| {
                let file = find(rest[..end].trim_matches(['{', '}']))?;
                Some(Self { name: format!("{archive}{}{}", file.display(), &rest[end..]).into(), file })
            });
        }
        let (driver, rest) = name.split_once(':')?;
        if !CONTAINERS.contains(&driver.to_ascii_uppercase().as_str()) {
            return None;
        }
        let parts = between_colons(rest);
        parts.iter().enumerate().find_map(|(at, part)| {
            let file = find(part.trim_matches('"'))?;
            let named =
                if part.starts_with('"') { format!("\"{}\"", file.display()) } else { file.display().to_string() };
            let whole = [&parts[..at], &[named.as_str()], &parts[at + 1..]].concat().join(":");
            Some(Self { name: format!("{driver}:{whole}").into(), file })
        })
    }
}

/// Parts between colons that are not inside quotes.
fn between_colons(text: &str) -> Vec<&str> {
    let mut quoted = false;
    text.split(move |c| {
        quoted ^= c == '"';
        c == ':' && !quoted
    })
    .collect()
}

/// The file on disk that a name refers to: the file itself, or the one that it is within.
pub fn file_of(path: &Path) -> PathBuf {
    let is_file = |name: &str| Path::new(name).is_file().then(|| PathBuf::from(name));
    let within = if path.exists() { None } else { path.to_str().and_then(|name| Within::find(name, &is_file)) };
    within.map_or_else(|| path.into(), |within| within.file)
}

pub(super) fn open_dataset(path: &Path) -> Result<Dataset, Error> {
    keep_gdal_quiet();
    if let Err(source) = std::fs::metadata(file_of(path)) {
        let remote = path.to_str().is_some_and(|name| !path.exists() && is_remote(name));
        return Err(if remote {
            Error::Remote { path: path.into() }
        } else {
            Error::File { path: path.into(), source }
        });
    }
    let dataset = Dataset::open(path).map_err(|source| match path.is_dir() {
        true => Error::Directory { path: path.into() },
        false => Error::NotARaster { path: path.into(), source },
    })?;
    if dataset.raster_count() == 0 {
        return Err(match parts(&dataset) {
            parts if parts.is_empty() => Error::NoBand { path: path.into() },
            parts => Error::Container { path: path.into(), parts },
        });
    }
    Ok(dataset)
}

/// Names with a scheme, of GDAL's other file systems, or of a driver.
fn is_remote(name: &str) -> bool {
    let scheme = |(scheme, _): (&str, &str)| {
        scheme.len() > 1 && scheme.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_+-".contains(&byte))
    };
    name.starts_with("/vsi") || name.starts_with('<') || name.split_once(':').is_some_and(scheme)
}

/// Names of a container's rasters, without the folder.
fn parts(dataset: &Dataset) -> Vec<String> {
    let entries = dataset.metadata_domain("SUBDATASETS").unwrap_or_default();
    let names = entries.iter().filter_map(|entry| entry.split_once("_NAME=")).map(|(_, name)| name);
    let folder = dataset.description().ok().and_then(|path| Some(format!("{}/", Path::new(&path).parent()?.display())));
    names.map(|name| folder.as_ref().map_or(name.into(), |folder| name.replace(folder.as_str(), ""))).collect()
}

/// The beginning of a file's text, where archives' labels stand.
pub(super) fn label(path: &Path) -> String {
    use std::io::Read;
    const LONGEST: u64 = 1 << 16;
    let mut bytes = Vec::new();
    let read = std::fs::File::open(file_of(path)).and_then(|file| file.take(LONGEST).read_to_end(&mut bytes));
    if read.is_err() {
        bytes.clear();
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// What follows `key =` in a label, without quotes.
pub(super) fn label_value<'a>(label: &'a str, key: &str) -> Option<&'a str> {
    label.lines().find_map(|line| {
        let (name, value) = line.split_once('=')?;
        name.trim().eq_ignore_ascii_case(key).then(|| value.trim().trim_matches('"').trim())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_within_files_are_taken_apart() {
        let find = |name: &str| (["a.zip", "b c.nc", "d.tif"].contains(&name)).then(|| Path::new("/data").join(name));
        let name = |name: &str| Within::find(name, &find).map(|within| within.name.display().to_string());
        assert_eq!(name("/vsizip/a.zip/in/dem.tif").unwrap(), "/vsizip//data/a.zip/in/dem.tif");
        assert_eq!(name("NETCDF:\"b c.nc\":z1").unwrap(), "NETCDF:\"/data/b c.nc\":z1");
        assert_eq!(name("GTIFF_DIR:2:d.tif").unwrap(), "GTIFF_DIR:2:/data/d.tif");
        for none in ["/vsizip/e.zip/dem.tif", "NETCDF:other.nc:z1", "PG:d.tif", "d.tif", "/vsicurl/http://x/d.tif"] {
            assert_eq!(name(none), None, "{none}");
        }
    }

    #[test]
    fn databases_and_addresses_are_refused_by_name() {
        for name in [
            "PG:",
            "PG:dbname=x mode=2",
            "WMS:http://a/b",
            "/vsicurl/http://a/b.tif",
            "/vsis3/a/b",
            "https://a/b.tif",
            "<GDAL_WMS/>",
        ] {
            assert!(matches!(open_dataset(Path::new(name)), Err(Error::Remote { .. })), "{name}");
        }
        assert!(matches!(open_dataset(Path::new("no/such.tif")), Err(Error::File { .. })));
    }

    #[test]
    fn a_label_gives_its_values() {
        let label = "OBJECT = IMAGE\r\n  UNIT = KILOMETER\r\n  NAME=\"HEIGHT\"\r\n";
        assert_eq!((label_value(label, "unit"), label_value(label, "NAME")), (Some("KILOMETER"), Some("HEIGHT")));
        assert_eq!(label_value(label, "OFFSET"), None);
    }
}
