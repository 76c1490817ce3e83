//! Joining and pressing together discretisations that do not match: one mortar and contact code for NURBS and Lagrange.
//!
//! # The idea in nine sentences
//!
//! 1. A domain is cut into **elements**; each has local coordinates `xi` in its reference cell. A knot span and a Lagrange
//!    cell are the same thing from here on: both answer on the unit cell, derivatives with respect to `xi`.
//! 2. A [`Basis`](basis::Basis) answers per element and per *batch of points*: active function ids, and a table of values
//!    and derivatives.
//! 3. A [`Geometry`](geometry::Geometry) answers per element and batch: `x(xi)` and its derivatives. A
//!    [`Space`](space::Space) is any basis over any geometry on the same elements: a refined basis keeps its coarse exact
//!    map, a Lagrange mesh may keep its own map or the exact one.
//! 4. A [`Body`](space::Body) is a space with named sides. A side's [`Trace`](space::Trace) is a space one dimension lower,
//!    plus its **facets**: where each of its elements lies in the body.
//! 5. An interface is a list of [`Segments`](coupling::Segments): the same physical points seen from one slave and one
//!    master element, with weights. Slave, mixed and merged integration differ only in who makes the list.
//! 6. A **multiplier space** is an ordinary basis on the slave's elements: splines of degree p, p-1, p-2, end-lowered.
//! 7. A [`Coupling`](coupling::Coupling) turns sides, multipliers and segments into rows `C` (mortar) or stiffness; it
//!    decides nothing.
//! 8. A [`ConstraintSolver`](constraint::ConstraintSolver) sees matrices only: `K u + Bᵀ lambda = f`, rows `C u + g` that
//!    are zero, soft, or a gap that stays open. Solvers wrap solvers: `ActiveSet(Condensed)`.
//! 9. Hence no line of mortar or contact code can ask "spline or Lagrange?"; there is no such question in any signature.
//!
//! # Floors
//!
//! A folder is a floor, imports point down only, and a test enforces it:
//!
//! ```text
//! linalg < quadrature < basis < geometry < space < assembly < physics < coupling < constraint < contact < problem
//!                                         check (public contract tests) may use everything up to problem
//! ```
//!
//! | floor | holds |
//! |---|---|
//! | [`linalg`] | scalars, small and sparse matrices, orderings, linear solvers |
//! | [`quadrature`] | rules on the unit cube and simplex |
//! | [`basis`] | B-splines, NURBS, Lagrange, their products and combinations |
//! | [`geometry`] | maps, control nets and their refinement, shapes, closest points |
//! | [`space`] | spaces, bodies, traces: the spline patch, the Lagrange mesh of a patch or of a file's cells, glued patches |
//! | [`assembly`] | bulk matrices by contraction, in lanes, or element by element; loads, Dirichlet projection, error norms |
//! | [`physics`] | materials, stresses, fluxes |
//! | [`coupling`] | segments, multipliers and their inf-sup constants, mortar rows, Nitsche's stiffness |
//! | [`constraint`] | saddle points, condensation, Schur complements, Uzawa, the active set |
//! | [`contact`] | obstacles, gaps, pressures, cones, Nitsche's method |
//! | [`problem`] | bodies with supports, loads, ties and contacts; their systems, states, reactions |
//! | [`check`] | contract tests for everything above: run them on your own types |
//!
//! Readers and writers of files are the crate `faying-files`, the program and its case files `faying-cli`; the book, `faying-book`, has
//! the theory of tying and of contact, with an example of every choice.
//!
//! # What the traits learnt from their first implementors
//!
//! - [`Coefficient::PerPoint`](assembly::Coefficient::PerPoint) owns its closure: the form of a material outlives the call
//!   that made it.
//! - A [`Material`](physics::Material) also answers its six spatial stresses and the divergence of its stress, so that plane
//!   strain, plane stress and manufactured sources need no case anywhere else.
//! - [`PerElement`](quadrature::PerElement) holds rules as quadratures: a rule that is a product keeps its axes.
//! - [`SolveError`](constraint::SolveError) tells a system that is singular because contact opened (a rigid motion is left)
//!   from one that is singular with every contact closed; solutions carry `C u + g` of every row.
//! - Direct and condensed solvers and the active set are `f64`, as their factorisations are; the floors below keep `T`.
//! - Gluing compares values on the common side, so that functions of any sign and order are found; where two bases span the same
//!   polynomials with other functions, one coefficient is a combination of several ([`glue`](fn@space::glue)).
//! - Bodies of a case keep their own unknowns and materials: gluing adds [`Equation`](assembly::Equation)s between them, while
//!   [`MultiPatch`](space::MultiPatch) is the same thing as one body of the library.
//! - Lowered ends combine two neighbours at a time, which keeps multipliers of splines non-negative.
//! - A [`Coupling`](coupling::Coupling) says whether it has rows, and answers lambda at points: what has no multipliers reports its flux in
//!   their place. Stiffness between bodies is a matrix beside theirs ([`Blocks`](assembly::Blocks)).
//! - [`Uzawa`](constraint::Uzawa) is [`Augmented`](constraint::Augmented) around an unconstrained solve, and penalty is its first iteration.
//! - The two lists of mixed integration are cut where the other side ends, so that either side may be the longer one.
//! - Nitsche's method for contact is a list of soft contact rows, one per point, beside stiffness: the active set over them is its Newton
//!   iteration, and it needs no loop of its own. Augmented Lagrangian is a proximal iteration around that active set: a method of contact says
//!   what its rows are from system to system ([`ContactMethod`](contact::ContactMethod), [`Outer`](constraint::Outer)).
//! - A solver may decide contact rows itself: it is asked once, and used as it is. All others stand inside the
//!   [`ActiveSet`](constraint::ActiveSet), whose errors carry the best iterate.
//! - The matrix of a discrete cone is never formed: its inverse is banded, and rows are solved with it ([`Cone`](contact::Cone)).
//! - A matrix's columns are a thing of their own ([`Sparsity`](linalg::Sparsity)): one number per block of a field's components, shared by all
//!   matrices of the field, so that a row gives its columns as an iterator and not as a slice.
//! - Elements without product structure still have tables in common: a basis names the reference cell of an element
//!   ([`BasisStructure::reference`](basis::BasisStructure::reference)), a map gives its functions and points
//!   ([`MapStructure::control`](geometry::MapStructure::control)), and a basis that keeps the functions of all elements as one list says so
//!   ([`BasisStructure::listed`](basis::BasisStructure::listed)). Each trait asks for all of this in one method, provided
//!   ([`Basis::structure`](basis::Basis::structure), [`Geometry::map_structure`](geometry::Geometry::map_structure)): a new basis
//!   implements evaluation alone. Boxes of all elements are asked for at once ([`Geometry::all_bounds`](geometry::Geometry::all_bounds),
//!   provided), so that those of a mesh look at its reference cells alone.
//! - What assembly knows of a space between two matrices is an [`Assembler`](assembly::Assembler): refilling costs values only.
//! - One loop in the plain order of elements serves every space and is what the quick ones are tested against; which of them a space takes
//!   shows in no signature.
//!
//! The crate needs Rust 1.90.

pub mod assembly;
pub mod basis;
pub mod check;
pub mod constraint;
pub mod contact;
pub mod coupling;
pub mod geometry;
pub mod linalg;
mod parallel;
pub mod physics;
pub mod problem;
pub mod quadrature;
pub mod space;

/// Crate of the vectors and matrices in signatures ([`linalg::Vector`], [`linalg::Matrix`]), in the version that this crate takes.
pub use nalgebra;
