//! A coarse mesh that no ground stands out of: where view rays may start.
//!
//! Jung 2020 displaces the vertices of a coarse mesh by the height field and lets the rays of the fragments start there.
//! Here a vertex takes the maximum of the squares of cells about it instead of the height under it, so that the start never
//! lies behind a crest between two vertices:
//!
//! ```text
//! height(vertex) = max { nodes of the up to four squares that meet in it }
//! ```
//!
//! A square holds `cells × cells` cells of its level; its two triangles lie on or above all of its nodes, and a bilinear
//! cell never rises above its corners. Squares that a finer level covers whole are left out. Where a square has no
//! neighbour a wall goes down to below the ground, so that whatever comes from outside meets the mesh before the ground.
//!
//! # References
//! Jung, Schrempp, Son (2020), Fast Soft Shadows on Curved Terrain with Dynamic Programming and Maximum Mipmaps, section 4.

use glam::DVec2;

use super::{Face, Level};

/// The mesh over the seen part of one level.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Corners of triangles, three each: column, row (nodes of the seen part) and lifted height.
    pub corners: Vec<[f32; 3]>,
    heights_m: Vec<f32>,
    kept: Vec<bool>,
    squares: Squares,
}

/// How a level is cut into squares.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Squares {
    cells: usize,
    columns: usize,
    rows: usize,
    last_column: usize,
    last_row: usize,
}

impl Mesh {
    /// Meshes over a face's levels, whose seen parts are given, finest first.
    pub fn of_face(face: &Face, seen: &[Level], cells: usize) -> Vec<Self> {
        let lowest = |level: &Level| level.heights_m.iter().copied().fold(f32::INFINITY, f32::min);
        let bottom_m = seen.iter().map(lowest).fold(f32::INFINITY, f32::min) - 1.0;
        (0..seen.len())
            .map(|level| {
                let finer = level.checked_sub(1).map(|finer| face.levels[finer].seen_m());
                Self::new(&seen[level], finer, cells, bottom_m)
            })
            .collect()
    }

    /// The mesh over a level without margin; `finer` are the corners of what a finer level covers.
    fn new(level: &Level, finer: Option<(DVec2, DVec2)>, cells: usize, bottom_m: f32) -> Self {
        let squares = Squares::of(level, cells);
        let covered = |column: usize, row: usize| {
            let [low, high] =
                [(column, row), (column + 1, row + 1)].map(|(c, r)| level.node_m(squares.column(c), squares.row(r)));
            finer.is_some_and(|(from, to)| low.cmpge(from).all() && high.cmple(to).all())
        };
        let kept = (0..squares.rows).flat_map(|row| (0..squares.columns).map(move |column| (column, row)));
        let kept = kept.map(|(column, row)| !covered(column, row)).collect();
        let mut mesh = Self { corners: Vec::new(), heights_m: squares.vertices_m(level), kept, squares };
        for row in 0..squares.rows {
            for column in
                (0..squares.columns).filter(|column| mesh.kept[row * squares.columns + column]).collect::<Vec<_>>()
            {
                mesh.cover(column, row, bottom_m);
            }
        }
        mesh
    }

    /// Adds a square and the walls where it has no neighbour.
    fn cover(&mut self, column: usize, row: usize, bottom_m: f32) {
        let ring = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)];
        let [a, b, c, d] = ring.map(|(column, row)| self.vertex(column, row));
        self.corners.extend([a, b, c, a, c, d]);
        let neighbours = [(0, -1), (1, 0), (0, 1), (-1, 0)];
        for (side, (x, y)) in neighbours.into_iter().enumerate() {
            let beside = column.checked_add_signed(x).zip(row.checked_add_signed(y));
            if beside.is_some_and(|(column, row)| self.holds(column, row)) {
                continue;
            }
            let [p, q] = [side, (side + 1) % 4].map(|corner| self.vertex(ring[corner].0, ring[corner].1));
            let [below_p, below_q] = [p, q].map(|[column, row, _]| [column, row, bottom_m]);
            self.corners.extend([p, q, below_q, p, below_q, below_p]);
        }
    }

    fn holds(&self, column: usize, row: usize) -> bool {
        let Squares { columns, rows, .. } = self.squares;
        column < columns && row < rows && self.kept[row * columns + column]
    }

    fn vertex(&self, column: usize, row: usize) -> [f32; 3] {
        let squares = &self.squares;
        let height_m = self.heights_m[row * (squares.columns + 1) + column];
        [squares.column(column) as f32, squares.row(row) as f32, height_m]
    }

    /// The mesh above a point given in nodes of the seen part; `None` outside, and over squares that are left out.
    pub fn height_m(&self, grid: DVec2) -> Option<f64> {
        let squares = &self.squares;
        let inside =
            grid.cmpge(DVec2::ZERO).all() && grid.x <= squares.last_column as f64 && grid.y <= squares.last_row as f64;
        let square = |at: f64, count: usize| ((at / squares.cells as f64) as usize).min(count - 1);
        let (column, row) = inside.then(|| (square(grid.x, squares.columns), square(grid.y, squares.rows)))?;
        self.holds(column, row).then(|| {
            let corners =
                [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| self.vertex(column + x, row + y).map(f64::from));
            let [a, b, c, d] = corners;
            let (x, y) = ((grid.x - a[0]) / (c[0] - a[0]), (grid.y - a[1]) / (c[1] - a[1]));
            // The diagonal from a to c parts the square.
            if x >= y {
                a[2] + x * (b[2] - a[2]) + y * (c[2] - b[2])
            } else {
                a[2] + y * (d[2] - a[2]) + x * (c[2] - d[2])
            }
        })
    }
}

