//! `sim compare`.
use std::path::PathBuf;
use perilune::compare::{Geometry, render};
use perilune::photometry::{LimbDarkening, Reflectance, SolarDisk, Hapke};
use super::Outcome;
/// Compare
#[derive(Debug, clap::Args)]
pub struct Args { photo: PathBuf, #[arg(long)] geometry: PathBuf, #[arg(long)] dem: Vec<PathBuf>, #[arg(long, default_value_t=506)] size: usize, #[arg(long)] output: PathBuf }
pub fn run(args: Args) -> Outcome {
    let photo = perilune::raster::Picture::open(&args.photo, None)?;
    let g = Geometry::read(&args.geometry, &args.photo, [photo.columns, photo.rows])?;
    let camera = g.camera.coarser(photo.columns as f64 / args.size as f64)?;
    let terrain = render::terrain(&g, &args.dem).unwrap();
    println!("{terrain:?}");
    let bars = super::bars::Bars::new();
    let cache = PathBuf::from("/tmp/cmp/cache");
    let ground = perilune::pipeline::ground::surface(Some(&terrain), &g.body, &cache, &bars)?;
    let shadows = render::horizons(&ground.surface, &cache, &bars)?;
    let disk = SolarDisk::new(LimbDarkening::hestroffer_magnan(580.0)?)?;
    let t = |name: &str, reflectance, shadows, r| render::Trial { name: name.into(), reflectance, disk: disk.clone(), shadows, sun_radii: r };
    let ll = Reflectance::LunarLambert { normal_albedo: 0.12 };
    let ls = Reflectance::LommelSeeliger { normal_albedo: 0.12 };
    let trials = [t("ls_none", ls, false, 1.0), t("ls", ls, true, 1.0), t("ll", ll, true, 1.0), t("ll_none", ll, false, 1.0), t("lambert", Reflectance::Lambert{normal_albedo:0.12}, true, 1.0), t("hapke", Reflectance::Hapke(Hapke::moon()), true, 1.0), t("ll_hard", ll, true, 0.01)];
    let mut s = render::Studio::new(&g, &camera, ground.surface, shadows, None, &trials[0], perilune::pipeline::AdapterChoice::Auto)?;
    std::fs::create_dir_all(&args.output)?;
    let dump = |n: &str, g: &perilune::compare::Grid| { let b: Vec<u8> = g.values.iter().flat_map(|v| (*v as f32).to_le_bytes()).collect(); std::fs::write(args.output.join(n), b).unwrap(); };
    for t in &trials { let now = std::time::Instant::now(); dump(&t.name, &s.radiance(t)?); println!("{} {:?}", t.name, now.elapsed()); }
    let w = s.whole(&trials[2])?;
    for n in ["SUN_FRACTION","LOCALINCIDENCE","PIXELRESOLUTION"] { dump(n, &w.grid(n)); }
    dump("photo", &perilune::compare::Grid::from_f32(photo.columns, photo.rows, &photo.values).reduced(camera.columns(), camera.rows()));
    Ok(())
}
