//! Gluing: equal functions of two sides that touch element by element.
//!
//!   u = sum_i a_i A_i = sum_j b_j B_j on the common side,   so   a_i = sum_j c_ij b_j
//!
//! Elements are paired by the positions of their centres, their axes by the positions of sample points, functions by their
//! values there: functions of any sign, order and orientation are found, in n log n. Where both bases span the same
//! polynomials with other functions (Bernstein against Lagrange) a row has several terms.

use super::Trace;
use crate::basis::{Cell, Order, ShapeTable};
use crate::geometry::{Bounds, ClosestPoint, MapTable, Sag, Tree, cell};
use crate::linalg::{Real, Vector, lit, to_f64};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Values of functions that differ by less than this are equal; functions are of size one.
const SAME_VALUE: f64 = 1e-8;
/// Points nearer than this share of the sides' size coincide.
const SAME_PLACE: f64 = 1e-8;
/// Largest distance under [`Near::Corners`] between coinciding corners, as a share of the element's size.
const CURVED: f64 = 0.25;
/// Largest distance under [`Near::Facets`] between coinciding corners, as a multiple of the facets' sag.
const DEVIATIONS: f64 = 2.0;

/// Largest distance allowed between glued sides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Near<T: Real = f64> {
    /// 1e-8 of the size of the sides everywhere.
    Exact,
    /// 1e-8 of the size in the corners of elements, a quarter of the element between them: for sides meant to coincide of
    /// which one or both approximate a curve.
    Corners,
    /// 1e-8 of the size in the corners of elements, twice the deviation of their facets ([`Sag`]) between them.
    Facets,
    /// This distance everywhere \[length\].
    Given(T),
}

/// Error when sides cannot be glued.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GlueError {
    /// The sides do not coincide.
    #[error("the sides are up to {distance:e} apart (at {at:?}); allowed {allowed:e}")]
    Apart {
        /// Largest distance of a point of the slave side to the master sides \[length\].
        distance: f64,
        /// Position of that point; coordinates beyond the dimension are zero.
        at: [f64; 3],
        /// Largest distance allowed \[length\].
        allowed: f64,
    },
    /// The sides touch, but their elements are not the same.
    #[error("the grids do not match: element {element} of the slave side (around {at:?}) is no element of the master side")]
    Grids {
        /// The element of the slave side.
        element: usize,
        /// Its centre.
        at: [f64; 3],
    },
    /// The elements are the same, the functions are not.
    #[error("the functions differ on element {element} of the slave side (around {at:?}): {difference}")]
    Functions {
        /// The element of the slave side.
        element: usize,
        /// Its centre.
        at: [f64; 3],
        /// Description of the difference: degrees, number of functions, continuity or weights.
        difference: String,
    },
}

/// Two coinciding facets.
#[derive(Clone, Debug, PartialEq)]
pub struct GluedFacet<const S: usize, T: Real = f64> {
    /// The slave's element.
    pub slave: usize,
    /// Index of the master side in the list.
    pub master: usize,
    /// The master's element.
    pub element: usize,
    /// Pairs of coinciding corners (slave, master), in local coordinates.
    pub corners: Vec<(Vector<S, T>, Vector<S, T>)>,
}

/// Coefficient of a slave function in terms of those of a master side: a = sum of coefficient times b over `terms`.
#[derive(Clone, Debug, PartialEq)]
pub struct GlueRow<T: Real = f64> {
    /// The slave's function in its body.
    pub function: usize,
    /// Index of the master side in the list.
    pub master: usize,
    /// (function in the master's body, coefficient).
    pub terms: Vec<(usize, T)>,
}

