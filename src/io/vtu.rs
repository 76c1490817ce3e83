//! High-order VTK unstructured grids (`.vtu`): one cell per element, exact where the element is rational or polynomial.
//!
//! Bezier cells carry homogeneous coefficients. With D the common denominator of map and basis on an element,
//!
//!   D(xi) = sum_a B_a(xi) w_a,   D x = sum_a B_a w_a x_a,   D u = sum_a B_a w_a u_a
//!
//! where B_a are Bernstein polynomials of a degree that holds all three. They are found by interpolation at points
//! inside the element, so the writer asks a [`Space`] nothing but its values, its degrees and its weights:
//! D is the map's weight function, times the basis' own where that is another one. A B-spline basis over a rational
//! map thus raises the degree. Where map or basis turn out to be neither polynomial nor rational (checked at points
//! between), or the degree passes what VTK evaluates ([`MAX_DEGREE`]), that element becomes a Lagrange cell.
//!
//! Fields that are no polynomials over D (stresses, the equivalent stress) are interpolated in the same way; constant
//! and, where the degree suffices, polynomial stresses are exact. Lagrange cells carry values at equispaced nodes.
//!
//! Files: version 1.0 (2.2 with hexahedra), UInt64 headers, appended raw data; equal input gives equal bytes.
//! Readers that draw: raise ParaView's "Nonlinear Subdivision Level" to 3 or 4 to see curved cells.

use super::vtu_cells::{Interpolant, Shape, bernstein, cell_type, inner_points, linear_pieces, nodes};
use crate::basis::{Block, Cell, Elements, Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::Vector;
use crate::space::Space;
use nalgebra::DMatrix;
use quick_xml::Writer;
use quick_xml::events::{BytesEnd, BytesStart, Event};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::sync::Arc;

pub use super::vtu_cells::MAX_DEGREE;

/// Values of a field at local points of an element: `components` numbers per point, point after point.
pub type Sampler<'a, const D: usize> = Box<dyn Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a>;

/// A field given per element.
pub struct PointField<'a, const D: usize> {
    /// Name of the array in the file.
    pub name: String,
    /// Numbers per point; two are written as three.
    pub components: usize,
    /// Whether the field is a combination of the space's functions, so that a Bezier cell must hold it exactly.
    pub exact: bool,
    /// The values.
    pub sample: Sampler<'a, D>,
}

impl<const D: usize> std::fmt::Debug for PointField<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PointField").field("name", &self.name).field("components", &self.components).finish_non_exhaustive()
    }
}

/// Shape of the cells of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CellStyle {
    /// Bezier cells, rational where the element is.
    Bezier,
    /// Lagrange cells with equispaced nodes.
    Lagrange,
    /// Linear cells between the nodes of the Lagrange cell.
    Linear,
}

/// A space with fields: one body of `fields.vtu`, or a side.
pub struct Part<'a, const D: usize, const N: usize> {
    /// Name, for pictures and messages.
    pub name: String,
    /// The elements and their map.
    pub space: Arc<dyn Space<D, N>>,
    /// Shape of the cells.
    pub style: CellStyle,
    /// Least degree of Lagrange cells, for fields finer than the space (multipliers on a side).
    pub least_degree: usize,
    /// The fields; every part of a file has the same names.
    pub fields: Vec<PointField<'a, D>>,
    /// All fields at once, where that costs less than each by itself: per point the numbers of one field after the other.
    pub together: Option<Sampler<'a, D>>,
}

impl<const D: usize, const N: usize> std::fmt::Debug for Part<'_, D, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Part").field("name", &self.name).field("style", &self.style).field("fields", &self.fields).finish_non_exhaustive()
    }
}

impl<'a, const D: usize, const N: usize> Part<'a, D, N> {
    /// A part without fields.
    pub fn new(name: impl Into<String>, space: Arc<dyn Space<D, N>>, style: CellStyle) -> Self {
        Self { name: name.into(), space, style, least_degree: 1, fields: Vec::new(), together: None }
    }

    /// Adds a field of the space's own functions.
    #[must_use]
    pub fn with_exact(self, name: &str, components: usize, sample: impl Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a) -> Self {
        self.with_field(name, components, true, Box::new(sample))
    }

    /// Adds a field that is interpolated.
    #[must_use]
    pub fn with(self, name: &str, components: usize, sample: impl Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a) -> Self {
        self.with_field(name, components, false, Box::new(sample))
    }

