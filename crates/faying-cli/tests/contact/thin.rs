//! Bodies of thin cells: their measures, and the memory that is forecast for their factors.

use faying::assembly::{Prescribed, Reduced, dirichlet, gauss_rules, stiffness};
use faying::basis::BSpline;
use faying::geometry::{ControlNet, shapes};
use faying::linalg::{Ldlt, LinearSolver, Vector};
use faying::physics::{Conductor, Hooke, Material, form};
use faying::space::{Body, Field, Patch, PatchSpec, measure};
use faying_cli::Case;
use faying_cli::{Registry, RunControl, RunOptions};
use std::f64::consts::PI;

/// The quarter ring 1 < r < 2.
fn ring() -> ControlNet<2, 2> {
    shapes::annulus_sector([0.0; 2], [1.0, 2.0], [0.0, 90.0]).unwrap()
}

/// The ring times 0 < z < 1.
fn hollow() -> ControlNet<3, 3> {
    let flat = ring();
    let at = |z: f64| flat.points.iter().map(move |x| Vector::<3>::new(x[0], x[1], z));
    let weights = flat.weights.as_ref().map(|w| [w.clone(), w.clone()].concat());
    let [u, v] = flat.axes.clone();
    ControlNet::try_new([u, v, BSpline::uniform(1, 1, 0)], at(0.0).chain(at(1.0)).collect(), weights).unwrap()
}

#[test]
fn measures_of_thin_cells_are_those_of_their_formulas() {
    let near = |found: f64, exact: f64, what: &str| assert!((found / exact - 1.0).abs() < 1e-12, "{what}: {found} instead of {exact}");
    for elements in [[1, 20_000], [20_000, 1]] {
        let patch = |net| Patch::<1, 2>::try_new(&PatchSpec::new(net).with_elements(elements)).unwrap();
        near(measure(&**patch(ring()).space()), 0.75 * PI, &format!("ring of {elements:?}"));
        let disc = shapes::disc_sector([0.0; 2], 1.0, [0.0, 90.0]).unwrap();
        near(measure(&**patch(disc).space()), 0.25 * PI, &format!("disc of {elements:?}"));
    }
    for elements in [[1, 1250, 1], [300, 1, 1], [1, 1, 1250]] {
        let patch = |net| Patch::<2, 3>::try_new(&PatchSpec::new(net).with_elements(elements)).unwrap();
        near(measure(&**patch(hollow()).space()), 0.75 * PI, &format!("hollow cylinder of {elements:?}"));
    }
    let octant = shapes::sphere_octant([0.0; 3], [1.0, 2.0]).unwrap();
    for elements in [[40, 1, 1], [1, 40, 1], [1, 1, 40]] {
        let patch = Patch::<2, 3>::try_new(&PatchSpec::new(octant.clone()).with_elements(elements)).unwrap();
        near(measure(&**patch.space()), 7.0 * PI / 6.0, &format!("octant of {elements:?}"));
    }
}

/// Numbers in the factor of a body held on u0.
fn factor<const C: usize, const S: usize, const N: usize>(body: &dyn Body<S, N>, material: &dyn Material<C, N>) -> f64 {
    let space = &**body.space();
    let k = stiffness(space, &gauss_rules(space, 0), &form(material).unwrap());
    let trace = body.trace("u0").unwrap();
    let held: Vec<Prescribed<'_, S, N>> = (0..C).map(|component| Prescribed { trace: &trace, component, value: None }).collect();
    let prescribed = dirichlet(&held, Field { first: 0, components: C }, 0, &mut Ldlt::new()).unwrap();
    let reduced = Reduced::try_new(&[&k], &vec![0.0; k.num_rows()], &prescribed, &[]).unwrap();
    let mut solver = Ldlt::new();
    solver.prepare(&reduced.stiffness).unwrap();
    solver.factor_entries() as f64
}

/// What `check` forecasts for the same.
fn forecast(dimension: usize, extrude: &str, elements: &[usize]) -> f64 {
    let physics = if dimension == 2 { "poisson" } else { "elasticity" };
    let (material, held) = if dimension == 2 {
        ("conductivity = 1", "dirichlet = \"0\"")
    } else {
        ("young = 1\npoisson = 0.3", "fix = [\"x\", \"y\", \"z\"]")
    };
    let text = format!(
        "schema = 1\n[model]\nphysics = \"{physics}\"\ndimension = {dimension}\n[discretization]\nbackend = \"iga\"\ndegree = 2\n\
         [[material]]\nname = \"m\"\n{material}\n[[patch]]\nname = \"b\"\nelements = {elements:?}\n\
         geometry = {{ kind = \"annulus-sector\", radius = [1, 2], angle_deg = [0, 90]{extrude} }}\n\
         [[boundary]]\non = \"b.u0\"\n{held}\n"
    );
    let case = Case::parse("thin.toml", &text, &Default::default()).unwrap_or_else(|e| panic!("{e}"));
    let checked = faying_cli::run::check(&case, &Registry::default(), &RunOptions::default(), &RunControl::default());
    checked.result.predicted.unwrap_or_else(|| panic!("{:?}", checked.result.diagnostics)).factor as f64
}

#[test]
fn factors_of_thin_bodies_are_forecast() {
    let fits = |found: f64, forecast: f64, what: &str| {
        println!("{what}: {found} numbers, forecast {forecast}, {:.2}", forecast / found);
        assert!((0.67..4.0).contains(&(forecast / found)), "{what}: {found} numbers, forecast {forecast}");
    };
    for elements in [[1, 20_000], [4, 5000], [40, 500], [5000, 2]] {
        let spec = PatchSpec::new(ring()).with_degree([2; 2]).with_elements(elements);
        let body = Patch::<1, 2>::try_new(&spec).unwrap();
        fits(factor(&body, &Conductor::<2>::try_new(1.0).unwrap()), forecast(2, "", &elements), &format!("{elements:?}"));
    }
    for elements in [[2, 400, 1], [400, 2, 1], [1, 2, 400], [24, 24, 1], [2, 30, 30]] {
        let spec = PatchSpec::new(hollow()).with_degree([2; 3]).with_elements(elements);
        let body = Patch::<2, 3>::try_new(&spec).unwrap();
        fits(factor(&body, &Hooke::<3>::solid(1.0, 0.3).unwrap()), forecast(3, ", extrude = 1", &elements), &format!("{elements:?}"));
    }
}