/// Builds the rows that equate the functions of `slave` with those of the `masters` it touches.
///
/// Every element of the slave side must be an element of one of the master sides, which may be longer.
/// A function that touches several masters has a row for each.
///
/// # Errors
/// [`GlueError`] if the sides are apart, their grids or their functions differ.
///
/// # Example
/// ```
/// use faying::geometry::shapes::rectangle;
/// use faying::space::{Body, Near, Patch, PatchSpec, glue};
/// let left = Patch::<1, 2>::try_new(&PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0])?).with_elements([2, 2]))?;
/// let right = Patch::<1, 2>::try_new(&PatchSpec::new(rectangle([1.0, 0.0], [2.0, 1.0])?).with_elements([3, 2]))?;
/// let rows = glue(&left.trace("u1")?, &[&right.trace("u0")?], Near::Exact)?;
/// assert!(rows.iter().all(|r| r.terms.len() == 1 && r.terms[0].1 == 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn glue<const S: usize, const N: usize, T: Real>(
    slave: &Trace<S, N, T>,
    masters: &[&Trace<S, N, T>],
    near: Near<T>,
) -> Result<Vec<GlueRow<T>>, GlueError> {
    glue_facets(slave, masters, near).map(|(rows, _)| rows)
}

/// Rows and pairs of facets.
type Found<const S: usize, T> = (Vec<GlueRow<T>>, Vec<GluedFacet<S, T>>);

/// Builds the rows of [`glue`] and lists the pairs of coinciding facets.
///
/// # Errors
/// As [`glue`].
pub fn glue_facets<const S: usize, const N: usize, T: Real>(
    slave: &Trace<S, N, T>,
    masters: &[&Trace<S, N, T>],
    near: Near<T>,
) -> Result<Found<S, T>, GlueError> {
    let exact = sides_size(slave, masters) * lit(SAME_PLACE);
    let none = vec![T::zero(); slave.space.num_elements()];
    match near {
        Near::Exact => glue_within(slave, masters, exact, &none),
        Near::Given(distance) => glue_within(slave, masters, distance, &none),
        Near::Corners => {
            let shares: Vec<T> = slave.space.all_bounds().iter().map(|b| b.diagonal() * lit(CURVED)).collect();
            glue_within(slave, masters, exact, &shares)
        }
        // most sides coincide point by point: the sag is computed only if they do not
        Near::Facets => glue_within(slave, masters, exact, &none).or_else(|_| {
            let most = |trace: &Trace<S, N, T>| {
                let sag = Sag::of(&*trace.space, &trace.outward);
                (0..trace.facets.len()).map(|e| sag.of_facet(e) * lit(DEVIATIONS)).collect::<Vec<T>>()
            };
            let widest = masters.iter().flat_map(|m| most(m)).fold(T::zero(), |a, b| a.max(b));
            let wide: Vec<T> = most(slave).into_iter().map(|own| own.max(widest)).collect();
            glue_within(slave, masters, exact, &wide)
        }),
    }
}

/// Glues facets that are within `tight` in the corners of elements, and within `wide` between those of each slave element.
fn glue_within<const S: usize, const N: usize, T: Real>(
    slave: &Trace<S, N, T>,
    masters: &[&Trace<S, N, T>],
    tight: T,
    wide: &[T],
) -> Result<Found<S, T>, GlueError> {
    let partners = Partners::of(masters);
    let mut rows: BTreeMap<(usize, usize), Vec<(usize, T)>> = BTreeMap::new();
    let mut facets = Vec::with_capacity(slave.facets.len());
    let mut facet = Facet::default();
    for e in 0..slave.space.num_elements() {
        let allowed = tight.max(wide[e]);
        let center = center_of(slave, e);
        let mut outcome = Outcome::<S, T>::NoPartner;
        for (m, f) in partners.near(&center, allowed) {
            match facet.compare(slave, e, masters[m], f, tight, allowed) {
                Outcome::Rows(found, corners) => {
                    facets.push(GluedFacet { slave: e, master: m, element: f, corners });
                    let mut agrees = true;
                    for (function, terms) in found {
                        agrees &= match rows.get(&(function, m)) {
                            Some(known) => same_terms(known, &terms),
                            None => {
                                rows.insert((function, m), terms);
                                true
                            }
                        };
                    }
                    outcome =
                        if agrees { Outcome::Rows(Vec::new(), Vec::new()) } else { Outcome::Differs("their continuity differs".into()) };
                    break;
                }
                Outcome::Differs(why) => outcome = Outcome::Differs(why),
                Outcome::NoPartner => {}
            }
        }
        match outcome {
            Outcome::Rows(..) => {}
            Outcome::Differs(difference) => return Err(GlueError::Functions { element: e, at: place(&center), difference }),
            Outcome::NoPartner => return Err(no_partner(slave, masters, e, &center, tight, wide)),
        }
    }
    several_masters(slave, &rows)?;
    let rows = rows.into_iter().map(|((function, master), terms)| GlueRow { function, master, terms }).collect();
    Ok((rows, facets))
}