impl Squares {
    fn of(level: &Level, cells: usize) -> Self {
        let (last_column, last_row) = (level.columns - 1, level.rows - 1);
        let (columns, rows) = (last_column.div_ceil(cells), last_row.div_ceil(cells));
        Self { cells, columns, rows, last_column, last_row }
    }

    /// The level's column of a column of vertices.
    fn column(&self, column: usize) -> usize {
        (column * self.cells).min(self.last_column)
    }

    fn row(&self, row: usize) -> usize {
        (row * self.cells).min(self.last_row)
    }

    /// Heights of the vertices, row by row.
    fn vertices_m(&self, level: &Level) -> Vec<f32> {
        let (columns, rows) = (self.columns + 1, self.rows + 1);
        let mut heights_m = vec![f32::NEG_INFINITY; columns * rows];
        for row in 0..self.rows {
            for column in 0..self.columns {
                let nodes = (self.row(row)..=self.row(row + 1)).flat_map(|r| {
                    &level.heights_m[level.index(self.column(column), r)..=level.index(self.column(column + 1), r)]
                });
                let maximum_m = nodes.copied().fold(f32::NEG_INFINITY, f32::max);
                for vertex in [0, 1, columns, columns + 1].map(|beside| row * columns + column + beside) {
                    heights_m[vertex] = heights_m[vertex].max(maximum_m);
                }
            }
        }
        heights_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Body, Geodetic};
    use crate::terrain::Gnomonic;

    fn level(nodes: usize, posting_m: f64) -> Level {
        let south_m = -0.5 * (nodes - 1) as f64 * posting_m;
        let heights_m = (0..nodes * nodes).map(|i| ((i * 7919) % 101) as f32).collect();
        let gap = vec![false; nodes * nodes];
        Level { columns: nodes, rows: nodes, posting_m, west_m: south_m, south_m, heights_m, gap, margin: 0 }
    }

    fn face() -> Face {
        let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-89.0, 40.0, 0.0));
        Face { map, levels: vec![level(23, 1.0), level(30, 2.0)] }
    }

    #[test]
    fn no_node_stands_out_of_the_mesh_and_each_level_lies_under_one() {
        let face = face();
        let meshes = Mesh::of_face(&face, &face.levels, 4);
        for row in 0..30 {
            for column in 0..30 {
                let at_m = face.levels[1].node_m(column, row);
                let level = face.level_at(at_m).unwrap();
                let grid = face.levels[level].grid_from_map(at_m);
                let ground_m = face.levels[level].bilinear_m(grid).unwrap();
                let mesh_m = meshes[level].height_m(grid);
                assert!(mesh_m.is_some_and(|mesh_m| mesh_m >= ground_m), "{at_m}: {mesh_m:?} over {ground_m}");
            }
        }
    }

    #[test]
    fn the_mesh_is_closed_but_for_its_bottom() {
        let face = face();
        for mesh in Mesh::of_face(&face, &face.levels, 4) {
            let mut edges = std::collections::BTreeMap::new();
            let key = |corner: [f32; 3]| corner.map(|value| value as i32);
            for triangle in mesh.corners.chunks(3) {
                for side in 0..3 {
                    let mut ends = [key(triangle[side]), key(triangle[(side + 1) % 3])];
                    ends.sort();
                    *edges.entry(ends).or_insert(0) += 1;
                }
            }
            let open = edges.into_iter().filter(|(_, triangles)| triangles % 2 == 1);
            assert!(
                open.into_iter().all(|(ends, _)| ends.iter().all(|end| end[2] == -1)),
                "an edge above the bottom is open"
            );
        }
    }
}
