//! Bodies in space tied across grids that do not match: linear fields are exact, and a wrong partner would change them by percents.

use crate::bodies::{KINDS, Kind, steel, turns};
use faying::coupling::Nitsche;
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::nitsche::Variant;
use faying::linalg::{Matrix, Vector};
use faying::problem::{BodyId, Derivatives, Exact, Integration, Point, Problem, Solution, TieId, Value};

/// u = G x.
#[derive(Clone, Copy, Debug)]
pub struct Linear(pub Matrix<3, 3>);

impl Exact for Linear {
    fn value(&self, component: usize, at: &Point) -> f64 {
        (self.0 * Vector::<3>::from(at.x))[component]
    }
    fn slope(&self, component: usize, at: &Point) -> Derivatives {
        let gradient = [self.0[(component, 0)], self.0[(component, 1)], self.0[(component, 2)]];
        Derivatives { value: self.value(component, at), gradient, ..Derivatives::default() }
    }
    fn derivatives(&self, component: usize, at: &Point) -> Derivatives {
        self.slope(component, at)
    }
    fn depends_on_time(&self) -> bool {
        false
    }
}

/// Two kinds of bodies; the upper one is the slave unless `swapped`.
#[derive(Clone, Copy, Debug)]
struct Pair {
    kinds: [Kind; 2],
    swapped: bool,
    nitsche: bool,
    rule: Integration,
    dual: bool,
}

impl Pair {
    fn all() -> impl Iterator<Item = Self> {
        let pairs = KINDS.into_iter().flat_map(|a| KINDS.into_iter().map(move |b| [a, b]));
        pairs.flat_map(|kinds| {
            [false, true].map(|nitsche| Self { kinds, swapped: nitsche, nitsche, rule: Integration::Merged, dual: false })
        })
    }

    fn tie(&self, p: &mut Problem<2, 3>, [lower, upper]: [BodyId; 2]) -> TieId {
        let (slave, master) = (upper.side("w0"), lower.side("w1"));
        let (slave, master) = if self.swapped { (master, slave) } else { (slave, master) };
        let tie = p.tie(slave, master).unwrap().rule(self.rule);
        if self.dual {
            tie.multiplier(MultiplierKind::Dual);
        }
        if self.nitsche {
            tie.coupling(Nitsche { factor: Nitsche::AUTO, variant: Variant::Symmetric });
        }
        tie.extra_points(self.kinds.into_iter().map(Kind::extra_points).max().unwrap()).id()
    }