    /// Gives all fields that were added at once, the same values as each of their samplers.
    #[must_use]
    pub fn with_together(mut self, sample: impl Fn(usize, &[Vector<D>]) -> Vec<f64> + Send + Sync + 'a) -> Self {
        self.together = Some(Box::new(sample));
        self
    }

    fn with_field(mut self, name: &str, components: usize, exact: bool, sample: Sampler<'a, D>) -> Self {
        self.fields.push(PointField { name: name.to_owned(), components, exact, sample });
        self
    }
}

/// Why a grid was not written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VtuError {
    /// Parts with different fields.
    #[error("part \"{part}\" has the fields {found}, the first part {expected}; all parts of a file have the same")]
    Fields {
        /// The part.
        part: String,
        /// Its fields.
        found: String,
        /// Fields of the first part.
        expected: String,
    },
    /// A sampler returned the wrong number of values.
    #[error("field \"{field}\" of part \"{part}\" gave {found} numbers on element {element}, expected {expected}")]
    Values {
        /// The field.
        field: String,
        /// The part.
        part: String,
        /// The element.
        element: usize,
        /// Numbers given.
        found: usize,
        /// Points times components.
        expected: usize,
    },
}

/// The bytes of a `.vtu` file with all `parts`: point data of their fields, cell data `patch` (number of the part) and `element`.
///
/// # Errors
/// [`VtuError`] where the parts do not fit together.
pub fn write<const D: usize, const N: usize>(parts: &[Part<'_, D, N>]) -> Result<Vec<u8>, VtuError> {
    let names = |part: &Part<'_, D, N>| part.fields.iter().map(|f| format!("{}:{}", f.name, f.components)).collect::<Vec<_>>().join(", ");
    let mut grid = Grid::default();
    if let Some(first) = parts.first() {
        grid.names = first.fields.iter().map(|f| (f.name.clone(), padded(f.components))).collect();
        grid.fields = vec![Vec::new(); first.fields.len()];
        if let Some(odd) = parts.iter().find(|part| names(part) != names(first)) {
            return Err(VtuError::Fields { part: odd.name.clone(), found: names(odd), expected: names(first) });
        }
    }
    for (number, part) in parts.iter().enumerate() {
        for (element, piece) in part_pieces(part)?.iter().enumerate() {
            grid.append(number, element, piece);
        }
    }
    Ok(grid.into_bytes())
}

fn padded(components: usize) -> usize {
    if components == 2 { 3 } else { components }
}

/// How an element becomes a cell.
#[derive(Clone, Copy, Debug)]
struct Plan<const D: usize> {
    cell: Cell,
    shape: Shape,
    degree: [usize; D],
    /// Degree of the Lagrange cell that stands in where the Bezier cell is not exact.
    lagrange: [usize; D],
    map_weights: bool,
    basis_weights: bool,
}

/// What an element adds to the file.
#[derive(Clone, Debug, Default)]
struct Piece {
    points: Vec<[f64; 3]>,
    weights: Option<Vec<f64>>,
    /// Per field, padded components per point.
    fields: Vec<Vec<f64>>,
    kind: u8,
    degrees: [f64; 3],
    /// Local nodes of every cell.
    cells: Vec<Vec<usize>>,
}

fn part_pieces<const D: usize, const N: usize>(part: &Part<'_, D, N>) -> Result<Vec<Piece>, VtuError> {
    let plans: Vec<Plan<D>> = (0..part.space.num_elements()).into_par_iter().map(|e| plan(part, e)).collect();
    let mut known: BTreeMap<(bool, [usize; D]), Interpolant<D>> = BTreeMap::new();
    for p in &plans {
        for degree in [p.degree, p.lagrange] {
            known.entry((p.cell == Cell::Simplex, degree)).or_insert_with(|| Interpolant::new(p.cell, degree));
        }
    }
    let of = |cell: Cell, degree: [usize; D]| &known[&(cell == Cell::Simplex, degree)];
    plans
        .par_iter()
        .enumerate()
        .map(|(e, plan)| {
            if plan.shape == Shape::Bezier
                && let Some(piece) = bezier_piece(part, e, plan, of(plan.cell, plan.degree))?
            {
                return Ok(piece);
            }
            lagrange_piece(part, e, plan, of(plan.cell, plan.lagrange))
        })
        .collect()
}

fn plan<const D: usize, const N: usize>(part: &Part<'_, D, N>, element: usize) -> Plan<D> {
    let space = &*part.space;
    let cell = space.cell(element);
    let p = space.degree(element);
    let map = space.map_block(element);
    let map_degree = map.as_ref().map_or(p, |m| block_degree(&m.basis, element));
    let highest: [usize; D] = std::array::from_fn(|k| p[k].max(map_degree[k]));
    // linear cells of a degree-p element are cut between the same nodes
    let lagrange = highest.map(|d| d.max(part.least_degree).clamp(1, MAX_DEGREE));
    let mut plan = Plan { cell, shape: Shape::Lagrange, degree: lagrange, lagrange, map_weights: false, basis_weights: false };
    if part.style != CellStyle::Bezier {
        return plan;
    }
    let at = inner_points(cell, &nodes(cell, highest), highest);
    let w = map.and_then(|m| denominators(&m.basis, element, &at)).filter(|w| varies(w));
    let v = space.block(element).and_then(|b| denominators(&b, element, &at)).filter(|v| varies(v));
    let same = |w: &[f64], v: &[f64]| !varies(&w.iter().zip(v).map(|(w, v)| w / v).collect::<Vec<_>>());
    (plan.map_weights, plan.basis_weights) = match (&w, &v) {
        (Some(w), Some(v)) => (true, !same(w, v)),
        (w, v) => (w.is_some(), v.is_some()),
    };
    let one_function = match (&w, &v) {
        (None, None) => true,
        (Some(w), Some(v)) => same(w, v),
        _ => false,
    };
    plan.degree = if one_function { highest } else { std::array::from_fn(|k| p[k] + map_degree[k]) }.map(|d| d.max(1));
    if plan.degree.iter().all(|&d| d <= MAX_DEGREE) {
        plan.shape = Shape::Bezier;
    } else {
        plan.degree = lagrange;
    }
    plan
}

/// Whether positive numbers differ by more than rounding.
fn varies(w: &[f64]) -> bool {
    let (lo, hi) = w.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &w| (lo.min(w), hi.max(w)));
    hi - lo > 1e-13 * hi.abs()
}

