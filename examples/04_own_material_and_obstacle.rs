//! Lesson 4: a material and an obstacle from outside. `cargo run --release --example 04_own_material_and_obstacle`
//!
//! An orthotropic block, clamped at its top, is pressed by a rigid bar from below.

use faying::assembly::contract;
use faying::check;
use faying::contact::{Hit, Obstacle};
use faying::geometry::shapes::rectangle;
use faying::linalg::{Matrix, Vector};
use faying::physics::{Material, Response};
use faying::problem::{Components, Problem};
use faying::space::{Patch, PatchSpec};

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

/// The block between its support and the bar, which has moved up by 0.01.
pub fn pressed(wood: Orthotropic, bar: Bar) -> Result<[f64; 4], Box<dyn std::error::Error>> {
    let mut p = Problem::<1, 2>::new();
    let block = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0])?).with_elements([16, 8]);
    let block = p.body("block", Patch::try_new(&block)?, wood)?;
    p.fix(block.side("v1"), Components::All)?;
    let bar = p.contact(block.side("v0"), bar)?.moved(1, 0.01).id();
    let solution = p.assemble()?.solve(1.0, None)?;
    let (contact, support) = (solution.contact(bar)?, solution.reaction(block.side("v1"))?);
    assert!(contact.force[1] > 0.0 && contact.least_gap > -1e-12);
    Ok([contact.force[0], contact.force[1], support[0], support[1]])
}

/// Checks the material and the obstacle, and solves a problem with them: forces balance.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wood = Orthotropic { c11: 12.0, c22: 1.0, c12: 0.4, g: 0.7 };
    let bar = Bar { a: Vector::from([0.3, -0.1]), b: Vector::from([0.7, -0.1]), radius: 0.1 };
    check::material(&wood, &[Vector::from([0.0, 0.0]), Vector::from([0.2, 0.7])], 1e-3)?;
    check::obstacle(&bar, &[Vector::from([0.1, 0.2]), Vector::from([0.5, 0.3])], 1e-12)?;
    let [x, y, support_x, support_y] = pressed(wood, bar)?;
    println!("force of the bar {y:.6} upwards, of the support {support_y:.6}");
    assert!((y + support_y).abs() < 1e-12 && (x + support_x).abs() < 1e-12);
    Ok(())
}
