//! Which tiles of a globe the cameras see, and at which level of detail.
//!
//! Detail is chosen by screen size: rays through a raster of each image's pixels and through their neighbours meet the
//! body's sphere; how far apart they do is what a pixel is wide on the ground, slant included. A tile is divided while
//!
//! ```text
//! posting cos c > n · width of a pixel        c: central angle from the middle of the tile's face, n: the posting in pixels
//! ```
//!
//! anywhere in it, down to the tree's finest level; what shows behind the limb is seen from the side and as wide as it is
//! far away. Where that takes more tiles than are allowed, `n` grows by √2 until it does not.
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
use crate::geometry::{BodyFixed, Position, distance_to_spheroid_m};
use crate::terrain::quadtree::{QuadTree, TileId};
use crate::terrain::{Cut, GlobalDem, Surface};

/// Rays along each side of an image.
const RAYS: u32 = 48;
/// Steps from the limb to the farthest that shows behind it.
const RINGS: u32 = 4;
/// Parts of a face along its side that are looked for, and of a small tile.
const PARTS: usize = 32;
const LEAST_PARTS: usize = 4;
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
    let reach_rad = dem.reach_rad(&tree.body);
    let footprints = |pose: &Pose| {
        let radius_m = ground.below(pose.position).vector_m().length();
        Image { camera, pose, radius_m }.footprints(reach_rad)
    };
    let footprints = poses.par_iter().flat_map_iter(footprints).collect::<Vec<_>>();
    let sights = poses.iter().map(|pose| ViewCone::new(tree, dem, camera, pose)).collect::<Vec<_>>();
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

/// What an image's pixels see of a sphere through the ground below the camera.
struct Image<'a> {
    camera: &'a Camera,
    pose: &'a Pose,
    radius_m: f64,
}

impl Image<'_> {
    fn meets(&self, pixel: DVec2) -> Option<Position<BodyFixed>> {
        let direction = self.pose.camera_from_body.inverse() * self.camera.direction(pixel)?;
        let distance_m = distance_to_spheroid_m(DVec3::splat(self.radius_m), self.pose.position, direction)?;
        Some(Position::from_m(self.pose.position.vector_m() + direction.unit() * distance_m))
    }

    /// Pixels of a raster, where they see the body, and what stands behind its limb up to a central angle from there.
    fn footprints(&self, reach_rad: f64) -> Vec<Footprint> {
        let (columns, rows) = (raster(self.camera.columns), raster(self.camera.rows));
        let pixels = rows.iter().flat_map(|row| columns.iter().map(move |column| DVec2::new(*column, *row)));
        let pairs = |from: &[f64]| from.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>();
        let along = pairs(&columns).into_iter().flat_map(|x| rows.iter().map(move |y| x.map(|x| DVec2::new(x, *y))));
        let across = pairs(&rows).into_iter().flat_map(|y| columns.iter().map(move |x| y.map(|y| DVec2::new(*x, y))));
        let limb = along.chain(across).filter_map(|pair| self.limb_between(pair));
        let behind = limb.flat_map(|(pixel, at)| self.behind(pixel, at, reach_rad));
        pixels.filter_map(|pixel| self.footprint(pixel)).chain(behind).collect()
    }

    fn footprint(&self, pixel: DVec2) -> Option<Footprint> {
        let at = self.meets(pixel)?;
        let widths_m = self.beside(pixel).into_iter().filter_map(|other| Some(self.meets(other)?.distance_m(at)));
        let width_m = widths_m.fold(f64::INFINITY, f64::min);
        width_m.is_finite().then_some(Footprint { at, width_m })
    }

    /// The next pixels in row and column, towards the image's middle: those of its last column have no others.
    fn beside(&self, pixel: DVec2) -> [DVec2; 2] {
        let inwards = |at: f64, count: u32| if at < 0.5 * f64::from(count) { 1.0 } else { -1.0 };
        let (x, y) = (inwards(pixel.x, self.camera.columns), inwards(pixel.y, self.camera.rows));
        [pixel + DVec2::X * x, pixel + DVec2::Y * y]
    }

    /// The last pixel that sees the body between one that does and one that does not.
    fn limb_between(&self, [a, b]: [DVec2; 2]) -> Option<(DVec2, Position<BodyFixed>)> {
        let (mut on, mut off, mut at) = match (self.meets(a), self.meets(b)) {
            (Some(at), None) => (a, b, at),
            (None, Some(at)) => (b, a, at),
            _ => return None,
        };
        while on.distance(off) > 0.1 {
            let middle = 0.5 * (on + off);
            match self.meets(middle) {
                Some(found) => (on, at) = (middle, found),
                None => off = middle,
            }
        }
        Some((on, at))
    }

    /// Peaks behind the limb are seen from the side: a pixel is as wide as it is across the line of sight.
    fn behind(&self, pixel: DVec2, limb: Position<BodyFixed>, reach_rad: f64) -> Vec<Footprint> {
        let Some(ray) = self.camera.direction(pixel) else { return Vec::new() };
        let others = self.beside(pixel).into_iter().filter_map(|other| self.camera.direction(other));
        let pixel_rad = others.map(|other| ray.angle_to(other)).fold(0.0, f64::max);
        let (below, edge) = (self.pose.position.vector_m().normalize(), limb.vector_m().normalize());
        let Some(outwards) = (edge - below * below.dot(edge)).try_normalize() else { return Vec::new() };
        let at = |step: u32| {
            let (sin, cos) = (below.angle_between(edge) + f64::from(step) * reach_rad / f64::from(RINGS)).sin_cos();
            let at = Position::from_m((below * cos + outwards * sin) * self.radius_m);
            Footprint { at, width_m: pixel_rad * self.pose.position.distance_m(at) }
        };
        (1..=RINGS).map(at).collect()
    }
}

/// Pixels along a side, the first and the last among them.
fn raster(pixels: u32) -> Vec<f64> {
    let count = pixels.min(RAYS);
    (0..count).map(|i| (f64::from(i) * f64::from(pixels - 1) / f64::from((count - 1).max(1))).round()).collect()
}

/// A sphere that holds a part of a tile with its relief.
struct Part {
    middle_m: DVec3,
    radius_m: f64,
}

fn parts(tree: &QuadTree, dem: &GlobalDem, tile: TileId) -> Vec<Part> {
    let count = (PARTS >> tile.level.min(8)).max(LEAST_PARTS);
    let side = tree.cells as f64 / count as f64;
    let relief_m =
        dem.lowest_m.abs().max(dem.highest_m.abs()) + tree.body.equatorial_radius_m - tree.body.polar_radius_m;
    let part = |index: usize| {
        let corner = DVec2::new((index % count) as f64, (index / count) as f64) * side;
        let at = |x: f64, y: f64| tree.on_sphere(tile, corner + side * DVec2::new(x, y)).vector_m();
        let middle_m = at(0.5, 0.5);
        let corners = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)];
        let across_m = corners.iter().map(|corner| corner.distance(middle_m)).fold(0.0, f64::max);
        Part { middle_m, radius_m: across_m + relief_m }
    };
    (0..count * count).map(part).collect()
}

/// What a camera may see from a pose.
struct ViewCone {
    from: Position<BodyFixed>,
    boresight: DVec3,
    half_width_rad: f64,
    /// Central angle to the farthest peak behind the limb.
    limb_rad: f64,
}

impl ViewCone {
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
