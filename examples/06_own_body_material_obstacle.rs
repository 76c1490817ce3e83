//! Lesson 6: a body, a material and an obstacle from outside. `cargo run --release --example 06_own_body_material_obstacle`
//!
//! An orthotropic arch, clamped at both ends, is pressed by a rigid bar from above. Its map is polar coordinates, its functions are
//! B-splines.

use faying::assembly::contract;
use faying::basis::{BSpline, Cell, Elements, Order, TensorProduct};
use faying::check;
use faying::contact::{Hit, Obstacle};
use faying::geometry::{Bounds, Embedding, Geometry, MapTable};
use faying::linalg::{Matrix, Vector};
use faying::physics::{Material, Response};
use faying::problem::{Components, Problem};
use faying::space::{Body, FunctionSpace, SideError, Space, Trace};
use std::f64::consts::PI;
use std::sync::Arc;

/// x = (1 + v) (cos pi u, sin pi u) on n x m elements of the unit square.
#[derive(Clone, Copy, Debug)]
pub struct Polar {
    /// Elements along u and v.
    pub elements: [usize; 2],
}

impl Elements for Polar {
    fn num_elements(&self) -> usize {
        self.elements[0] * self.elements[1]
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        let n = self.elements[0];
        let first = element / n * (n + 1) + element % n;
        ids.clear();
        ids.extend([first, first + 1, first + n + 1, first + n + 2]);
    }
}

impl Geometry<2, 2> for Polar {
    fn map(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut MapTable<2, 2>) {
        let [n, m] = self.elements;
        // d phi / d xi_0 and d rho / d xi_1
        let (turn, rise) = (PI / n as f64, 1.0 / m as f64);
        table.reset(xi.len(), order);
        for (q, xi) in xi.iter().enumerate() {
            let (phi, rho) = (turn * ((element % n) as f64 + xi[0]), 1.0 + rise * ((element / n) as f64 + xi[1]));
            let (out, along) = (Vector::<2>::new(phi.cos(), phi.sin()), Vector::<2>::new(-phi.sin(), phi.cos()));
            table.x[q] = out * rho;
            if order >= Order::Gradients {
                table.jacobian[q] = Matrix::<2, 2>::from_columns(&[along * (rho * turn), out * rise]);
            }
            if order >= Order::Hessians {
                for i in 0..2 {
                    let mixed = along[i] * turn * rise;
                    table.hessian[q][i] = Matrix::<2, 2>::new(-out[i] * rho * turn * turn, mixed, mixed, 0.0);
                }
            }
        }
    }
    fn bounds(&self, element: usize) -> Bounds<2> {
        let [n, m] = self.elements;
        let turn = PI / n as f64;
        let [inner, outer] = [0, 1].map(|k| 1.0 + (element / n + k) as f64 / m as f64);
        // the arc lies within the triangle of its ends and of the corner of its tangents
        let phi = turn * (element % n) as f64;
        let at = |r: f64, phi: f64| Vector::<2>::new(r * phi.cos(), r * phi.sin());
        let tip = at(outer / (0.5 * turn).cos(), phi + 0.5 * turn);
        let corners = [at(inner, phi), at(inner, phi + turn), at(outer, phi), at(outer, phi + turn), tip];
        Bounds::around(&corners).expect("five points")
    }
}

/// Half a ring of splines between radii 1 and 2.
#[derive(Debug)]
pub struct Arch {
    elements: [usize; 2],
    space: Arc<dyn Space<2, 2>>,
}

impl Arch {
    /// With quadratic splines on n x m elements.
    pub fn new(elements: [usize; 2]) -> Self {
        let basis = TensorProduct::new(elements.map(|n| BSpline::uniform(2, n, 1)));
        Self { elements, space: Arc::new(FunctionSpace { basis, geometry: Polar { elements } }) }
    }
}

impl Body<1, 2> for Arch {
    fn space(&self) -> &Arc<dyn Space<2, 2>> {
        &self.space
    }
    fn sides(&self) -> Vec<String> {
        ["right", "left", "inner", "outer"].map(String::from).to_vec()
    }
    fn trace(&self, side: &str) -> Result<Trace<1, 2>, SideError> {
        let [n, m] = self.elements;
        let unknown = || SideError::Unknown { side: side.into(), known: self.sides().join(", ") };
        let number = self.sides().iter().position(|known| known == side).ok_or_else(unknown)?;
        let (axis, end) = (number / 2, number % 2);
        // facets along the other axis, at the lower or the upper end of their elements
        let element = |k: usize| if axis == 0 { k * n + end * (n - 1) } else { end * n * (m - 1) + k };
        let facet = |k: usize| {
            let (mut origin, mut axes) = (Vector::<2>::zeros(), Matrix::<2, 1>::zeros());
            (origin[axis], axes[1 - axis]) = (end as f64, 1.0);
            Embedding { element: element(k), origin, axes }
        };
        Trace::from_facets(&self.space, (0..[m, n][axis]).map(facet).collect(), Cell::Tensor)
    }
}