/// Element of every axis behind `element` of a block.
fn axis_elements<const D: usize>(block: &Block<'_, D>, element: usize) -> [usize; D] {
    let mut rest = element - block.first;
    std::array::from_fn(|k| {
        let n = block.axes[k].num_elements();
        let e = rest % n;
        rest /= n;
        e
    })
}

fn block_degree<const D: usize>(block: &Block<'_, D>, element: usize) -> [usize; D] {
    let e = axis_elements(block, element);
    std::array::from_fn(|k| block.axes[k].degree(e[k])[0])
}

/// sum_i N_i w_i at local points; none without weights.
fn denominators<const D: usize>(block: &Block<'_, D>, element: usize, xi: &[Vector<D>]) -> Option<Vec<f64>> {
    let weights = block.weights?;
    let e = axis_elements(block, element);
    let mut ids: [Vec<usize>; D] = std::array::from_fn(|_| Vec::new());
    let mut tables: [ShapeTable<1>; D] = std::array::from_fn(|_| ShapeTable::new());
    let mut strides = [1; D];
    for k in 0..D {
        let line: Vec<Vector<1>> = xi.iter().map(|xi| Vector::<1>::new(xi[k])).collect();
        block.axes[k].active(e[k], &mut ids[k]);
        block.axes[k].tabulate(e[k], &line, Order::Values, &mut tables[k]);
        if k > 0 {
            strides[k] = strides[k - 1] * block.axes[k - 1].num_functions();
        }
    }
    let total: usize = ids.iter().map(Vec::len).product();
    let sum = |q: usize| {
        (0..total)
            .map(|mut a| {
                let (mut place, mut value) = (0, 1.0);
                for k in 0..D {
                    let i = a % ids[k].len();
                    a /= ids[k].len();
                    place += strides[k] * ids[k][i];
                    value *= tables[k].values(q)[i];
                }
                value * weights[place]
            })
            .sum()
    };
    Some((0..xi.len()).map(sum).collect())
}

