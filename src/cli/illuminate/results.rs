//! Series of areas and places, and their files.

use std::path::Path;

use perilune_engine::dataset;
use perilune_engine::illumination::report::{AreaResult, PlaceResult, series};
use perilune_engine::illumination::{AreaSummary, Maps, Series, Track};

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