/// Plane stress of a material with axes along x and y:
/// sigma_xx = c11 e_xx + c12 e_yy, sigma_yy = c12 e_xx + c22 e_yy, sigma_xy = 2 g e_xy.
#[derive(Clone, Debug)]
pub struct Orthotropic {
    /// Stiffness along x [force/area].
    pub c11: f64,
    /// Stiffness along y [force/area].
    pub c22: f64,
    /// Coupling of both [force/area].
    pub c12: f64,
    /// Shear modulus [force/area].
    pub g: f64,
}

impl Material<2, 2> for Orthotropic {
    fn respond(&self, _x: &Vector<2>, grad_u: &Matrix<2, 2>) -> Response<2, 2> {
        let Self { c11, c22, c12, g } = *self;
        let shear = Matrix::<2, 2>::new(0.0, g, g, 0.0);
        // tangent[i][j] = d sigma / d (du_i/dx_j)
        let tangent = [[Matrix::<2, 2>::new(c11, 0.0, 0.0, c12), shear], [shear, Matrix::<2, 2>::new(c12, 0.0, 0.0, c22)]];
        Response { stress: contract(&tangent, grad_u), tangent }
    }
    fn modulus(&self, _x: &Vector<2>) -> f64 {
        self.c11.max(self.c22)
    }
    fn is_linear(&self) -> bool {
        true
    }
    fn is_homogeneous(&self) -> bool {
        true
    }
}

/// A bar with round ends: the points within `radius` of the segment from `a` to `b`.
#[derive(Clone, Debug)]
pub struct Bar {
    /// Begin of the axis.
    pub a: Vector<2>,
    /// End of the axis.
    pub b: Vector<2>,
    /// Radius [length].
    pub radius: f64,
}

impl Obstacle<1, 2> for Bar {
    fn project(&self, x: &Vector<2>, _outward: &Vector<2>) -> Option<Hit<1, 2>> {
        let axis = self.b - self.a;
        let s = ((x - self.a).dot(&axis) / axis.norm_squared()).clamp(0.0, 1.0);
        let foot = self.a + axis * s;
        let distance = (x - foot).norm();
        if distance == 0.0 {
            return None;
        } // a point of the axis has no closest point
        let normal = (x - foot) / distance;
        Some(Hit { x: foot + normal * self.radius, normal, gap: distance - self.radius, at: None })
    }
}

/// The arch under a bar that has moved down by 0.01: forces of the bar and of both supports.
pub fn pressed(wood: Orthotropic, bar: Bar) -> Result<[[f64; 2]; 2], Box<dyn std::error::Error>> {
    let mut p = Problem::<1, 2>::new();
    let arch = p.body("arch", Arch::new([32, 8]), wood)?;
    for end in ["left", "right"] {
        p.fix(arch.side(end), Components::All)?;
    }
    let bar = p.contact(arch.side("outer"), bar)?.moved(1, -0.01).id();
    let solution = p.assemble()?.solve(1.0, None)?;
    let contact = solution.contact(bar)?;
    assert!(contact.force[1] < 0.0 && contact.least_gap > -1e-12);
    let [left, right] = [solution.reaction(arch.side("left"))?, solution.reaction(arch.side("right"))?];
    Ok([[contact.force[0], contact.force[1]], [left[0] + right[0], left[1] + right[1]]])
}

/// Checks body, material and obstacle, and solves a problem with them: forces balance.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wood = Orthotropic { c11: 12.0, c22: 1.0, c12: 0.4, g: 0.7 };
    let bar = Bar { a: Vector::from([-0.2, 2.1]), b: Vector::from([0.2, 2.1]), radius: 0.1 };
    check::body(&Arch::new([5, 3]))?;
    check::material(&wood, &[Vector::from([0.0, 0.0]), Vector::from([0.2, 0.7])], 1e-3)?;
    check::obstacle(&bar, &[Vector::from([0.1, 1.8]), Vector::from([0.5, 1.7])], 1e-12)?;
    let [[x, y], [support_x, support_y]] = pressed(wood, bar)?;
    println!("force of the bar {y:.6} upwards, of the supports {support_y:.6}");
    assert!((y + support_y).abs() < 1e-12 && (x + support_x).abs() < 1e-12);
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
