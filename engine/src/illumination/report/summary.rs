//! Maps, areas and places as a report.

use super::results::{AreaResult, PlaceResult};
use super::{pictures, plots};
use crate::illumination::area::{AreaSummary, MinMeanMax};
use crate::illumination::check::Check;
use crate::illumination::{Maps, Track};
use crate::report::{Error, Machine, Report, Table, Value};
use crate::statistics::Errors;

/// What a study found: its maps, areas and places.
#[derive(Debug)]
pub struct IlluminationReport<'a> {
    pub title: String,
    pub notes: Vec<String>,
    pub track: &'a Track,
    pub maps: &'a Maps,
    /// Area of a node.
    pub node_m2: f64,
    pub areas: &'a [AreaResult],
    pub places: &'a [PlaceResult<'a>],
    /// Maps against traced nodes.
    pub check: Option<Check>,
}

impl IlluminationReport<'_> {
    pub fn report(&self) -> Result<Report, Error> {
        let mut tables = vec![self.map_table()];
        tables.extend((!self.areas.is_empty()).then(|| self.areas_table()));
        tables.extend((!self.places.is_empty()).then(|| self.places_table()));
        tables.extend(self.check.as_ref().map(check_table));
        let marks: Vec<usize> = self.places.iter().filter_map(|place| place.node).collect();
        let areas = self.areas.iter().map(|result| plots::area(result, self.track));
        Ok(Report {
            name: "illumination",
            title: self.title.clone(),
            machine: Machine::here(),
            notes: self.notes.clone(),
            tables,
            plots: areas.chain(self.places.iter().map(plots::sky)).collect(),
            figures: pictures::all(self.maps, &marks)?,
        })
    }

    /// All that was mapped.
    fn map_table(&self) -> Table {
        let columns = [("map", ""), ("smallest", ""), ("mean", ""), ("largest", ""), ("unit", "")];
        let mut table = Table::new("map", "All that was mapped", &columns);
        let maps = self.maps;
        let everywhere = vec![true; maps.lit_share.len()];
        for (name, plane, scale, unit) in [
            ("lit", &maps.lit_share, 100.0, "%"),
            ("share of the disc", &maps.disc_share, 100.0, "%"),
            ("longest night", &maps.longest_night_h, 1.0, "h"),
            ("Earth in sight", &maps.earth_share, 100.0, "%"),
        ] {
            let MinMeanMax { least, mean, most } = MinMeanMax::of(plane, &everywhere);
            let mut row: Vec<Value> = vec![name.into()];
            row.extend([least, mean, most].map(|value| Value::from(scale * value)));
            row.push(unit.into());
            table.rows.push(row);
        }
        let never = maps.lit_share.iter().filter(|share| **share == 0.0).count() as f64 * self.node_m2;
        table.rows.push(vec!["never lit".into(), Value::Missing, (never * 1e-6).into(), Value::Missing, "km²".into()]);
        table
    }

    fn areas_table(&self) -> Table {
        let columns = [
            ("area", ""),
            ("size", "km²"),
            ("lit mean", "%"),
            ("lit least", "%"),
            ("lit most", "%"),
            ("disc mean", "%"),
            ("disc least", "%"),
            ("disc most", "%"),
            ("night least", "h"),
            ("night mean", "h"),
            ("night most", "h"),
            ("all dark", "h"),
            ("some lit", "%"),
            ("Earth mean", "%"),
        ];
        let mut table = Table::new(
            "areas",
            "Areas: means and extremes over their nodes; night: a node's longest; all dark: longest time that nothing is lit",
            &columns,
        );
        for AreaResult { name, summary, .. } in self.areas {
            let AreaSummary { lit_share: lit, disc_share: disc, longest_night_h: night, .. } = summary;
            let mut row: Vec<Value> = vec![name.as_str().into(), (summary.nodes as f64 * self.node_m2 * 1e-6).into()];
            row.extend([lit, disc].iter().flat_map(|s| [s.mean, s.least, s.most]).map(|share| (100.0 * share).into()));
            row.extend([night.least, night.mean, night.most, summary.longest_dark_h].map(Value::from));
            row.extend([summary.some_lit_share, summary.earth_share.mean].map(|share| Value::from(100.0 * share)));
            table.rows.push(row);
        }
        table
    }

    fn places_table(&self) -> Table {
        let columns = [
            ("place", ""),
            ("latitude", "deg"),
            ("longitude", "deg"),
            ("lit", "%"),
            ("share of the disc", "%"),
            ("disc at the node", "%"),
            ("longest night", "h"),
            ("Earth in sight", "%"),
        ];
        let mut table = Table::new("places", "Places, by their traced skylines", &columns);
        for PlaceResult { name, at, node, summary, .. } in self.places {
            let mapped = node.map(|node| 100.0 * f64::from(self.maps.disc_share[node]));
            let mut row: Vec<Value> = vec![name.as_str().into()];
            // Five digits of a degree are 0.15 m.
            let longitude_deg = at.longitude_east_rad.to_degrees().rem_euclid(360.0);
            row.extend([at.latitude_rad.to_degrees(), longitude_deg].map(|deg| Value::Text(format!("{deg:.5}"))));
            row.extend([100.0 * summary.lit_share, 100.0 * summary.disc_share].map(Value::from));
            row.push(mapped.into());
            row.extend([summary.longest_night_h, 100.0 * summary.earth_share].map(Value::from));
            table.rows.push(row);
        }
        table
    }
}

fn check_table(check: &Check) -> Table {
    let columns = [("map", ""), ("mean", "%"), ("RMS", "%"), ("largest", "%")];
    let title = format!("Maps less traced skylines at {} nodes", check.nodes);
    let mut table = Table::new("check", &title, &columns);
    for (name, Errors { mean, rms, max, .. }) in
        [("lit", check.lit_share), ("share of the disc", check.disc_share), ("Earth in sight", check.earth_share)]
    {
        let mut row: Vec<Value> = vec![name.into()];
        row.extend([mean, rms, max].map(|error| Value::from(100.0 * error)));
        table.rows.push(row);
    }
    table
}
