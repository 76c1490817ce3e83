//! Size and quality of maps; maps that fold over are reported, not rejected.

use faying::basis::{Cell, Order};
use faying::geometry::{Geometry, MapTable, cell};
use faying::linalg::{Matrix, Vector, measure};
use faying::quadrature::{Quadrature, TensorRule, simplex_rule};
use rayon::prelude::*;
use serde::Serialize;

/// Determinants below this share of the largest in their element count as zero.
const ZERO: f64 = 1e-10;
/// Edges below this share of the longest one of their element have collapsed.
const COLLAPSED: f64 = 1e-12;

/// Location of a value.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Location {
    /// The patch, or the kind of cells.
    pub part: String,
    /// Number of the element in it, from 0; the number of the cell in the file if that has numbers.
    pub element: u64,
    /// Coordinates.
    pub at: [f64; 3],
}

/// Quality of the elements of the highest dimension.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Soundness {
    /// Least determinant dx/dxi of the maps from unit cells at Gauss points, the sign of the element's mean taken out [length^D].
    pub least_jacobian: f64,
    /// Least determinant over the product of the edges' lengths there: 1 for right angles, and for equilateral simplices.
    pub least_scaled_jacobian: f64,
    /// Location of the least scaled Jacobian.
    pub worst: Location,
    /// Elements whose determinant changes its sign.
    pub inverted: usize,
    /// The first of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub inverted_at: Vec<Location>,
    /// Elements with an edge that is a point.
    pub collapsed: usize,
    /// Shortest distance of two corners along an edge, collapsed edges left out \[length\].
    pub shortest_edge: f64,
    /// Longest one \[length\].
    pub longest_edge: f64,
    /// Elements listed left-handed.
    pub left_handed: usize,
    /// All elements.
    pub elements: usize,
}

/// Inverted elements that are listed with their places.
const LISTED: usize = 10;

impl Default for Soundness {
    fn default() -> Self {
        Self {
            least_jacobian: f64::INFINITY,
            least_scaled_jacobian: f64::INFINITY,
            worst: Location::default(),
            inverted: 0,
            inverted_at: Vec::new(),
            collapsed: 0,
            shortest_edge: f64::INFINITY,
            longest_edge: 0.0,
            left_handed: 0,
            elements: 0,
        }
    }
}

impl Soundness {
    /// Combines the quality of two parts.
    pub fn and(mut self, other: Self) -> Self {
        if other.least_scaled_jacobian < self.least_scaled_jacobian {
            (self.least_scaled_jacobian, self.worst) = (other.least_scaled_jacobian, other.worst);
        }
        self.least_jacobian = self.least_jacobian.min(other.least_jacobian);
        self.shortest_edge = self.shortest_edge.min(other.shortest_edge);
        self.longest_edge = self.longest_edge.max(other.longest_edge);
        self.inverted += other.inverted;
        self.collapsed += other.collapsed;
        self.left_handed += other.left_handed;
        self.elements += other.elements;
        self.inverted_at.extend(other.inverted_at);
        self.inverted_at.truncate(LISTED);
        self
    }

    /// right | left | mixed.
    pub fn handedness(&self) -> &'static str {
        match self.left_handed {
            0 => "right",
            n if n == self.elements => "left",
            _ => "mixed",
        }
    }
}

/// Quality of one element.
struct Looked {
    least: f64,
    scaled: f64,
    at: Vector<3>,
    left: bool,
    inverted: Option<Vector<3>>,
    shortest: f64,
    longest: f64,
    collapsed: bool,
}

/// det J where a map of D parameters fills D coordinates, else the measure sqrt(det JᵀJ), which has no sign.
fn determinant<const D: usize>(j: &Matrix<3, D>, flat: bool) -> f64 {
    match D {
        1 if flat => j[(0, 0)],
        2 if flat => j[(0, 0)] * j[(1, 1)] - j[(0, 1)] * j[(1, 0)],
        3 => {
            let column = |k: usize| Vector::<3>::new(j[(0, k)], j[(1, k)], j[(2, k)]);
            column(0).cross(&column(1)).dot(&column(2))
        }
        _ => measure(j),
    }
}

/// det J over the largest product of lengths of the edges at a corner, 1 for the regular cell.
fn scaled<const D: usize>(j: &Matrix<3, D>, det: f64, cell: Cell) -> f64 {
    let edge = |k: usize| Vector::<3>::new(j[(0, k)], j[(1, k)], j[(2, k)]);
    let (most, regular) = if cell == Cell::Simplex && D > 1 {
        let own: [Vector<3>; D] = std::array::from_fn(edge);
        let origin = own.iter().map(|e| e.norm()).product::<f64>();
        // edges from the end of axis k: back to the origin and to the ends of the other axes
        let ends = (0..D).map(|k| (0..D).map(|m| if m == k { own[k].norm() } else { (own[m] - own[k]).norm() }).product::<f64>());
        // det of the regular simplex of edge 1: sqrt(3) / 2, 1 / sqrt(2)
        (ends.fold(origin, f64::max), if D == 2 { 3f64.sqrt() / 2.0 } else { 0.5f64.sqrt() })
    } else {
        ((0..D).map(|k| edge(k).norm()).product::<f64>(), 1.0)
    };
    if most > 0.0 { det / (most * regular) } else { 0.0 }
}

