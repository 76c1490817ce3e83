//! Lesson 2: one problem, any two backends. `cargo run --release --example 02_tie_two_backends`
//!
//! -lap u = 0 on two squares, [0, 1]² and [0, 1] x [1, 2], that share y = 1 with 4 against 6 elements; u = sin(x) exp(y) on the outer
//! sides. `tied` never learns what its bodies are made of.

use faying::geometry::shapes::rectangle;
use faying::physics::Conductor;
use faying::problem::{Data, Derivatives, Exact, Point, Problem};
use faying::space::{Body, Mesh, Patch, PatchSpec};
use std::error::Error;

#[derive(Debug)]
struct Harmonic;

impl Exact for Harmonic {
    fn value(&self, _: usize, at: &Point) -> f64 {
        at.x[0].sin() * at.x[1].exp()
    }
    fn slope(&self, c: usize, at: &Point) -> Derivatives {
        let value = self.value(c, at);
        Derivatives { value, gradient: [at.x[0].cos() * at.x[1].exp(), value, 0.0], ..Derivatives::default() }
    }
    fn derivatives(&self, c: usize, at: &Point) -> Derivatives {
        let Derivatives { value, gradient, .. } = self.slope(c, at);
        Derivatives { value, gradient, hessian: [[-value, gradient[0], 0.0], [gradient[0], value, 0.0], [0.0; 3]] }
    }
}

/// Ties the top of `lower` (slave) to the bottom of `upper` and returns the L2 error.
pub fn tied(lower: impl Body<1, 2> + 'static, upper: impl Body<1, 2> + 'static) -> Result<f64, Box<dyn Error>> {
    let mut p = Problem::<1, 2>::new();
    let lower = p.body("lower", lower, Conductor::try_new(1.0)?)?;
    let upper = p.body("upper", upper, Conductor::try_new(1.0)?)?;
    for side in ["u0", "u1", "v0"].map(|s| lower.side(s)).into_iter().chain(["u0", "u1", "v1"].map(|s| upper.side(s))) {
        p.prescribe(side, 0, Data::of(|x, _| x[0].sin() * x[1].exp()))?;
    }
    p.tie(lower.side("v1"), upper.side("v0"))?;
    Ok(p.assemble()?.solve(1.0, None)?.errors(&Harmonic).iter().map(|e| e.error.l2.powi(2)).sum::<f64>().sqrt())
}

/// Ties splines and meshes in all pairs.
pub fn main() -> Result<(), Box<dyn Error>> {
    let below = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0])?).with_elements([4, 4]);
    let above = PatchSpec::new(rectangle([0.0, 1.0], [1.0, 2.0])?).with_elements([6, 6]);
    let body = |backend: &str, spec: &PatchSpec<2>| -> Result<Box<dyn Body<1, 2>>, Box<dyn Error>> {
        Ok(if backend == "splines" { Box::new(Patch::try_new(spec)?) } else { Box::new(Mesh::from_patch(spec)?) })
    };
    for (a, b) in [("splines", "splines"), ("splines", "mesh"), ("mesh", "splines"), ("mesh", "mesh")] {
        let error = tied(body(a, &below)?, body(b, &above)?)?;
        println!("{a:>7} under {b:<7}  {error:.2e}");
        assert!(error < 3e-3);
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
