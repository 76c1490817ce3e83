//! Several bodies glued to one: functions that agree on common sides are one function.

use super::joined::{DirectSum, one_each};
use super::{Body, GlueError, Near, SideError, Space, Trace, glue_facets};
use crate::basis::Order;
use crate::geometry::{Bounds, Embedding, MapTable, Tree, cell};
use crate::linalg::{Real, Union, Vector, lit, to_f64};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Corners nearer than this in local coordinates are one corner of a cell.
const SAME_CORNER: f64 = 1e-9;
/// Corners of different sides nearer than this share of their size are one corner.
const SAME_PLACE: f64 = 1e-9;

/// Two sides to glue: (body, side) of the slave and of the master; a body may be glued to itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seam {
    /// Body and side.
    pub slave: (usize, String),
    /// Body and side.
    pub master: (usize, String),
}

impl Seam {
    /// The seam between side `slave.1` of body `slave.0` and side `master.1` of body `master.0`.
    pub fn new(slave: (usize, &str), master: (usize, &str)) -> Self {
        Self { slave: (slave.0, slave.1.into()), master: (master.0, master.1.into()) }
    }
}

/// Error when bodies cannot be glued.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MultiPatchError {
    /// A side has no trace.
    #[error("side `{side}` of body {body}: {source}")]
    Side {
        /// The body.
        body: usize,
        /// The side.
        side: String,
        /// Cause.
        source: SideError,
    },
    /// The two sides of a seam do not match.
    #[error("seam {seam}: {source}")]
    Glue {
        /// Index in the list of seams.
        seam: usize,
        /// Cause.
        source: GlueError,
    },
    /// The functions of the sides span the same space but are not equal one by one, so they cannot be merged.
    #[error("seam {seam}: the sides span the same functions in different bases; tie them by equations, or take one basis for both")]
    Combined {
        /// Index in the list of seams.
        seam: usize,
    },
}

/// Bodies glued along seams. Sides are called NAME.SIDE; those glued entirely are not listed. (S, N) stands for (N - 1, N).
///
/// Functions that agree on a seam are one function, found by a union over all seams: a point where any number of bodies
/// meet is no special case. Every body stays a run of elements with its own blocks.
#[derive(Clone, Debug)]
pub struct MultiPatch<const S: usize, const N: usize, T: Real = f64> {
    space: Arc<dyn Space<N, N, T>>,
    first: Vec<usize>,
    names: Vec<String>,
    bodies: Vec<Arc<dyn Body<S, N, T>>>,
    /// Per body: function of the whole for each of its functions.
    ids: Vec<Vec<usize>>,
    /// Glued facets: (body, side) to the elements of its trace.
    inside: BTreeMap<(usize, String), BTreeSet<usize>>,
}

impl<const S: usize, const N: usize, T: Real> MultiPatch<S, N, T> {
    /// Glues the named `bodies` along `seams`.
    ///
    /// # Errors
    /// [`MultiPatchError`] if a side is unknown, or the sides of a seam are apart or differ.
    ///
    /// # Example
    /// ```
    /// use faying::basis::Basis;
    /// use faying::geometry::shapes::rectangle;
    /// use faying::space::{Body, MultiPatch, Near, Patch, PatchSpec, Seam};
    /// use std::sync::Arc;
    /// let square = |x: f64| Patch::<1, 2>::try_new(&PatchSpec::new(rectangle([x, 0.0], [x + 1.0, 1.0]).unwrap()).with_elements([2, 2]));
    /// let bodies: Vec<(String, Arc<dyn Body<1, 2>>)> = vec![("a".into(), Arc::new(square(0.0)?)), ("b".into(), Arc::new(square(1.0)?))];
    /// let glued = MultiPatch::try_new(bodies, &[Seam::new((0, "u1"), (1, "u0"))], Near::Exact)?;
    /// assert_eq!(glued.sides(), ["a.u0", "a.v0", "a.v1", "b.u1", "b.v0", "b.v1"]);
    /// assert_eq!(glued.space().num_functions(), 4 * 4 + 4 * 4 - 4); // quadratic
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn try_new(bodies: Vec<(String, Arc<dyn Body<S, N, T>>)>, seams: &[Seam], near: Near<T>) -> Result<Self, MultiPatchError> {
        let (names, bodies): (Vec<String>, Vec<_>) = bodies.into_iter().unzip();
        let starts = |count: &dyn Fn(&dyn Space<N, N, T>) -> usize| -> Vec<usize> {
            let mut next = 0;
            let step = |b: &Arc<dyn Body<S, N, T>>| {
                let start = next;
                next += count(&**b.space());
                start
            };
            bodies.iter().map(step).collect()
        };
        let (first, first_function) = (starts(&|s| s.num_elements()), starts(&|s| s.num_functions()));
        let corners = Corners::of(&bodies);
        let total = bodies.iter().map(|b| b.space().num_functions()).sum();
        let (mut functions, mut points) = (Union::new(total), Union::new(corners.count));
        let mut inside: BTreeMap<(usize, String), BTreeSet<usize>> = BTreeMap::new();
        for (k, seam) in seams.iter().enumerate() {
            let trace = |(body, side): &(usize, String)| {
                bodies[*body].trace(side).map_err(|source| MultiPatchError::Side { body: *body, side: side.clone(), source })
            };
            let (slave, master) = (trace(&seam.slave)?, trace(&seam.master)?);
            let (rows, facets) = glue_facets(&slave, &[&master], near).map_err(|source| MultiPatchError::Glue { seam: k, source })?;
            let [a, b] = [&seam.slave, &seam.master].map(|s| first_function[s.0]);
            for row in &rows {
                match row.terms[..] {
                    [(j, c)] if c == T::one() => functions.unite(a + row.function, b + j),
                    _ => return Err(MultiPatchError::Combined { seam: k }),
                }
            }
            for facet in &facets {
                inside.entry(seam.slave.clone()).or_default().insert(facet.slave);
                inside.entry(seam.master.clone()).or_default().insert(facet.element);
                for (here, there) in &facet.corners {
                    let ids = [(&seam.slave, &slave.facets[facet.slave], here), (&seam.master, &master.facets[facet.element], there)]
                        .map(|(s, f, xi)| corners.id(&bodies, s.0, f, xi));
                    if let [Some(x), Some(y)] = ids {
                        points.unite(x, y);
                    }
                }
            }
        }
        let (number, count) = functions.numbers();
        let (corner, _) = points.numbers();
        let mut ids = Vec::with_capacity(bodies.len());
        let mut parts = Vec::with_capacity(bodies.len());
        for (k, body) in bodies.iter().enumerate() {
            let mine: Vec<usize> = number[first_function[k]..first_function[k] + body.space().num_functions()].to_vec();
            let (space, own) = one_each(body.space(), mine.clone());
            let named = corners.known[k].iter().map(|(&local, &id)| (local, corner[id])).collect();
            parts.push((space, own, named));
            ids.push(mine);
        }
        let space: Arc<dyn Space<N, N, T>> = Arc::new(DirectSum::new(parts, count));
        Ok(Self { space, first, names, bodies, ids, inside })
    }