/// Checks that a function with rows for two masters is one function of each; otherwise it is smoother than they are.
fn several_masters<const S: usize, const N: usize, T: Real>(
    slave: &Trace<S, N, T>,
    rows: &BTreeMap<(usize, usize), Vec<(usize, T)>>,
) -> Result<(), GlueError> {
    let keys: Vec<_> = rows.iter().collect();
    let bad = keys.windows(2).find(|w| w[0].0.0 == w[1].0.0 && (w[0].1.len() > 1 || w[1].1.len() > 1));
    let Some(bad) = bad else { return Ok(()) };
    let mut ids = Vec::new();
    let element = (0..slave.space.num_elements())
        .find(|&e| {
            slave.space.active(e, &mut ids);
            ids.iter().any(|&i| slave.dofs[i] == bad[0].0.0)
        })
        .unwrap_or(0);
    let difference = "the slave is smoother than the joint of two master sides".into();
    Err(GlueError::Functions { element, at: place(&center_of(slave, element)), difference })
}

/// Result of comparing two facets.
enum Outcome<const S: usize, T: Real> {
    /// Equal functions: (slave function of the body, terms of functions of the master's body); pairs of coinciding corners.
    Rows(Vec<(usize, Vec<(usize, T)>)>, Vec<(Vector<S, T>, Vector<S, T>)>),
    /// One element with different functions: description of the difference.
    Differs(String),
    /// Different elements.
    NoPartner,
}

/// Facets of the master sides by their centres.
struct Partners<const N: usize, T: Real> {
    facets: Vec<(usize, usize)>,
    tree: Tree<N, T>,
}

impl<const N: usize, T: Real> Partners<N, T> {
    fn of<const S: usize>(masters: &[&Trace<S, N, T>]) -> Self {
        let facets: Vec<(usize, usize)> =
            masters.iter().enumerate().flat_map(|(m, t)| (0..t.space.num_elements()).map(move |f| (m, f))).collect();
        let points = facets.iter().map(|&(m, f)| {
            let x = center_of(masters[m], f);
            Bounds { lo: x, hi: x }
        });
        let tree = Tree::new(points.collect());
        Self { facets, tree }
    }

    /// Facets with their centre within `reach` of `x`, the nearest first.
    fn near(&self, x: &Vector<N, T>, reach: T) -> Vec<(usize, usize)> {
        let mut found: Vec<(f64, usize)> = self
            .tree
            .meeting(&Bounds { lo: *x, hi: *x }.inflated(reach))
            .into_iter()
            .map(|i| (to_f64(self.tree.item(i).distance(x)), i))
            .filter(|(d, _)| *d <= to_f64(reach))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(_, i)| self.facets[i]).collect()
    }
}

/// Work arrays for comparing two facets.
struct Facet<const S: usize, const N: usize, T: Real> {
    maps: [MapTable<S, N, T>; 2],
    shapes: [ShapeTable<S, T>; 2],
    ids: [Vec<usize>; 2],
}

impl<const S: usize, const N: usize, T: Real> Default for Facet<S, N, T> {
    fn default() -> Self {
        Self { maps: Default::default(), shapes: Default::default(), ids: Default::default() }
    }
}