    /// Largest relative error of displacements and stresses in the middle and in corners of both bodies.
    fn error(&self, solution: &Solution<2, 3>, exact: &Linear, bodies: &[(BodyId, Vec<Vector<3>>); 2]) -> f64 {
        let strain = (exact.0 + exact.0.transpose()) * 0.5;
        let (young, poisson) = (1.0, 0.3);
        let (mu, lambda) = (young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
        let stress = strain * (2.0 * mu) + Matrix::<3, 3>::identity() * (lambda * strain.trace());
        let mut worst = 0.0_f64;
        for (body, points) in bodies {
            for x in points {
                let at = solution.at(*body, &(*x).into()).unwrap();
                worst = worst.max((Vector::<3>::from(at.u) - exact.0 * x).norm());
                for (i, row) in [[0, 3, 5], [3, 1, 4], [5, 4, 2]].iter().enumerate() {
                    row.iter().enumerate().for_each(|(j, &place)| worst = worst.max((at.stress[place] - stress[(i, j)]).abs()));
                }
            }
        }
        worst
    }
}

#[test]
fn linear_fields_of_stacked_boxes_are_exact_for_all_pairs_of_cells() {
    stacked_boxes(&[1, 2, 3], &Pair::all().collect::<Vec<_>>());
}

/// Constant multipliers are integrated exactly by the points of either side, where neither is rational.
#[test]
fn mixed_integration_keeps_linear_fields() {
    let polynomial = |pair: &Pair| !pair.nitsche && !pair.kinds.contains(&Kind::Nurbs);
    let pairs =
        Pair::all().filter(polynomial).flat_map(|pair| [false, true].map(|swapped| Pair { swapped, rule: Integration::Mixed, ..pair }));
    stacked_boxes(&[1, 2, 3], &pairs.collect::<Vec<_>>());
}

/// On all tensor cells, and on triangles of degree 1.
#[test]
fn dual_multipliers_keep_linear_fields() {
    let dual = || Pair::all().filter(|pair| !pair.nitsche).map(|pair| Pair { dual: true, ..pair });
    stacked_boxes(&[1], &dual().collect::<Vec<_>>());
    stacked_boxes(&[2], &dual().filter(|pair| pair.kinds[1] != Kind::Tetrahedra).collect::<Vec<_>>());
}

/// Stacked boxes under a linear displacement that is prescribed on all outer sides, the interface oblique in space.
fn stacked_boxes(degrees: &[usize], pairs: &[Pair]) {
    let gradient = Matrix::<3, 3>::new(0.3, -0.2, 0.5, 0.1, -0.4, 0.2, -0.6, 0.3, 0.7);
    let exact = Linear(gradient);
    for &degree in degrees {
        // the dearest ones in one direction only
        let turns = if degree == 2 { turns().to_vec() } else { vec![turns()[1]] };
        for (k, pair) in pairs.iter().enumerate() {
            let turn = &turns[k % turns.len()];
            let elements = if degree == 3 { [[2, 1, 1], [1, 2, 1]] } else { [[3, 2, 1], [2, 3, 1]] };
            let mut p = Problem::<2, 3>::new();
            p.exact(exact);
            let boxes = [([0.0, 0.0, -0.5], [1.0, 0.8, 0.0]), ([0.0, 0.0, 0.0], [1.0, 0.8, 0.6])];
            let bodies: [BodyId; 2] = std::array::from_fn(|b| {
                let body = pair.kinds[b].turned_box(boxes[b], turn, degree, elements[b]);
                pair.kinds[b].add(&mut p, ["lower", "upper"][b], body, steel())
            });
            for (body, outer) in bodies.iter().zip(["w0", "w1"]) {
                for side in ["u0", "u1", "v0", "v1", outer] {
                    for c in 0..3 {
                        p.prescribe(body.side(side), c, Value::Exact).unwrap();
                    }
                }
            }
            pair.tie(&mut p, bodies);
            let mut system = p.assemble().unwrap_or_else(|e| panic!("{pair:?}, degree {degree}: {e}"));
            let solution = system.solve(0.0, None).unwrap_or_else(|e| panic!("{pair:?}, degree {degree}: {e}"));
            let points = |z: [f64; 3]| -> Vec<Vector<3>> {
                let inner = [[0.5, 0.4, z[1]], [0.1, 0.7, z[0]], [0.83, 0.13, z[2]]];
                inner.iter().map(|x| turn * Vector::<3>::from(*x)).collect()
            };
            let all = [(bodies[0], points([-0.01, -0.25, -0.4])), (bodies[1], points([0.02, 0.3, 0.5]))];
            let error = pair.error(&solution, &exact, &all);
            assert!(error < 1e-9, "{pair:?}, degree {degree}: {error:e}");
        }
    }
}

/// A small box on a large one, its grid turned by 0, 17 and 45 degrees: a stretch along the interface, without tractions across it; the upper
/// box is held by the tie alone.
#[test]
fn grids_turned_against_each_other_keep_linear_fields() {
    let (poisson, [a, b, c]) = (0.3, [0.4, -0.15, 0.25]);
    let through = -poisson / (1.0 - poisson) * (a + b);
    let exact = Linear(Matrix::<3, 3>::new(a, c + 0.1, -0.2, c - 0.1, b, 0.3, 0.2, -0.3, through));
    for (k, degrees) in [0.0_f64, 17.0, 45.0].into_iter().enumerate() {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turn = Matrix::<3, 3>::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        for degree in [1, 2] {
            for (number, pair) in Pair::all().map(|pair| Pair { swapped: false, ..pair }).enumerate() {
                // every pair at one of the angles, all of degree 1 at each
                if degree == 2 && number % 3 != k {
                    continue;
                }
                let mut p = Problem::<2, 3>::new();
                p.exact(exact);
                let lower = pair.kinds[0].turned_box(([-1.0, -1.0, -0.5], [1.0, 1.0, 0.0]), &Matrix::identity(), degree, [4, 5, 1]);
                let upper = pair.kinds[1].turned_box(([-0.5, -0.6, 0.0], [0.6, 0.5, 0.4]), &turn, degree, [3, 2, 1]);
                let lower = pair.kinds[0].add(&mut p, "lower", lower, steel());
                let upper = pair.kinds[1].add(&mut p, "upper", upper, steel());
                for c in 0..3 {
                    ["u0", "u1", "v0", "v1", "w0"].iter().for_each(|side| {
                        p.prescribe(lower.side(side), c, Value::Exact).unwrap();
                    });
                    ["u0", "u1", "v0", "v1", "w1"].iter().for_each(|side| {
                        p.traction(upper.side(side), c, Value::Exact).unwrap();
                    });
                }
                pair.tie(&mut p, [lower, upper]);
                let mut system = p.assemble().unwrap_or_else(|e| panic!("{pair:?}, degree {degree}: {e}"));
                let solution = system.solve(0.0, None).unwrap_or_else(|e| panic!("{pair:?}, degree {degree}: {e}"));
                let lower_points = vec![Vector::<3>::new(0.1, 0.2, -0.01), Vector::<3>::new(-0.9, 0.8, -0.3)];
                let upper_points = vec![turn * Vector::<3>::new(0.1, 0.2, 0.01), turn * Vector::<3>::new(-0.4, 0.4, 0.35)];
                let error = pair.error(&solution, &exact, &[(lower, lower_points), (upper, upper_points)]);
                assert!(error < 1e-9, "{pair:?}, degree {degree} at {degrees}: {error:e}");
            }
        }
    }
}