    /// Function of the whole for `function` of `body`.
    pub fn function(&self, body: usize, function: usize) -> usize {
        self.ids[body][function]
    }

    /// First element of every body.
    pub fn first_elements(&self) -> &[usize] {
        &self.first
    }

    /// Joins the traces of a list of sides: functions are those of the whole, multipliers are discontinuous
    /// between the sides.
    ///
    /// # Errors
    /// [`SideError`] for an unknown name, or a side inside the body.
    pub fn trace_of(&self, sides: &[&str]) -> Result<Trace<S, N, T>, SideError> {
        let mut parts = Vec::with_capacity(sides.len());
        for side in sides {
            let (body, name) = self.find(side)?;
            let trace = self.bodies[body].trace(&name)?;
            let glued = self.inside.get(&(body, name));
            let kept: Vec<usize> = (0..trace.facets.len()).filter(|f| glued.is_none_or(|g| !g.contains(f))).collect();
            let trace = match kept.len() {
                0 => return Err(SideError::Interior { facet: 0 }),
                n if n == trace.facets.len() => trace,
                _ => {
                    let kind = trace.space.cell(kept[0]);
                    Trace::from_facets(self.bodies[body].space(), kept.iter().map(|&f| trace.facets[f]).collect(), kind)?
                }
            };
            parts.push((body, trace));
        }
        let list: Vec<JoinedSide<'_, S, N, T>> = parts
            .iter()
            .map(|(body, trace)| JoinedSide {
                trace,
                dofs: trace.dofs.iter().map(|&i| self.ids[*body][i]).collect(),
                first_element: self.first[*body],
            })
            .collect();
        Ok(Trace::joined(&list))
    }

    /// Splits NAME.SIDE into the body's index and the name of its side.
    fn find(&self, side: &str) -> Result<(usize, String), SideError> {
        let unknown = || SideError::Unknown { side: side.into(), known: self.sides().join(", ") };
        let (name, own) = side.rsplit_once('.').ok_or_else(unknown)?;
        let body = self.names.iter().position(|n| n == name).ok_or_else(unknown)?;
        Ok((body, own.into()))
    }
}

impl<const S: usize, const N: usize, T: Real> Body<S, N, T> for MultiPatch<S, N, T> {
    fn space(&self) -> &Arc<dyn Space<N, N, T>> {
        &self.space
    }

    fn sides(&self) -> Vec<String> {
        let all = self.bodies.iter().enumerate().flat_map(|(k, body)| body.sides().into_iter().map(move |s| (k, s)));
        let outer = all.filter(|(k, side)| match self.inside.get(&(*k, side.clone())) {
            None => true,
            Some(glued) => self.bodies[*k].trace(side).is_ok_and(|t| glued.len() < t.facets.len()),
        });
        outer.map(|(k, side)| format!("{}.{side}", self.names[k])).collect()
    }

