//! Lesson 7: a nonlinear material by Newton's method on internal forces. `cargo run --release --example 07_nonlinear_material`
//!
//! div q = 0 with the flux q = (1 + |g|²) g, g = grad u, on a quarter of the ring 1 < r < 2. The same flux passes every radius,
//! g + g³ = 1 / r for u' = g, so that u = g r - ln g + ln(1 + g²) / 2 up to a constant.

use faying::assembly::{Coefficient, Form, Prescribed, Reduced, dirichlet, gauss_rules, internal_force, stiffness};
use faying::geometry::shapes::annulus_sector;
use faying::linalg::{Ldlt, LinearSolver, Matrix, Vector};
use faying::space::{Body, Field, Mesh, Patch, PatchSpec, field_at, locate};
use std::error::Error;

/// The exact u(r), zero at r = 1.
pub fn exact(r: f64) -> f64 {
    let slope = |r: f64| (0..60).fold(1.0, |g: f64, _| g - (g + g.powi(3) - 1.0 / r) / (1.0 + 3.0 * g * g));
    let sum = |r: f64| {
        let g = slope(r);
        g * r - g.ln() + 0.5 * (g * g).ln_1p()
    };
    sum(r) - sum(1.0)
}

/// Solves on a body whose sides v0 and v1 are r = 1 and r = 2; returns u at r = 1.5 and the sizes of the residual.
pub fn solved(body: &dyn Body<1, 2>) -> Result<(f64, Vec<f64>), Box<dyn Error>> {
    let (space, field) = (&**body.space(), Field { first: 0, components: 1 });
    let rules = gauss_rules(space, 1);
    let sides = [body.trace("v0")?, body.trace("v1")?];
    let outer = |_: &Vector<2>| exact(2.0);
    let conditions =
        [Prescribed { trace: &sides[0], component: 0, value: None }, Prescribed { trace: &sides[1], component: 0, value: Some(&outer) }];
    let mut solver = Ldlt::new();
    let prescribed = dirichlet(&conditions, field, 1, &mut solver)?;
    let flux = |_: &Vector<2>, g: &Matrix<1, 2>| {
        let square = g.norm_squared();
        Some((g * (1.0 + square), 0.5 * square + 0.25 * square * square))
    };
    // tangent[0][j][(0, l)] = dq_l / dg_j
    let tangent = |_: &Vector<2>, g: &Matrix<1, 2>| {
        [[0, 1].map(|j| g * (2.0 * g[j]) + Matrix::<1, 2>::from_fn(|_, l| if l == j { 1.0 + g.norm_squared() } else { 0.0 }))]
    };
    let (mut u, mut steps) = (vec![0.0; space.num_functions()], Vec::new());
    prescribed.iter().for_each(|&(i, value)| u[i] = value);
    for _ in 0..20 {
        let (forces, _energy) = internal_force(space, &rules, &u, &flux)?;
        let matrix = stiffness(space, &rules, &Form::new(Coefficient::PerState(Box::new(tangent)), true).with_state(&u));
        let held: Vec<(usize, f64)> = prescribed.iter().map(|p| (p.0, 0.0)).collect();
        let load: Vec<f64> = forces.iter().map(|f| -f).collect();
        let reduced = Reduced::try_new(&[&matrix], &load, &held, &[])?;
        steps.push(reduced.load.iter().map(|r| r * r).sum::<f64>().sqrt());
        if steps[steps.len() - 1] < 1e-12 {
            break;
        }
        let mut change = vec![0.0; reduced.num_free()];
        solver.prepare(&reduced.stiffness)?;
        solver.solve(&reduced.stiffness, &reduced.load, &mut change)?;
        u.iter_mut().zip(reduced.expand(&change)).for_each(|(u, du)| *u += du);
    }
    let half = 1.5 * std::f64::consts::FRAC_1_SQRT_2;
    let (element, xi) = locate(space, &Vector::<2>::new(half, half)).ok_or("a point of the ring")?;
    Ok((field_at::<1, 2, _, _>(space, &field, &u, element, &[xi])[0].value[0], steps))
}

/// Solves on splines and on a mesh.
pub fn main() -> Result<(), Box<dyn Error>> {
    let spec = PatchSpec::new(annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0])?).with_elements([8, 8]);
    let bodies: [(&str, Box<dyn Body<1, 2>>); 2] =
        [("splines", Box::new(Patch::try_new(&spec)?)), ("mesh", Box::new(Mesh::from_patch(&spec)?))];
    for (name, body) in bodies {
        let (u, steps) = solved(&*body)?;
        let sizes: Vec<String> = steps.iter().map(|r| format!("{r:.0e}")).collect();
        println!("{name:>7}: u = {u:.7}, exact {:.7}; residuals {}", exact(1.5), sizes.join(" "));
        assert!((u - exact(1.5)).abs() < 1e-5 && steps[steps.len() - 1] < 1e-12);
        // Newton's method converges quadratically
        assert!(steps.windows(2).any(|r| r[0] < 1e-2 && r[1] < 10.0 * r[0] * r[0]));
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
