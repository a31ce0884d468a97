//! Which tiles of a globe the cameras see, and at which level of detail.
//!
//! Detail is chosen by screen size: rays through a raster of each image's pixels and through their neighbours meet the body's sphere;
//! how far apart they do is what a pixel is wide on the ground, slant included. A tile is divided while
//!
//! ```text
//! posting cos c > n · width of a pixel        c: central angle from the middle of the tile's face, n: the posting in pixels
//! ```
//!
//! anywhere in it, down to the tree's finest level. Where that takes more tiles than are allowed, `n` grows by √2 until it does not.
//! Of the tiles only those are taken that may be seen by a camera or lie below one: parts of a tile, in spheres that hold their
//! relief, are held against the cone around the camera's rays and against the limb. Shadows need no others: horizons hold what
//! lies around.
//!
//! # Assumptions
//! The ground is at the height of the ground below the camera: right where that is small beside the camera's height.

use std::collections::BTreeSet;
use std::f64::consts::SQRT_2;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::camera::{Camera, Pose};
use crate::geometry::{BodyFixed, Direction, Position};
use crate::terrain::quadtree::{QuadTree, TileId};
use crate::terrain::{Cut, GlobalDem, Surface};

/// Rays along each side of an image.
const RAYS: u32 = 48;
/// Parts of a tile along its side that are looked for.
const PARTS: usize = 8;
/// Lens distortion may open the cone of rays more than at the image's border.
const WIDER_RAD: f64 = 0.02;

/// The tiles and what became of the wish.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub cut: Cut,
    /// What postings are seen as, in pixels, unless the model ends before.
    pub posting_px: f64,
}

/// Chooses tiles for images from all `poses`.
pub fn choose(
    tree: &QuadTree,
    dem: &GlobalDem,
    ground: &Surface,
    camera: &Camera,
    poses: &[Pose],
    posting_px: f64,
    most: usize,
) -> Choice {
    let footprints = poses.par_iter().flat_map_iter(|pose| footprints(ground, camera, pose)).collect::<Vec<_>>();
    let sights = poses.iter().map(|pose| Sight::new(tree, dem, camera, pose)).collect::<Vec<_>>();
    let may_be_seen = |tile| {
        let parts = parts(tree, dem, tile);
        sights.par_iter().any(|sight| sight.may_see(tree, tile, &parts))
    };
    let mut posting_px = posting_px;
    loop {
        let wanted: BTreeSet<TileId> = footprints.iter().map(|footprint| footprint.tile(tree, posting_px)).collect();
        let is_coarsest = wanted.iter().all(|tile| tile.level == 0);
        let cut = Cut::new(tree, wanted, may_be_seen);
        if cut.tiles().len() <= most || is_coarsest {
            return Choice { cut, posting_px };
        }
        posting_px *= SQRT_2;
    }
}

/// A pixel on the ground.
struct Footprint {
    at: Position<BodyFixed>,
    width_m: f64,
}

impl Footprint {
    /// The tile there whose posting is no wider than so many pixels.
    fn tile(&self, tree: &QuadTree, posting_px: f64) -> TileId {
        let (finest, _) = tree.find(tree.levels - 1, self.at);
        let p = tree.maps[finest.face].map_vector(self.at);
        let shrinks = p.z / p.length();
        let fits = |level: &usize| tree.posting_m(*level) * shrinks <= posting_px * self.width_m;
        let level = (0..tree.levels).find(fits).unwrap_or(tree.levels - 1);
        tree.find(level, self.at).0
    }
}

/// Pixels of a raster of an image's, where they see the body.
fn footprints(ground: &Surface, camera: &Camera, pose: &Pose) -> Vec<Footprint> {
    let radius_m = ground.below(pose.position).vector_m().length();
    let meets = |pixel: DVec2| {
        let direction = pose.camera_from_body.inverse() * camera.direction(pixel)?;
        on_sphere(pose.position, direction, radius_m)
    };
    let footprint = |pixel: DVec2| {
        let at = meets(pixel)?;
        // Towards the middle, or a pixel of the image's last column had no neighbour.
        let inwards = |at: f64, count: u32| if at < 0.5 * f64::from(count) { 1.0 } else { -1.0 };
        let steps = [DVec2::X * inwards(pixel.x, camera.columns), DVec2::Y * inwards(pixel.y, camera.rows)];
        let widths_m = steps.into_iter().filter_map(|step| Some(meets(pixel + step)?.distance_m(at)));
        let width_m = widths_m.fold(f64::INFINITY, f64::min);
        width_m.is_finite().then_some(Footprint { at, width_m })
    };
    let (columns, rows) = (raster(camera.columns), raster(camera.rows));
    rows.iter().flat_map(|row| columns.iter().filter_map(move |column| footprint(DVec2::new(*column, *row)))).collect()
}

