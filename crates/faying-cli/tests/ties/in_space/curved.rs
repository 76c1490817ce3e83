//! Bodies that meet on a curved surface: orders of convergence.

use super::{KINDS, error, run};

/// Two layers of a quarter of a pipe, their grids with nothing in common, and a smooth solution that is none of the spaces.
fn pipe(kinds: [&str; 2], degree: usize, multiplier: &str) -> String {
    let patch = |name: &str, kind: &str, radii: &str, n: &str| {
        format!(
            "[[patch]]\nname = \"{name}\"\ngeometry = {{ kind = \"annulus-sector\", radius = {radii}, angle_deg = [0, 90], extrude = 1 }}\n\
             elements = {n}\ndegree = {degree}\n{kind}"
        )
    };
    format!(
        "[model]\nphysics = \"poisson\"\ndimension = 3\nexact = {{ u = \"exp(0.5*x)*cos(y - 0.7*z)\" }}\n[[material]]\nname = \"m\"\n{}{}\
         [[boundary]]\non = [\"inner.v0\", \"outer.v1\"]\ndirichlet = \"exact\"\n\
         [[boundary]]\non = [\"inner.u0\", \"inner.u1\", \"inner.w0\", \"inner.w1\", \"outer.u0\", \"outer.u1\", \"outer.w0\", \"outer.w1\"]\n\
         neumann = \"exact\"\n\
         [[interface]]\nname = \"seam\"\nslave = \"inner.v1\"\nmaster = \"outer.v0\"\nmultiplier = \"{multiplier}\"\n",
        patch("inner", kinds[0], "[1, 1.5]", "[3, 1, 2]"),
        patch("outer", kinds[1], "[1.5, 2]", "[2, 1, 3]"),
    )
}

/// The errors by which convergence is judged.
const ERRORS: [&str; 3] = ["error.u.L2", "error.u.H1", "error.seam.lambda.L2"];

/// The orders of the errors from a level to the next.
fn orders(text: &str, first: usize) -> [f64; 3] {
    let errors = [first, first + 1].map(|level| {
        let sets = [format!("patch.inner.refine={level}"), format!("patch.outer.refine={level}")];
        let result = run(text, &[&sets[0], &sets[1]]);
        ERRORS.map(|name| error(&result, name))
    });
    std::array::from_fn(|k| (errors[0][k] / errors[1][k]).log2())
}

#[test]
fn u_converges_with_its_order_and_lambda_half_an_order_below_its_gradient() {
    for degree in [1, 2] {
        // tetrahedra of degree 1 alone: there are six for every hexahedron
        let pairs = [[KINDS[1], KINDS[2]], [KINDS[2], KINDS[1]], [KINDS[3], KINDS[1]]];
        for kinds in pairs.into_iter().take(4 - degree) {
            let (found, p) = (orders(&pipe(kinds, degree, "p/p"), degree), degree as f64);
            let least = [p + 1.0, p, p - 0.5];
            assert!(found.iter().zip(least).all(|(order, least)| *order > least - 0.2), "{kinds:?} {degree}: {found:?}");
        }
    }
}
