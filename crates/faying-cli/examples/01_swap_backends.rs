//! Lesson 1: one mortar program, any two backends, swapped by type and by name.
//!
//! -lap u = 0 on two squares, [0, 1]² and [0, 1] x [1, 2], that share y = 1 with 4 against 6 elements;
//! u = sin(x) exp(y) is prescribed on the outer sides. `tied` never learns what its bodies are made of.
//!
//! `cargo run --release --example 01_swap_backends`

use faying::assembly::{Fixed, Reduced, dirichlet, errors, gauss_rules, stiffness};
use faying::constraint::{ConstrainedSystem, ConstraintSolver, Direct, RowKind};
use faying::coupling::interface::{InterfaceQuadrature, MergedCurve, Tolerance};
use faying::coupling::multiplier::{MultiplierKind, build};
use faying::coupling::{Coupling, Interface, Mortar, Rows, Side};
use faying::geometry::shapes::rectangle;
use faying::linalg::{Ldlt, Vector};
use faying::physics::{Conductor, form};
use faying::space::{Body, Field, Mesh, Patch, PatchSpec};
use std::error::Error;

fn exact(x: &Vector<2>) -> f64 {
    x[0].sin() * x[1].exp()
}

/// Ties the top of `lower` (slave) to the bottom of `upper` and returns the L2 error.
fn tied<L: Body<1, 2> + ?Sized, U: Body<1, 2> + ?Sized>(lower: &L, upper: &U) -> Result<f64, Box<dyn Error>> {
    let (material, spaces, n) = (Conductor::<2>::try_new(1.0)?, [lower.space(), upper.space()], lower.space().num_functions());
    let (form, fields) = (form(&material)?, [Field { first: 0, components: 1 }, Field { first: n, components: 1 }]);
    let matrices = spaces.map(|s| stiffness(&**s, &gauss_rules(&**s, 0), &form));
    let mut prescribed = Vec::new();
    for (sides, field) in [(["u0", "u1", "v0"].map(|s| lower.trace(s)), fields[0]), (["u0", "u1", "v1"].map(|s| upper.trace(s)), fields[1])]
    {
        let traces = sides.into_iter().collect::<Result<Vec<_>, _>>()?;
        let conditions: Vec<_> = traces.iter().map(|trace| Fixed { trace, component: 0, value: Some(&exact) }).collect();
        prescribed.extend(dirichlet(&conditions, field, 0, &mut Ldlt::new())?);
    }
    let (slave, master) = (lower.trace("v1")?, upper.trace("v0")?);
    let psi = build(&slave.space, MultiplierKind::Auto, &[true, true])?;
    let segments = MergedCurve::tied(4, Tolerance::Exact).segments(&*slave.space, &*master.space)?;
    let (s, m) = (Side { trace: &slave, field: fields[0], flux: None }, Side { trace: &master, field: fields[1], flux: None });
    let interface =
        Interface { slave: s, master: Some(m), multiplier: &[&*psi], segments: &segments, master_segments: None, direction: None };
    let rows = Mortar.assemble(&interface, n + upper.space().num_functions())?.constraint;
    let reduced = Reduced::try_new(&[&matrices[0], &matrices[1]], &vec![0.0; n + upper.space().num_functions()], &prescribed, &[])?;
    let ((slave, a), (master, b)) = (reduced.rows(&rows.slave), reduced.rows(&rows.master));
    let (constraint, offset): (_, Vec<f64>) = (Rows { slave, master }, a.iter().zip(&b).map(|(a, b)| a + b).collect());
    let (stiffness, load, kind) = (&reduced.stiffness, &reduced.load, &vec![RowKind::Equal; offset.len()]);
    let system = ConstrainedSystem { stiffness, load, constraint: &constraint, reaction: None, offset: &offset, kind, compliance: &[] };
    let u = reduced.expand(&Direct::new().solve(&system)?.unknowns);
    let solution = |x: &Vector<2>| (Vector::<1>::new(exact(x)), nalgebra::RowVector2::new(x[0].cos() * x[1].exp(), exact(x)));
    let error = |b: usize| errors(&**spaces[b], &gauss_rules(&**spaces[b], 1), &form, &u[fields[b].first..], &solution).error;
    Ok(error(0).hypot(error(1)).l2)
}

/// Ties splines to a mesh by type, and all pairs by name.
pub fn main() -> Result<(), Box<dyn Error>> {
    let below = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0])?).with_degree([2, 2]).with_elements([4, 4]);
    let above = PatchSpec::new(rectangle([0.0, 1.0], [1.0, 2.0])?).with_degree([2, 2]).with_elements([6, 6]);

    // by type
    let error = tied(&Patch::<1, 2>::try_new(&below)?, &Mesh::<1, 2>::from_patch(&above)?)?;
    println!("splines under a mesh   {error:.2e}");
    assert!(error < 3e-3);

    // by name: what a case file does
    {
        let names = faying_cli::Registry::default().plane;
        for (a, b) in [("iga", "iga"), ("iga", "fe"), ("fe", "iga"), ("fe", "fe")] {
            let (lower, upper) = (names.backends.get(a)?(&below)?, names.backends.get(b)?(&above)?);
            let error = tied(&*lower, &*upper)?;
            println!("{a:>3} under {b:<3}          {error:.2e}");
            assert!(error < 3e-3);
        }
    }
    Ok(())
}
