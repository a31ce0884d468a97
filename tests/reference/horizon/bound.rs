//! The bound of each node's error against skylines traced at nodes that did not shape it.

use glam::DVec2;
use perilune::evaluate::verify;
use perilune::horizon::{Encoding, Request, Settings, build, store};

use super::scene::cratered;

#[test]
fn nineteen_of_twenty_nodes_lie_within_their_bound_at_every_azimuth() {
    let directory = tempfile::tempdir().unwrap();
    for seed in 1..5 {
        let face = cratered(129, 20.0, seed);
        for encoding in [Encoding::Fm16, Encoding::F16] {
            let request = Request {
                body: &perilune::geometry::Body::moon(),
                face: &face,
                level: 0,
                settings: Settings::default(),
                encoding,
            };
            build(&request, directory.path(), &|_, _| ()).unwrap();
            let (header, map) = store::read(&store::path_for(directory.path(), &request.key())).unwrap();
            let found = verify(&face, 0, &header, &map, 400, 1);
            println!("{:?} {:?} {:?}", map.errors, found.drawn, found.drawn_beyond);
            let mut b: Vec<_> = map.bounds.codes.clone();
            b.sort();
            println!(
                "bounds {:?}",
                [0.05, 0.5, 0.95, 1.0]
                    .map(|q| (((b.len() - 1) as f64 * q) as usize))
                    .map(|i| perilune::horizon::bound::decode_rad(b[i]).map(f64::to_degrees))
            );
            let _ = DVec2::ZERO;
        }
    }
}
