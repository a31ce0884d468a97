//! Camera and Sun of each exposure as a table.

use super::record::Record;

const HEADER: &str = "frame_id,epoch_utc,tdb_s_past_j2000,camera_x_m,camera_y_m,camera_z_m,\
camera_from_body_qw,camera_from_body_qx,camera_from_body_qy,camera_from_body_qz,latitude_deg,longitude_east_deg,\
height_m,sun_x,sun_y,sun_z,sun_distance_m,sun_angular_radius_rad,sun_azimuth_deg,sun_elevation_deg";

/// Positions and directions are body-fixed. Numbers have all their digits; absent ones are empty.
pub fn csv(records: &[Record]) -> String {
    let mut text = format!("{HEADER}\n");
    for Record { facts, .. } in records {
        let (epoch, pose, sun) = (&facts.epoch, &facts.pose, &facts.sun);
        let given = [epoch.tdb_s_past_j2000]
            .into_iter()
            .chain(pose.r_body_fixed_m)
            .chain(pose.q_wxyz)
            .chain([pose.latitude_deg, pose.longitude_east_deg, pose.height_m])
            .chain(sun.direction_body_fixed)
            .chain([sun.distance_m, sun.angular_radius_rad])
            .map(Some);
        let numbers = given.chain([sun.azimuth_deg, sun.elevation_deg]);
        let numbers: Vec<String> = numbers.map(|number| number.map_or(String::new(), |n| n.to_string())).collect();
        text.push_str(&format!("{},{},{}\n", facts.frame_id, epoch.utc, numbers.join(",")));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::ExposureMetadata;

    #[test]
    fn every_line_has_as_many_columns_as_the_header() {
        let facts = ExposureMetadata { frame_id: "a/0000".into(), ..ExposureMetadata::default() };
        let record = Record {
            schema_version: String::new(),
            run_key: String::new(),
            exposure_key: String::new(),
            made_from: serde_json::Value::Null,
            facts,
            planes: Vec::new(),
            preview: None,
            files: Vec::new(),
            sha256: String::new(),
        };
        let text = csv(&[record.clone(), record]);
        let columns: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
        assert_eq!(columns, [20, 20, 20]);
    }
}
