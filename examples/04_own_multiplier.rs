//! Lesson 4: a multiplier space from outside. `cargo run --release --example 04_own_multiplier`
//!
//! One constant on every two elements of the slave side: half as many multipliers as elements. It is a [`Basis`] like any other.

use faying::basis::{BSpline, Basis, Elements, Order, ShapeTable};
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::physics::Conductor;
use faying::problem::{Data, Multiplier, Problem};
use faying::space::{Mesh, Patch, PatchSpec};
use std::error::Error;

/// Constants on pairs of neighbouring elements of a side.
#[derive(Debug)]
pub struct Pairs {
    /// Ids of the two corners of every element.
    corners: Vec<Vec<usize>>,
}

impl Pairs {
    /// On the elements of `side`, which follow one another.
    pub fn new(side: &dyn Elements) -> Self {
        let of = |e: usize| {
            let mut ids = Vec::new();
            side.corners(e, &mut ids);
            ids
        };
        Self { corners: (0..side.num_elements()).map(of).collect() }
    }
}

impl Elements for Pairs {
    fn num_elements(&self) -> usize {
        self.corners.len()
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clone_from(&self.corners[element]);
    }
}

impl Basis<1> for Pairs {
    fn num_functions(&self) -> usize {
        self.corners.len().div_ceil(2)
    }
    fn degree(&self, _element: usize) -> [usize; 1] {
        [0]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.push(element / 2);
    }
    fn tabulate(&self, _element: usize, xi: &[Vector<1>], order: Order, table: &mut ShapeTable<1>) {
        table.reset(xi.len(), 1, order);
        (0..xi.len()).for_each(|q| table.values_mut(q)[0] = 1.0);
    }
}

/// Two squares of conductivities 1 and 4, tied along y = 1 with `multiplier`: y below, and 1 + (y - 1) / 4 above, carry the flux 1. Returns
/// the largest errors of the temperature at two points and of the multiplier.
pub fn tied(multiplier: impl Into<Multiplier<1, 2>>) -> Result<[f64; 2], Box<dyn Error>> {
    let mut p = Problem::<1, 2>::new();
    let below = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0])?).with_elements([7, 4]);
    let above = PatchSpec::new(rectangle([0.0, 1.0], [1.0, 2.0])?).with_elements([5, 4]);
    let below = p.body("below", Patch::try_new(&below)?, Conductor::try_new(1.0)?)?;
    let above = p.body("above", Mesh::from_patch(&above)?, Conductor::try_new(4.0)?)?;
    p.prescribe(below.side("v0"), 0, 0.0)?;
    p.traction(above.side("v1"), 0, Data::of(|_, _| 1.0))?;
    let seam = p.tie(below.side("v1"), above.side("v0"))?.multiplier(multiplier).id();
    let solution = p.assemble()?.solve(1.0, None)?;
    let [low, high] = [solution.at(below, &[0.3, 0.6])?.u[0] - 0.6, solution.at(above, &[0.7, 1.6])?.u[0] - 1.15];
    // lambda = -k du/dn of the slave
    let flux = solution.multiplier(seam)?.iter().map(|l| (l + 1.0).abs()).fold(0.0, f64::max);
    Ok([low.abs().max(high.abs()), flux])
}

/// Checks the space by the rules of every basis, and ties with it: a constant flux is exact.
pub fn main() -> Result<(), Box<dyn Error>> {
    for elements in [1, 2, 7] {
        let pairs = Pairs::new(&BSpline::<f64>::uniform(2, elements, 1));
        faying::check::basis(&pairs)?;
        faying::check::partition_of_unity(&pairs)?;
    }
    let [u, flux] = tied(Multiplier::of(|side, _is_constrained| Ok(Box::new(Pairs::new(&*side.space)))))?;
    println!("error of the temperature {u:.1e}, of the multiplier {flux:.1e}");
    assert!(u < 1e-12 && flux < 1e-12);
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