/// D at local points.
fn denominator<const D: usize, const N: usize>(part: &Part<'_, D, N>, element: usize, plan: &Plan<D>, xi: &[Vector<D>]) -> Vec<f64> {
    let mut values = vec![1.0; xi.len()];
    let mut times = |w: Option<Vec<f64>>| values.iter_mut().zip(w.unwrap_or_default()).for_each(|(d, w)| *d *= w);
    if plan.map_weights {
        times(part.space.map_block(element).and_then(|m| denominators(&m.basis, element, xi)));
    }
    if plan.basis_weights {
        times(part.space.block(element).and_then(|b| denominators(&b, element, xi)));
    }
    values
}

/// Values of all fields, padded to three where they are two.
fn sampled<const D: usize, const N: usize>(part: &Part<'_, D, N>, element: usize, xi: &[Vector<D>]) -> Result<Vec<DMatrix<f64>>, VtuError> {
    let checked = |values: &[f64], name: &str, components: usize| {
        let (found, expected) = (values.len(), xi.len() * components);
        let fault = || VtuError::Values { field: name.to_owned(), part: part.name.clone(), element, found, expected };
        if found == expected { Ok(()) } else { Err(fault()) }
    };
    // `width` numbers per point, those of the field from `first` on
    let matrix = |values: &[f64], width: usize, first: usize, c: usize| {
        DMatrix::from_fn(xi.len(), padded(c), |q, i| if i < c { values[q * width + first + i] } else { 0.0 })
    };
    if let Some(together) = &part.together {
        let (values, width) = (together(element, xi), part.fields.iter().map(|f| f.components).sum());
        checked(&values, "all", width)?;
        let mut first = 0;
        let of = |field: &PointField<'_, D>| {
            first += field.components;
            matrix(&values, width, first - field.components, field.components)
        };
        return Ok(part.fields.iter().map(of).collect());
    }
    let own = |field: &PointField<'_, D>| {
        let values = (field.sample)(element, xi);
        checked(&values, &field.name, field.components)?;
        Ok(matrix(&values, field.components, 0, field.components))
    };
    part.fields.iter().map(own).collect()
}

fn positions<const D: usize, const N: usize>(part: &Part<'_, D, N>, element: usize, xi: &[Vector<D>]) -> DMatrix<f64> {
    let mut table = MapTable::new();
    part.space.map(element, xi, Order::Values, &mut table);
    DMatrix::from_fn(xi.len(), 3, |q, i| if i < N { table.x[q][i] } else { 0.0 })
}

fn rows(m: &DMatrix<f64>) -> Vec<f64> {
    m.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>()).collect()
}

fn triples(m: &DMatrix<f64>) -> Vec<[f64; 3]> {
    m.row_iter().map(|row| [row[0], row[1], row[2]]).collect()
}

/// Points between those of the interpolation.
fn check_points<const D: usize>(cell: Cell) -> [Vector<D>; 2] {
    let share = if cell == Cell::Simplex && D > 1 { 1.0 / D as f64 } else { 1.0 };
    [Vector::from_fn(|k, _| share * [0.31, 0.73, 0.58][k]), Vector::from_fn(|k, _| share * [0.87, 0.12, 0.44][k])]
}