impl<const S: usize, const N: usize, T: Real> Facet<S, N, T> {
    /// Compares element `e` of `a` with element `f` of `b`.
    fn compare(&mut self, a: &Trace<S, N, T>, e: usize, b: &Trace<S, N, T>, f: usize, tight: T, allowed: T) -> Outcome<S, T> {
        let kind = a.space.cell(e);
        // the kind of a cell does not matter on curves
        if S > 1 && b.space.cell(f) != kind {
            return Outcome::NoPartner;
        }
        let [degree_a, degree_b] = [a.space.degree(e), b.space.degree(f)];
        let most = degree_a.iter().chain(&degree_b).copied().max().unwrap_or(1);
        let corners = cell::corners::<S, T>(kind);
        let points: Vec<Vector<S, T>> = corners.iter().copied().chain(cell::grid(kind, most.max(2) + 1)).collect();
        a.space.active(e, &mut self.ids[0]);
        b.space.active(f, &mut self.ids[1]);
        a.space.evaluate(e, &points, Order::Values, &mut self.shapes[0], &mut self.maps[0]);
        let mut outcome = Outcome::NoPartner;
        for turn in symmetries::<S>(kind) {
            let turned: Vec<Vector<S, T>> = points.iter().map(|xi| apply(kind, &turn, xi)).collect();
            b.space.evaluate(f, &turned, Order::Values, &mut self.shapes[1], &mut self.maps[1]);
            let far = |q: usize| self.maps[0].x[q] - self.maps[1].x[q];
            let meet = (0..points.len()).all(|q| far(q).norm() <= if q < corners.len() { tight } else { allowed });
            if !meet {
                continue;
            }
            match self.rows(points.len()) {
                Some(local) => {
                    let body = |(i, terms): (usize, Vec<(usize, T)>)| {
                        let mut terms: Vec<(usize, T)> = terms.into_iter().map(|(j, c)| (b.dofs[self.ids[1][j]], c)).collect();
                        terms.sort_unstable_by_key(|t| t.0);
                        (a.dofs[self.ids[0][i]], terms)
                    };
                    let pairs = corners.iter().copied().zip(turned.iter().copied()).collect();
                    return Outcome::Rows(local.into_iter().map(body).collect(), pairs);
                }
                None => {
                    outcome = Outcome::Differs(if degree_a.iter().max() != degree_b.iter().max() {
                        format!("degree {} against {}", listed(&degree_a), listed(&degree_b))
                    } else if self.ids[0].len() != self.ids[1].len() {
                        format!("{} functions against {}", self.ids[0].len(), self.ids[1].len())
                    } else {
                        "their continuity or their weights differ".into()
                    });
                }
            }
        }
        outcome
    }

    /// (function of a, terms of b) in local numbers; `None` if the functions do not span the same space.
    fn rows(&self, points: usize) -> Option<Vec<(usize, Vec<(usize, T)>)>> {
        let n = self.ids[0].len();
        if n != self.ids[1].len() {
            return None;
        }
        let value = |side: usize, q: usize, i: usize| self.shapes[side].values(q)[i];
        let equal: T = lit(SAME_VALUE);
        // one function each, up to a factor: A_i = s B_j, so a_i = b_j / s
        let mut taken = vec![false; n];
        let mut rows = Vec::with_capacity(n);
        for i in 0..n {
            let partner = (0..n).filter(|&j| !taken[j]).find_map(|j| {
                let (mut product, mut square) = (T::zero(), T::zero());
                for q in 0..points {
                    product += value(0, q, i) * value(1, q, j);
                    square += value(1, q, j) * value(1, q, j);
                }
                if square <= equal * equal || product.abs() <= equal * square {
                    return None;
                }
                let s = product / square;
                let same = (0..points).all(|q| (value(0, q, i) - s * value(1, q, j)).abs() <= equal * s.abs().max(T::one()));
                same.then(|| (j, snapped(T::one() / s)))
            });
            let Some((j, c)) = partner else { break };
            taken[j] = true;
            rows.push((i, vec![(j, c)]));
        }
        if rows.len() == n {
            return Some(rows);
        }
        // B_j = sum_i c_ij A_i by least squares over the points
        let [va, vb] = [0, 1].map(|side| DMatrix::<T>::from_fn(points, n, |q, i| value(side, q, i)));
        let c = va.clone().svd(true, true).solve(&vb, lit(1e-12)).ok()?;
        let defect = (&va * &c - &vb).amax();
        let full = c.clone().svd(false, false).rank(lit(1e-9)) == n;
        (defect <= equal && full)
            .then(|| (0..n).map(|i| (i, (0..n).filter(|&j| c[(i, j)].abs() > equal).map(|j| (j, snapped(c[(i, j)]))).collect())).collect())
    }
}

/// Rounds factors that are one or minus one to within the tolerance.
fn snapped<T: Real>(c: T) -> T {
    [T::one(), -T::one()].into_iter().find(|one| (c - *one).abs() <= lit(SAME_VALUE)).unwrap_or(c)
}

