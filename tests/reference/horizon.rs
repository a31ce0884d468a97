//! Horizons against closed forms, against other programs, and the fast ones against the believed ones.
mod scene;

use std::time::Instant;

use perilune::horizon::Settings;
use perilune::horizon::sweep::Sweep;
use perilune::horizon::sweep::grid::Major;
use perilune::horizon::trace::Tracer;
use perilune::terrain::Face;

fn quantiles_deg(mut errors: Vec<f64>) -> [f64; 4] {
    errors.iter_mut().for_each(|e| *e = e.abs().to_degrees());
    errors.sort_by(f64::total_cmp);
    [0.5, 0.95, 0.99, 1.0].map(|q| errors[((errors.len() - 1) as f64 * q) as usize])
}

fn compare(face: &Face, level: usize, settings: &Settings, pixels: usize) -> (Vec<(usize, f64, f64, f64)>, f64) {
    let tracer = Tracer::without_finer(face, level, settings);
    let mut rows = Vec::new();
    let mut seconds = 0.0;
    let mut samples = 0;
    for major in [Major::Row, Major::Column] {
        let sweep = Sweep::new(face, level, major, settings);
        let r = &sweep.receivers;
        let mut random = scene::Random(7);
        let sample: Vec<_> = (0..pixels)
            .map(|_| ((random.next() * r.majors as f64) as usize, (random.next() * r.minors as f64) as usize))
            .collect();
        for azimuth in 0..settings.azimuths {
            let direction = settings.direction(azimuth);
            if Major::of(direction) != major {
                continue;
            }
            let start = Instant::now();
            let plane = sweep.elevations_rad(direction);
            seconds += start.elapsed().as_secs_f64();
            samples += r.majors * r.minors;
            for &(u, v) in &sample {
                let skyline = tracer.skyline(sweep.foot(u, v), direction);
                let got = f64::from(plane[u * r.stride + v]);
                rows.push((azimuth, skyline.distance_m, skyline.elevation_rad, got - skyline.elevation_rad));
            }
        }
    }
    (rows, samples as f64 / seconds)
}

#[test]
fn bench() {
    let nodes: usize = std::env::var("NODES").map_or(512, |n| n.parse().unwrap());
    let azimuths: usize = std::env::var("AZ").map_or(24, |n| n.parse().unwrap());
    let face = scene::cratered(nodes, 20.0, 1);
    let settings = Settings { azimuths, ..Settings::default() };
    let (rows, speed) = compare(&face, 0, &settings, 512);
    println!("{} Ms/s", speed / 1e6);
    println!("{:?}", quantiles_deg(rows.iter().map(|r| r.3).collect()));
    println!("distance {:?}", { let mut d: Vec<_> = rows.iter().map(|r| r.1).collect(); d.sort_by(f64::total_cmp); [d[d.len()/4], d[d.len()/2], d[d.len()*3/4], d[d.len()*95/100]] });
    for k in 0..7 {
        let (lo, hi) = ([0.0, 1.0, 200.0, 700.0, 1500.0, 3000.0, 8000.0][k], [1.0, 200.0, 700.0, 1500.0, 3000.0, 8000.0, 1e9][k]);
        let e: Vec<_> = rows.iter().filter(|r| r.1 >= lo && r.1 < hi).map(|r| r.3).collect();
        if !e.is_empty() { println!("{lo}..{hi}: {} bias {:.5} {:?}", e.len(), e.iter().sum::<f64>().to_degrees() / e.len() as f64, quantiles_deg(e)); }
    }
    for a in 0..=azimuths / 8 {
        let e: Vec<_> = rows.iter().filter(|r| r.0 == a).map(|r| r.3).collect();
        println!("az {a}: {:?}", quantiles_deg(e));
    }
    let mut worst = rows.clone();
    worst.sort_by(|a, b| b.3.abs().total_cmp(&a.3.abs()));
    for w in &worst[..8] { println!("{w:?}"); }
}