/// The Bezier cell of an element; none where it does not hold map and exact fields.
fn bezier_piece<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    plan: &Plan<D>,
    of: &Interpolant<D>,
) -> Result<Option<Piece>, VtuError> {
    let n = of.points.len();
    let d = denominator(part, element, plan, &of.points);
    let w = &of.to_bezier * DMatrix::from_column_slice(d.len(), 1, &d);
    if w.iter().any(|w| !(w.is_finite() && *w > 0.0)) {
        return Ok(None);
    }
    let coefficients = |values: &DMatrix<f64>| {
        let numerators = DMatrix::from_fn(n, values.ncols(), |q, i| d[q] * values[(q, i)]);
        let mut c = &of.to_bezier * numerators;
        (0..c.nrows()).for_each(|a| c.row_mut(a).unscale_mut(w[a]));
        c
    };
    let at = check_points::<D>(plan.cell);
    let shapes: Vec<Vec<f64>> = at
        .iter()
        .map(|xi| {
            let b: Vec<f64> = bernstein(plan.cell, &of.nodes, plan.degree, xi).iter().zip(w.iter()).map(|(b, w)| b * w).collect();
            let sum: f64 = b.iter().sum();
            b.iter().map(|b| b / sum).collect()
        })
        .collect();
    // the points between stand behind those of the interpolation
    let all: Vec<Vector<D>> = of.points.iter().chain(&at).copied().collect();
    let holds = |c: &DMatrix<f64>, values: &DMatrix<f64>, tolerance: f64| {
        (0..at.len()).all(|q| {
            (0..c.ncols())
                .all(|i| (shapes[q].iter().enumerate().map(|(a, b)| b * c[(a, i)]).sum::<f64>() - values[(n + q, i)]).abs() <= tolerance)
        })
    };
    let positions = positions(part, element, &all);
    let x = coefficients(&positions);
    let size = (0..3).map(|i| x.column(i).max() - x.column(i).min()).fold(0.0, f64::max);
    if !holds(&x, &positions, 1e-10 * size + 1e-13 * x.amax()) {
        return Ok(None);
    }
    let mut fields = Vec::new();
    for (field, values) in part.fields.iter().zip(sampled(part, element, &all)?) {
        let c = coefficients(&values);
        if field.exact && !holds(&c, &values, 1e-9 * values.rows(0, n).amax()) {
            return Ok(None);
        }
        fields.push(rows(&c));
    }
    Ok(Some(Piece {
        points: triples(&x),
        weights: (plan.map_weights || plan.basis_weights).then(|| w.iter().copied().collect()),
        fields,
        kind: cell_type(D, plan.cell, Shape::Bezier),
        degrees: degrees(plan.degree),
        cells: vec![(0..of.nodes.len()).collect()],
    }))
}

fn degrees<const D: usize>(degree: [usize; D]) -> [f64; 3] {
    std::array::from_fn(|k| if k < D { degree[k] as f64 } else { 0.0 })
}

fn lagrange_piece<const D: usize, const N: usize>(
    part: &Part<'_, D, N>,
    element: usize,
    plan: &Plan<D>,
    of: &Interpolant<D>,
) -> Result<Piece, VtuError> {
    let mut fields = sampled(part, element, &of.lattice)?;
    if fields.iter().any(|values| values.iter().any(|v| !v.is_finite())) {
        // a gradient has no value where the map collapses; continue it from inside
        for (values, inside) in fields.iter_mut().zip(sampled(part, element, &of.points)?) {
            if values.iter().any(|v| !v.is_finite()) {
                *values = &of.to_lattice * inside;
            }
        }
    }
    let linear = part.style == CellStyle::Linear;
    Ok(Piece {
        points: triples(&positions(part, element, &of.lattice)),
        weights: None,
        fields: fields.iter().map(rows).collect(),
        kind: cell_type(D, plan.cell, if linear { Shape::Linear } else { Shape::Lagrange }),
        degrees: degrees(if linear { [1; D] } else { plan.lagrange }),
        cells: if linear { linear_pieces(plan.cell, plan.lagrange, &of.nodes) } else { vec![(0..of.nodes.len()).collect()] },
    })
}

/// The arrays of a file.
#[derive(Clone, Debug, Default)]
struct Grid {
    names: Vec<(String, usize)>,
    points: Vec<f64>,
    fields: Vec<Vec<f64>>,
    weights: Vec<f64>,
    rational: bool,
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
    types: Vec<u8>,
    degrees: Vec<f64>,
    patch: Vec<i32>,
    element: Vec<i32>,
}

impl Grid {
    fn append(&mut self, part: usize, element: usize, piece: &Piece) {
        let first = self.points.len() / 3;
        self.points.extend(piece.points.iter().flatten());
        self.rational |= piece.weights.is_some();
        match &piece.weights {
            Some(w) => self.weights.extend(w),
            None => self.weights.extend(std::iter::repeat_n(1.0, piece.points.len())),
        }
        for (all, own) in self.fields.iter_mut().zip(&piece.fields) {
            all.extend(own);
        }
        for cell in &piece.cells {
            self.connectivity.extend(cell.iter().map(|i| (first + i) as i64));
            self.offsets.push(self.connectivity.len() as i64);
            self.types.push(piece.kind);
            self.degrees.extend(piece.degrees);
            self.patch.push(i32::try_from(part).unwrap_or(i32::MAX));
            self.element.push(i32::try_from(element).unwrap_or(i32::MAX));
        }
    }

