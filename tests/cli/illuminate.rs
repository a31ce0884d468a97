//! `sim illuminate` as a user runs it.

use std::process::{Command, Output};

use perilune_engine::raster::Georeference;

fn sim(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sim")).args(arguments).output().unwrap()
}

fn text(path: &std::path::Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn a_map_and_a_series_are_written_and_bad_arguments_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (dem, out, cache) = (folder.path().join("t.tif"), folder.path().join("out"), folder.path().join("cache"));
    let made =
        sim(&["terrain", "-o", text(&dem), "--columns", "80", "--rows", "80", "--posting", "100", "--at", "-89,30"]);
    assert!(made.status.success());
    let span = ["--from", "2026-01-01T00:00:00Z", "--until", "2026-01-15T00:00:00Z", "--step", "6h"];
    let paths = ["illuminate", text(&dem), "-o", text(&out), "--cache", text(&cache)];
    let ring = folder.path().join("pad.csv");
    std::fs::write(&ring, "latitude,longitude\n-89.02,29\n-89.02,31\n-88.98,30\n").unwrap();
    let more = ["--at", "-89.01,30.2", "--area", "-89,30,1500", "--area", text(&ring), "--best", "2", "--json"];
    let output = sim(&[&paths[..], &span, &more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let table = |name: &str| {
        let tables = json["report"]["tables"].as_array().unwrap();
        tables.iter().find(|table| table["name"] == name).unwrap()["rows"].as_array().unwrap().clone()
    };
    assert_eq!((table("areas").len(), table("places").len(), table("check").len()), (2, 3, 3));
    // A circle of 1.5 km by nodes of 100 m.
    let km2 = table("areas")[0]["size_km²"].as_f64().unwrap();
    assert!((km2 - std::f64::consts::PI * 2.25).abs() < 0.2, "{km2}");
    for (file, lines) in [("place_1", 57), ("place_3", 57), ("area_1", 57), ("area_2", 57)] {
        let series = std::fs::read_to_string(out.join(format!("{file}.csv"))).unwrap();
        assert_eq!(series.lines().count(), lines, "{file}");
    }
    for file in ["html", "lit_share.png", "areas.csv", "places.csv", "json"] {
        assert!(out.join(format!("illumination.{file}")).is_file(), "{file}");
    }
    lies_on_the_model(&out.join("illumination.tif"), &dem);

    for (more, word) in [
        (&["--at", "-80,30"][..], "outside the elevation models"),
        (&["--lit", "1.5"], "share between 0 and 1"),
        (&["--area", "-89,30,10"], "holds no node"),
        (&["--area", "-80,30,1000"], "holds no node"),
        (&["--area", "pad.json"], "is no file"),
        (&["--memory", "1"], "--memory"),
        (&["--until", "2025-01-01T00:00:00Z"], "steps"),
        (&["--until", "2250-01-01T00:00:00Z"], "coverage"),
    ] {
        let arguments: Vec<&str> = match more[0] {
            "--until" => [&paths[..], &span[..2], more, &["--step", "30d"]].concat(),
            _ => [&paths[..], &span, more].concat(),
        };
        let output = sim(&arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && message.contains(word), "{more:?}: {message}");
    }
}

/// The map lies where the elevation model lies, on its pixels.
fn lies_on_the_model(map: &std::path::Path, dem: &std::path::Path) {
    let map = gdal::Dataset::open(map).unwrap();
    let (columns, rows) = map.raster_size();
    let crs = map.spatial_ref().unwrap().to_wkt().unwrap();
    let georeference = Georeference::new(&crs, map.geo_transform().unwrap(), columns).unwrap();
    // On the model's own pixels: its reference system and its corners, north up.
    let model = gdal::Dataset::open(dem).unwrap();
    let [corner, of_model] = [&map, &model].map(|file| file.geo_transform().unwrap());
    assert_eq!((corner[1], corner[2], corner[4], corner[5]), (of_model[1], 0.0, 0.0, of_model[5]));
    for axis in [0, 3] {
        let off = (corner[axis] - of_model[axis]) / 100.0;
        assert!((off - off.round()).abs() < 1e-9, "{corner:?} {of_model:?}");
    }
    assert_eq!(Georeference::new(&model.projection(), of_model, 80).unwrap().wkt, georeference.wkt);
    let units: Vec<String> = (1..=4).map(|band| map.rasterband(band).unwrap().unit()).collect();
    assert_eq!(units, ["1", "1", "h", "1"]);
    let middle = glam::DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0) / 2.0;
    let at = georeference.projector().unwrap().geodetics(&[middle])[0];
    assert!((at.latitude_rad.to_degrees() + 89.0).abs() < 1e-4, "{at:?}");
    assert!((at.longitude_east_rad.to_degrees() - 30.0).abs() < 1e-2, "{at:?}");
}