fn same_terms<T: Real>(a: &[(usize, T)], b: &[(usize, T)]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| x.0 == y.0 && (x.1 - y.1).abs() <= lit::<T>(SAME_VALUE) * lit(10.0))
}

/// A symmetry of a cell: the order of its axes (or barycentric coordinates) and a bit mask of the reversed ones.
struct Turn {
    order: Vec<usize>,
    flip: usize,
}

/// All symmetries of a cell: 2 of a line, 8 of a square, 6 of a triangle.
fn symmetries<const S: usize>(kind: Cell) -> Vec<Turn> {
    let tensor = S == 1 || kind == Cell::Tensor;
    let n = if tensor { S } else { S + 1 };
    let mut orders: Vec<Vec<usize>> = vec![Vec::new()];
    for k in 0..n {
        orders = orders
            .into_iter()
            .flat_map(|order| {
                (0..=k).map(move |at| {
                    let mut longer = order.clone();
                    longer.insert(k - at, k);
                    longer
                })
            })
            .collect();
    }
    let flips = if tensor { 1 << S } else { 1 };
    orders.into_iter().flat_map(|order| (0..flips).map(move |flip| Turn { order: order.clone(), flip })).collect()
}

fn apply<const S: usize, T: Real>(kind: Cell, turn: &Turn, xi: &Vector<S, T>) -> Vector<S, T> {
    if S == 1 || kind == Cell::Tensor {
        return Vector::from_fn(|k, _| if turn.flip >> k & 1 == 1 { T::one() - xi[turn.order[k]] } else { xi[turn.order[k]] });
    }
    let coordinate = |k: usize| if k < S { xi[k] } else { T::one() - xi.sum() };
    Vector::from_fn(|k, _| coordinate(turn.order[k]))
}

fn center_of<const S: usize, const N: usize, T: Real>(trace: &Trace<S, N, T>, element: usize) -> Vector<N, T> {
    let mut table = MapTable::new();
    // centre of a curve's element: its midpoint, for any kind of cell
    let kind = if S == 1 { Cell::Tensor } else { trace.space.cell(element) };
    trace.space.map(element, &[cell::center(kind)], Order::Values, &mut table);
    table.x[0]
}

/// Largest diagonal of the boxes around the slave and master sides.
fn sides_size<const S: usize, const N: usize, T: Real>(slave: &Trace<S, N, T>, masters: &[&Trace<S, N, T>]) -> T {
    let around = |t: &Trace<S, N, T>| t.space.extent();
    masters.iter().filter_map(|m| around(m)).chain(around(slave)).map(|b| b.diagonal()).fold(T::zero(), |a, b| a.max(b))
}

/// Returns the error for element `e` without a partner: the sides are apart, or their grids differ.
fn no_partner<const S: usize, const N: usize, T: Real>(
    slave: &Trace<S, N, T>,
    masters: &[&Trace<S, N, T>],
    e: usize,
    center: &Vector<N, T>,
    tight: T,
    wide: &[T],
) -> GlueError {
    let closest: Vec<_> = masters.iter().map(|m| ClosestPoint::new(m.space.clone())).collect();
    let mut table = MapTable::new();
    let mut worst: Option<(T, Vector<N, T>, T)> = None;
    for element in 0..slave.space.num_elements() {
        let allowed = tight.max(wide[element]);
        slave.space.map(element, &cell::grid(slave.space.cell(element), 3), Order::Values, &mut table);
        for x in &table.x {
            let found = closest.iter().filter_map(|c| c.project(x)).map(|p| p.distance);
            let Some(distance) = found.reduce(|a, b| a.min(b)) else { continue };
            if distance > allowed && worst.is_none_or(|w| distance > w.0) {
                worst = Some((distance, *x, allowed));
            }
        }
    }
    match worst {
        Some((distance, x, allowed)) => GlueError::Apart { distance: to_f64(distance), at: place(&x), allowed: to_f64(allowed) },
        None => GlueError::Grids { element: e, at: place(center) },
    }
}

fn place<const N: usize, T: Real>(x: &Vector<N, T>) -> [f64; 3] {
    std::array::from_fn(|k| if k < N { to_f64(x[k]) } else { 0.0 })
}

fn listed(degrees: &[usize]) -> String {
    degrees.iter().map(ToString::to_string).collect::<Vec<_>>().join(" x ")
}
