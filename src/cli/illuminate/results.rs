//! Series of areas and places, and their files.

use std::path::Path;

use perilune_engine::dataset;
use perilune_engine::illumination::geotiff::MappedLevel;
use perilune_engine::illumination::report::{AreaResult, PlaceResult, series};
use perilune_engine::illumination::{AreaSummary, Maps, Series, Track};
use perilune_engine::raster;

use super::area::NamedArea;

/// Each area's series summed up.
pub fn of_areas(
    named: &[&NamedArea],
    areas: &[Vec<bool>],
    all_series: Vec<Series>,
    maps: &Maps,
    track: &Track,
) -> Vec<AreaResult> {
    let of_area = |((named, counts), series): ((&&NamedArea, &Vec<bool>), Series)| {
        let summary = AreaSummary::of(maps, counts, &series, track.step_h());
        AreaResult { name: named.name.clone(), series, summary }
    };
    named.iter().zip(areas).zip(all_series).map(of_area).collect()
}

/// A file for each area and each place.
pub fn write(
    directory: &Path,
    track: &Track,
    areas: &[AreaResult],
    places: &[PlaceResult],
) -> Result<(), dataset::DatasetError> {
    for (index, area) in areas.iter().enumerate() {
        write_file(directory, &format!("area_{}.csv", index + 1), &series::of_area(track, &area.series))?;
    }
    for (index, place) in places.iter().enumerate() {
        write_file(directory, &format!("place_{}.csv", index + 1), &series::of_place(track, &place.moments))?;
    }
    Ok(())
}

fn write_file(directory: &Path, name: &str, text: &str) -> Result<(), dataset::DatasetError> {
    dataset::write_whole(&directory.join(name), text.as_bytes())
}

/// Writes the maps on the pixels of the model `dem`.
pub fn write_map(maps: &Maps, on: MappedLevel, dem: &Path, output: &Path) -> Result<(), raster::Error> {
    let (georeference, [columns, _]) = raster::Dem::lies(dem, &raster::Reading::default())?;
    maps.write(on, &georeference, columns, &output.join("illumination.tif"))
}