    fn into_bytes(self) -> Vec<u8> {
        let hexahedra = self.types.iter().any(|t| [72, 79].contains(t));
        let high_order = self.types.iter().any(|t| *t >= 68);
        let mut file = File::new();
        let version = if hexahedra { "2.2" } else { "1.0" };
        file.start(
            "VTKFile",
            &[("type", "UnstructuredGrid"), ("version", version), ("byte_order", "LittleEndian"), ("header_type", "UInt64")],
        );
        file.start("UnstructuredGrid", &[]);
        let (points, cells) = ((self.points.len() / 3).to_string(), self.types.len().to_string());
        file.start("Piece", &[("NumberOfPoints", &points), ("NumberOfCells", &cells)]);
        // the attribute, not the array alone, makes readers use the weights
        file.start("PointData", if self.rational { &[("RationalWeights", "RationalWeights")] } else { &[] });
        for ((name, components), values) in self.names.iter().zip(&self.fields) {
            file.array("Float64", name, *components, values.iter().flat_map(|v| v.to_le_bytes()));
        }
        if self.rational {
            file.array("Float64", "RationalWeights", 1, self.weights.iter().flat_map(|v| v.to_le_bytes()));
        }
        file.end("PointData");
        file.start("CellData", if high_order { &[("HigherOrderDegrees", "HigherOrderDegrees")] } else { &[] });
        if high_order {
            file.array("Float64", "HigherOrderDegrees", 3, self.degrees.iter().flat_map(|v| v.to_le_bytes()));
        }
        file.array("Int32", "patch", 1, self.patch.iter().flat_map(|v| v.to_le_bytes()));
        file.array("Int32", "element", 1, self.element.iter().flat_map(|v| v.to_le_bytes()));
        file.end("CellData");
        file.start("Points", &[]);
        file.array("Float64", "Points", 3, self.points.iter().flat_map(|v| v.to_le_bytes()));
        file.end("Points");
        file.start("Cells", &[]);
        file.array("Int64", "connectivity", 1, self.connectivity.iter().flat_map(|v| v.to_le_bytes()));
        file.array("Int64", "offsets", 1, self.offsets.iter().flat_map(|v| v.to_le_bytes()));
        file.array("UInt8", "types", 1, self.types.iter().copied());
        file.end("Cells");
        file.end("Piece");
        file.end("UnstructuredGrid");
        file.finish()
    }
}

/// An XML document with raw data appended.
pub(in crate::io) struct File {
    xml: Writer<Vec<u8>>,
    appended: Vec<u8>,
}

impl File {
    pub fn new() -> Self {
        Self { xml: Writer::new_with_indent(Vec::new(), b' ', 2), appended: Vec::new() }
    }

    fn event(&mut self, event: Event<'_>) {
        self.xml.write_event(event).expect("a Vec takes every byte");
    }

    pub fn start(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.event(Event::Start(BytesStart::new(tag).with_attributes(attributes.iter().copied())));
    }

    pub fn end(&mut self, tag: &str) {
        self.event(Event::End(BytesEnd::new(tag)));
    }

    pub fn array(&mut self, kind: &str, name: &str, components: usize, bytes: impl Iterator<Item = u8>) {
        let (components, offset) = (components.to_string(), self.appended.len().to_string());
        let attributes = [
            ("type", kind),
            ("Name", name),
            ("NumberOfComponents", components.as_str()),
            ("format", "appended"),
            ("offset", offset.as_str()),
        ];
        self.event(Event::Empty(BytesStart::new("DataArray").with_attributes(attributes)));
        let header = self.appended.len();
        self.appended.extend([0; 8]);
        self.appended.extend(bytes);
        let length = (self.appended.len() - header - 8) as u64;
        self.appended[header..header + 8].copy_from_slice(&length.to_le_bytes());
    }

    pub fn finish(mut self) -> Vec<u8> {
        self.start("AppendedData", &[("encoding", "raw")]);
        let raw = std::mem::take(&mut self.appended);
        let out = self.xml.get_mut();
        out.write_all(b"_").and_then(|()| out.write_all(&raw)).expect("a Vec takes every byte");
        self.end("AppendedData");
        self.end("VTKFile");
        let mut bytes = self.xml.into_inner();
        bytes.push(b'\n');
        bytes
    }
}