/// Edges of a cell as pairs of its corners.
fn edges(cell: Cell, corners: usize) -> impl Iterator<Item = (usize, usize)> + Clone {
    let all = (0..corners).flat_map(move |a| (a + 1..corners).map(move |b| (a, b)));
    all.filter(move |(a, b)| cell == Cell::Simplex || (a ^ b).is_power_of_two())
}

fn look_at<const D: usize>(map: &dyn Geometry<D, 3>, element: usize, points: &Points<D>, flat: bool, table: &mut MapTable<D, 3>) -> Looked {
    let cell = map.cell(element);
    let [inside, all, corners] = &points[usize::from(cell == Cell::Simplex)];
    // one point says all of an affine map, which turns over nowhere
    let affine = map.map_structure().is_affine(element);
    map.map(element, if affine { &inside[..1] } else { inside }, Order::Gradients, table);
    let left = table.jacobian.iter().map(|j| determinant(j, flat)).sum::<f64>() < 0.0;
    let sign = if left { -1.0 } else { 1.0 };
    let mut found = Looked {
        least: f64::INFINITY,
        scaled: f64::INFINITY,
        at: Vector::zeros(),
        left,
        inverted: None,
        shortest: f64::INFINITY,
        longest: 0.0,
        collapsed: false,
    };
    let mut largest = 0.0_f64;
    for (q, j) in table.jacobian.iter().enumerate() {
        let d = determinant(j, flat);
        largest = largest.max(d.abs());
        found.least = found.least.min(sign * d);
        let s = scaled(j, sign * d, cell);
        if s < found.scaled {
            (found.scaled, found.at) = (s, table.x[q]);
        }
    }
    if !affine {
        map.map(element, all, Order::Gradients, table);
        let worst = table.jacobian.iter().map(|j| sign * determinant(j, flat)).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((q, _)) = worst.filter(|(_, d)| *d < -ZERO * largest) {
            found.inverted = Some(table.x[q]);
        }
    }
    map.map(element, corners, Order::Values, table);
    let lengths = edges(cell, corners.len()).map(|(a, b)| (table.x[a] - table.x[b]).norm());
    found.longest = lengths.clone().fold(0.0, f64::max);
    for l in lengths {
        if l <= COLLAPSED * found.longest {
            found.collapsed = true;
        } else {
            found.shortest = found.shortest.min(l);
        }
    }
    found
}

/// Gauss points, points up to the corners, and corners: of tensor cells, of simplices.
type Points<const D: usize> = [[Vec<Vector<D>>; 3]; 2];

/// Quality of a map whose largest degree is `degree`; `flat`: all coordinates beyond the D-th are zero.
pub fn look<const D: usize>(part: &str, map: &dyn Geometry<D, 3>, degree: usize, flat: bool, number: &dyn Fn(usize) -> u64) -> Soundness {
    let of = |cell: Cell, inside: Vec<Vector<D>>| [inside, cell::grid::<D, f64>(cell, degree + 2), cell::corners::<D, f64>(cell)];
    let points: Points<D> = [
        of(Cell::Tensor, TensorRule::<D, f64>::gauss([degree + 1; D]).rule(0).points.clone()),
        of(Cell::Simplex, simplex_rule::<D, f64>(2 * degree).points),
    ];
    let looked: Vec<Looked> =
        (0..map.num_elements()).into_par_iter().map_init(MapTable::<D, 3>::new, |table, e| look_at(map, e, &points, flat, table)).collect();
    let place = |e: usize, x: &Vector<3>| Location { part: part.to_owned(), element: number(e), at: [x[0], x[1], x[2]] };
    let mut all = Soundness { elements: looked.len(), ..Soundness::default() };
    for (e, l) in looked.iter().enumerate() {
        if l.scaled < all.least_scaled_jacobian {
            (all.least_scaled_jacobian, all.worst) = (l.scaled, place(e, &l.at));
        }
        all.least_jacobian = all.least_jacobian.min(l.least);
        all.shortest_edge = all.shortest_edge.min(l.shortest);
        all.longest_edge = all.longest_edge.max(l.longest);
        all.collapsed += usize::from(l.collapsed);
        all.left_handed += usize::from(l.left);
        if let Some(x) = &l.inverted {
            all.inverted += 1;
            if all.inverted_at.len() < LISTED {
                all.inverted_at.push(place(e, x));
            }
        }
    }
    all
}

/// Whether all coordinates beyond the D-th are zero.
pub fn is_flat(points: &[[f64; 3]], dimension: usize) -> bool {
    points.iter().all(|p| p[dimension.min(3)..].iter().all(|x| *x == 0.0))
}