    fn trace(&self, side: &str) -> Result<Trace<S, N, T>, SideError> {
        self.trace_of(&[side])
    }
}

/// A side that becomes part of a longer one.
#[derive(Clone, Debug)]
pub struct JoinedSide<'a, const S: usize, const N: usize, T: Real = f64> {
    /// The side.
    pub trace: &'a Trace<S, N, T>,
    /// Function of the whole for each function of the side.
    pub dofs: Vec<usize>,
    /// First element of its body in the whole.
    pub first_element: usize,
}

impl<const S: usize, const N: usize, T: Real> Trace<S, N, T> {
    /// Joins several sides to one, in their order: functions with equal dofs are one function.
    pub fn joined(sides: &[JoinedSide<'_, S, N, T>]) -> Self {
        let (mut place, mut dofs) = (HashMap::new(), Vec::new());
        let mut parts = Vec::with_capacity(sides.len());
        let corners = common_corners(sides);
        for (side, corners) in sides.iter().zip(corners) {
            let ids: Vec<usize> = side
                .dofs
                .iter()
                .map(|&dof| {
                    *place.entry(dof).or_insert_with(|| {
                        dofs.push(dof);
                        dofs.len() - 1
                    })
                })
                .collect();
            let (space, ids) = one_each(&side.trace.space, ids);
            parts.push((space, ids, corners));
        }
        let functions = dofs.len();
        let facets =
            sides.iter().flat_map(|s| s.trace.facets.iter().map(|f| Embedding { element: f.element + s.first_element, ..*f })).collect();
        let outward = sides.iter().flat_map(|s| s.trace.outward.iter().copied()).collect();
        Self { space: Arc::new(DirectSum::new(parts, functions)), dofs, facets, outward }
    }
}

/// Common numbers for the corner ids of several sides: coinciding corners of different sides are one.
fn common_corners<const S: usize, const N: usize, T: Real>(sides: &[JoinedSide<'_, S, N, T>]) -> Vec<HashMap<usize, usize>> {
    let (mut ids, mut table) = (Vec::new(), MapTable::new());
    let mut known: Vec<HashMap<usize, usize>> = Vec::with_capacity(sides.len());
    let (mut places, mut owner): (Vec<Vector<N, T>>, Vec<usize>) = (Vec::new(), Vec::new());
    for (k, side) in sides.iter().enumerate() {
        let space = &*side.trace.space;
        let mut own = HashMap::new();
        for e in 0..space.num_elements() {
            space.corners(e, &mut ids);
            space.map(e, &cell::corners::<S, T>(space.cell(e)), Order::Values, &mut table);
            for (&id, x) in ids.iter().zip(&table.x) {
                own.entry(id).or_insert_with(|| {
                    places.push(*x);
                    owner.push(k);
                    places.len() - 1
                });
            }
        }
        known.push(own);
    }
    let mut union = Union::new(places.len());
    if let Some(all) = Bounds::around(&places) {
        let tolerance = all.diagonal() * lit(SAME_PLACE);
        let tree = Tree::new(places.iter().map(|p| Bounds { lo: *p, hi: *p }).collect());
        for (i, x) in places.iter().enumerate() {
            for j in tree.meeting(&Bounds { lo: *x, hi: *x }.inflated(tolerance)) {
                if owner[i] != owner[j] {
                    union.unite(i, j);
                }
            }
        }
    }
    let (number, _) = union.numbers();
    known.into_iter().map(|own| own.into_iter().map(|(id, k)| (id, number[k])).collect()).collect()
}

/// Corner ids of several bodies under common numbers.
struct Corners {
    known: Vec<HashMap<usize, usize>>,
    count: usize,
}

impl Corners {
    fn of<const S: usize, const N: usize, T: Real>(bodies: &[Arc<dyn Body<S, N, T>>]) -> Self {
        let (mut ids, mut count) = (Vec::new(), 0);
        let known = bodies
            .iter()
            .map(|body| {
                let mut own = HashMap::new();
                for e in 0..body.space().num_elements() {
                    body.space().corners(e, &mut ids);
                    for &id in &ids {
                        own.entry(id).or_insert_with(|| {
                            count += 1;
                            count - 1
                        });
                    }
                }
                own
            })
            .collect();
        Self { known, count }
    }

    /// Number of the body's corner at a corner of a facet; `None` if the body has no corner ids.
    fn id<const S: usize, const N: usize, T: Real>(
        &self,
        bodies: &[Arc<dyn Body<S, N, T>>],
        body: usize,
        facet: &Embedding<S, N, T>,
        xi: &Vector<S, T>,
    ) -> Option<usize> {
        let space = bodies[body].space();
        let here = facet.lift(xi);
        let corners = cell::corners::<N, T>(space.cell(facet.element));
        let local = corners.iter().position(|c| to_f64((c - here).norm()) <= SAME_CORNER)?;
        let mut ids = Vec::new();
        space.corners(facet.element, &mut ids);
        ids.get(local).map(|id| self.known[body][id])
    }
}
