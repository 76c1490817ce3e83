//! Manufactured solutions: value, gradient, flux and source of an `exact` field, by jets of its formulas.
//!
//!   Poisson     f = -div(k grad u)          = -(grad k . grad u + k lap u)
//!   elasticity  f_i = -d_j sigma_ij,  sigma_ij = l div u delta_ij + m (u_i,j + u_j,i)

use crate::io::case::{Assumption, Elastic, Material};
use crate::io::formula::{Formula, Jet, Point};
use crate::io::place::Located;
use crate::linalg::{Matrix, Vector};

/// A coefficient with its gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficient {
    /// Value.
    pub value: f64,
    /// Derivatives in x, y, z.
    pub gradient: [f64; 3],
}

impl Coefficient {
    fn of(jet: &Jet) -> Self {
        Self { value: jet.value, gradient: jet.gradient }
    }

    /// f(a, b) with derivatives fa and fb.
    fn chain(value: f64, a: &Self, fa: f64, b: &Self, fb: f64) -> Self {
        Self { value, gradient: std::array::from_fn(|k| fa * a.gradient[k] + fb * b.gradient[k]) }
    }
}

/// Constants of a material as functions of place.
#[derive(Clone, Debug)]
pub enum Law {
    /// Conductivity k.
    Conductor(Formula),
    /// Young's modulus and Poisson's ratio.
    Young {
        /// E [force/area].
        young: Formula,
        /// nu.
        poisson: Formula,
        /// Whether stress out of the plane vanishes.
        plane_stress: bool,
    },
    /// Lame's constants.
    Lame {
        /// lambda [force/area].
        lambda: Formula,
        /// mu [force/area].
        mu: Formula,
        /// Whether stress out of the plane vanishes.
        plane_stress: bool,
    },
}

impl Law {
    /// The constants of `material`; `assumption` matters in the plane alone.
    pub fn of(material: &Material, dimension: usize, assumption: Assumption) -> Self {
        let plane_stress = dimension == 2 && assumption == Assumption::PlaneStress;
        match &material.elastic {
            None => Self::Conductor(material.conductivity.value.clone()),
            Some(Elastic::YoungPoisson(e, nu)) => Self::Young { young: e.value.clone(), poisson: nu.value.clone(), plane_stress },
            Some(Elastic::Lame(l, m)) => Self::Lame { lambda: l.value.clone(), mu: m.value.clone(), plane_stress },
        }
    }

    /// Whether the constants are the same everywhere.
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Conductor(k) => k.as_constant().is_some(),
            Self::Young { young: a, poisson: b, .. } | Self::Lame { lambda: a, mu: b, .. } => a.as_constant().is_some() && b.as_constant().is_some(),
        }
    }

    /// Conductivity at a point; zero of an elastic law.
    pub fn conductivity(&self, at: &Point) -> Coefficient {
        match self {
            Self::Conductor(k) => Coefficient::of(&k.jet(at)),
            _ => Coefficient::default(),
        }
    }

    /// (lambda, mu) of sigma = lambda tr(eps) I + 2 mu eps within the body's dimension; zero of a conductor.
    pub fn lame(&self, at: &Point) -> (Coefficient, Coefficient) {
        match self {
            Self::Conductor(_) => Default::default(),
            Self::Young { young, poisson, plane_stress } => {
                let (e, nu) = (Coefficient::of(&young.jet(at)), Coefficient::of(&poisson.jet(at)));
                let v = nu.value;
                let (g, dg) = if *plane_stress {
                    (v / (1.0 - v * v), (1.0 + v * v) / (1.0 - v * v).powi(2))
                } else {
                    let d = (1.0 + v) * (1.0 - 2.0 * v);
                    (v / d, (1.0 + 2.0 * v * v) / (d * d))
                };
                let h = 0.5 / (1.0 + v);
                let dh = -0.5 / (1.0 + v).powi(2);
                (Coefficient::chain(e.value * g, &e, g, &nu, e.value * dg), Coefficient::chain(e.value * h, &e, h, &nu, e.value * dh))
            }
            Self::Lame { lambda, mu, plane_stress } => {
                let (l, m) = (Coefficient::of(&lambda.jet(at)), Coefficient::of(&mu.jet(at)));
                if !plane_stress {
                    return (l, m);
                }
                let s = l.value + 2.0 * m.value;
                let value = 2.0 * l.value * m.value / s;
                (Coefficient::chain(value, &l, 4.0 * m.value * m.value / (s * s), &m, 2.0 * l.value * l.value / (s * s)), m)
            }
        }
    }

    /// nu of the spatial material at a point, for the stress out of the plane; zero in plane stress.
    pub fn out_of_plane(&self, at: &Point) -> f64 {
        match self {
            Self::Young { plane_stress: false, poisson, .. } => poisson.value(at),
            Self::Lame { plane_stress: false, lambda, mu } => {
                let (l, m) = (lambda.value(at), mu.value(at));
                l / (2.0 * (l + m))
            }
            _ => 0.0,
        }
    }
}