/// Pixels along a side, the first and the last among them.
fn raster(pixels: u32) -> Vec<f64> {
    let count = pixels.min(RAYS);
    (0..count).map(|i| (f64::from(i) * f64::from(pixels - 1) / f64::from((count - 1).max(1))).round()).collect()
}

/// Where a ray first meets the sphere about the body's centre.
fn on_sphere(from: Position<BodyFixed>, direction: Direction<BodyFixed>, radius_m: f64) -> Option<Position<BodyFixed>> {
    let (p, d) = (from.vector_m(), direction.unit());
    let (b, c) = (p.dot(d), p.length_squared() - radius_m * radius_m);
    let discriminant = b * b - c;
    let is_ahead = b < 0.0 && c > 0.0 && discriminant >= 0.0;
    is_ahead.then(|| Position::from_m(p + d * (c / (discriminant.sqrt() - b))))
}

/// A sphere that holds a part of a tile with its relief.
struct Part {
    middle_m: DVec3,
    radius_m: f64,
}

fn parts(tree: &QuadTree, dem: &GlobalDem, tile: TileId) -> Vec<Part> {
    let side = tree.cells as f64 / PARTS as f64;
    let relief_m =
        dem.lowest_m.abs().max(dem.highest_m.abs()) + tree.body.equatorial_radius_m - tree.body.polar_radius_m;
    let part = |index: usize| {
        let corner = DVec2::new((index % PARTS) as f64, (index / PARTS) as f64) * side;
        let at = |x: f64, y: f64| tree.on_sphere(tile, corner + side * DVec2::new(x, y)).vector_m();
        let middle_m = at(0.5, 0.5);
        let corners = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)];
        let across_m = corners.iter().map(|corner| corner.distance(middle_m)).fold(0.0, f64::max);
        Part { middle_m, radius_m: across_m + relief_m }
    };
    (0..PARTS * PARTS).map(part).collect()
}

/// What a camera may see from a pose.
struct Sight {
    from: Position<BodyFixed>,
    boresight: DVec3,
    half_width_rad: f64,
    /// Central angle to the farthest peak behind the limb.
    limb_rad: f64,
}

impl Sight {
    fn new(tree: &QuadTree, dem: &GlobalDem, camera: &Camera, pose: &Pose) -> Self {
        let lowest_m = tree.body.polar_radius_m.min(tree.body.equatorial_radius_m) + dem.lowest_m;
        let limb_rad = |radius_m: f64| (lowest_m / radius_m).min(1.0).acos();
        Self {
            from: pose.position,
            boresight: pose.camera_from_body.inverse().turn(DVec3::Z),
            half_width_rad: half_width_rad(camera) + WIDER_RAD,
            limb_rad: limb_rad(pose.position.vector_m().length()) + dem.reach_rad(&tree.body),
        }
    }

    fn may_see(&self, tree: &QuadTree, tile: TileId, parts: &[Part]) -> bool {
        tree.find(tile.level, self.from).0 == tile || parts.iter().any(|part| self.may_see_part(part))
    }

    fn may_see_part(&self, part: &Part) -> bool {
        let (from_m, towards_m) = (self.from.vector_m(), part.middle_m - self.from.vector_m());
        let wide_rad = (part.radius_m / part.middle_m.length()).min(1.0).asin();
        let before_the_limb = from_m.angle_between(part.middle_m) <= self.limb_rad + wide_rad;
        let distance_m = towards_m.length();
        let in_cone = distance_m <= part.radius_m
            || self.boresight.angle_between(towards_m) <= self.half_width_rad + (part.radius_m / distance_m).asin();
        before_the_limb && in_cone
    }
}

/// The widest angle between a camera's axis and its rays.
fn half_width_rad(camera: &Camera) -> f64 {
    let (right, bottom) = (f64::from(camera.columns) - 0.5, f64::from(camera.rows) - 0.5);
    let share = |i: u32| f64::from(i) / f64::from(RAYS);
    let border = (0..=RAYS).map(share).flat_map(|share| {
        let at = DVec2::new(-0.5, -0.5).lerp(DVec2::new(right, bottom), share);
        [DVec2::new(at.x, -0.5), DVec2::new(at.x, bottom), DVec2::new(-0.5, at.y), DVec2::new(right, at.y)]
    });
    let angles = border.filter_map(|pixel| camera.direction(pixel)).map(|ray| ray.unit().angle_between(DVec3::Z));
    angles.fold(0.0, f64::max)
}