/// An exact solution, one formula per component.
#[derive(Clone, Debug)]
pub struct Exact {
    components: Vec<Formula>,
}

impl Exact {
    /// The solution of the case.
    pub fn of(formulas: &[Located<Formula>]) -> Self {
        Self { components: formulas.iter().map(|f| f.value.clone()).collect() }
    }

    /// u_c.
    pub fn value(&self, component: usize, at: &Point) -> f64 {
        self.components[component].value(at)
    }

    /// u and grad u for C components in N dimensions.
    pub fn field<const C: usize, const N: usize>(&self, at: &Point) -> (Vector<C>, Matrix<C, N>) {
        let jets: Vec<Jet> = self.components.iter().map(|f| f.jet(at)).collect();
        (Vector::from_fn(|i, _| jets[i].value), Matrix::from_fn(|i, j| jets[i].gradient[j]))
    }

    /// Component `i` of sigma n, or k du/dn.
    pub fn flux<const N: usize>(&self, law: &Law, at: &Point, normal: &Vector<N>, i: usize) -> f64 {
        let jets: Vec<Jet> = self.components.iter().map(|f| f.jet(at)).collect();
        if let Law::Conductor(k) = law {
            return k.value(at) * (0..N).map(|j| jets[0].gradient[j] * normal[j]).sum::<f64>();
        }
        let (l, m) = law.lame(at);
        let div: f64 = (0..N).map(|k| jets[k].gradient[k]).sum();
        l.value * div * normal[i] + m.value * (0..N).map(|j| (jets[i].gradient[j] + jets[j].gradient[i]) * normal[j]).sum::<f64>()
    }

    /// Component `i` of the source that makes the field a solution in N dimensions.
    pub fn source<const N: usize>(&self, law: &Law, at: &Point, i: usize) -> f64 {
        let jets: Vec<Jet> = self.components.iter().map(|f| f.jet(at)).collect();
        if let Law::Conductor(_) = law {
            let k = law.conductivity(at);
            return -(0..N).map(|j| k.gradient[j] * jets[0].gradient[j] + k.value * jets[0].hessian[j][j]).sum::<f64>();
        }
        let (l, m) = law.lame(at);
        let div: f64 = (0..N).map(|k| jets[k].gradient[k]).sum();
        let mut sum = l.gradient[i] * div;
        for j in 0..N {
            sum += l.value * jets[j].hessian[j][i];
            sum += m.gradient[j] * (jets[i].gradient[j] + jets[j].gradient[i]);
            sum += m.value * (jets[i].hessian[j][j] + jets[j].hessian[i][j]);
        }
        -sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::formula::{Constants, Scope};

    fn formula(text: &str) -> Formula {
        Formula::parse(text, &Scope::space(&Constants::default())).unwrap()
    }

    /// -d_j sigma_ij by central differences of the flux in the directions of the axes.
    fn difference(exact: &Exact, law: &Law, x: [f64; 2], i: usize) -> f64 {
        let h = 1e-5;
        (0..2)
            .map(|j| {
                let n = Vector::<2>::from_fn(|k, _| f64::from(u8::from(k == j)));
                let at = |s: f64| {
                    let mut y = x;
                    y[j] += s;
                    exact.flux(law, &Point::new(&y), &n, i)
                };
                -(at(h) - at(-h)) / (2.0 * h)
            })
            .sum()
    }

    #[test]
    fn sources_are_minus_the_divergence_of_the_flux() {
        let scalar = Exact { components: vec![formula("sin(2*x)*exp(y)")] };
        let conductor = Law::Conductor(formula("1 + x*y"));
        let vector = Exact { components: vec![formula("x^2*y - y^3"), formula("sin(x)*cos(2*y)")] };
        let laws = [
            Law::Young { young: formula("1 + x"), poisson: formula("0.2 + 0.1*y"), plane_stress: false },
            Law::Young { young: formula("1 + x"), poisson: formula("0.2 + 0.1*y"), plane_stress: true },
            Law::Lame { lambda: formula("2 + x*y"), mu: formula("1 + y"), plane_stress: false },
            Law::Lame { lambda: formula("2 + x*y"), mu: formula("1 + y"), plane_stress: true },
        ];
        for x in [[0.3, 0.4], [-0.2, 0.7]] {
            let at = Point::new(&x);
            assert!((scalar.source::<2>(&conductor, &at, 0) - difference(&scalar, &conductor, x, 0)).abs() < 1e-8);
            for law in &laws {
                for i in 0..2 {
                    let (found, expected) = (vector.source::<2>(law, &at, i), difference(&vector, law, x, i));
                    assert!((found - expected).abs() < 1e-7, "{law:?} {i}: {found} {expected}");
                }
            }
        }
    }
}
