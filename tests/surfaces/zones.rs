//! Zones of contact that are a part of the side: conditions of contact and first guesses, on an obstacle and between two bodies.

use crate::bodies::{KINDS, Kind, steel, turns};
use faying::basis::BSpline;
use faying::contact::{Cone, Lagrange, Sphere};
use faying::coupling::multiplier::MultiplierKind;
use faying::geometry::ControlNet;
use faying::linalg::{Matrix, Vector};
use faying::physics::Hooke;
use faying::problem::{Components, ContactId, Problem, Solution, Start};
use faying::space::PatchSpec;

/// A block pressed on a ball from above by its top, which is held: the middle of its bottom touches.
fn on_a_ball(kind: Kind, degree: usize, cone: Cone, multiplier: MultiplierKind, start: Start) -> (Solution<2, 3>, ContactId) {
    let block = kind.turned_box(([0.0; 3], [1.0, 1.0, 0.5]), &Matrix::identity(), degree, [6, 5, 2]);
    let mut p = Problem::<2, 3>::new();
    let block = kind.add(&mut p, "block", block, steel());
    p.fix(block.side("w1"), Components::One(0)).unwrap();
    p.fix(block.side("w1"), Components::One(1)).unwrap();
    p.prescribe(block.side("w1"), 2, -0.02).unwrap();
    let ball = Sphere::<3> { center: Vector::<3>::new(0.42, 0.55, -2.0), radius: 2.0, inside: false };
    let contact = p.contact(block.side("w0"), ball).unwrap().method(Lagrange).cone(cone).multiplier(multiplier).start(start).id();
    let mut system = p.assemble().unwrap();
    (system.solve(0.0, None).unwrap(), contact)
}

/// Whether each function of the multiplier is closed.
pub fn closed(solution: &Solution<2, 3>, contact: ContactId) -> Vec<bool> {
    solution.along(contact, 0).unwrap().unwrap().points().iter().map(|p| p.active).collect()
}

#[test]
fn the_conditions_of_contact_hold_and_no_first_guess_matters() {
    for kind in KINDS {
        for (degree, lowered) in [(1, 0), (2, 0), (2, if kind == Kind::Tetrahedra { 1 } else { 2 })] {
            for cone in [Cone::Coefficients, Cone::Weights] {
                let solve = |start| on_a_ball(kind, degree, cone, MultiplierKind::Lowered(lowered), start);
                let what = format!("{kind:?} {degree} p/p-{lowered} {cone:?}");
                let (solution, contact) = solve(Start::Auto);
                let (result, set) = (solution.contact(contact).unwrap(), closed(&solution, contact));
                let number = set.iter().filter(|c| **c).count();
                assert!(number > 0 && number < set.len() && number == result.active, "{what}: {number} of {}", set.len());
                let (worst, largest) = (result.violation, result.largest_pressure);
                assert!(worst.lambda <= 1e-12 * largest && worst.gap <= 1e-12 && worst.product <= 1e-12 * largest, "{what}: {worst:?}");
                assert!(Vector::<3>::from(solution.balance().force).norm() < 1e-12 * result.force.norm(), "{what}");
                for start in [Start::All, Start::None, Start::Seed(3), Start::Seed(17)] {
                    let (other, contact) = solve(start);
                    assert_eq!(closed(&other, contact), set, "{what} {start:?}");
                    let force = other.contact(contact).unwrap().force;
                    assert!((force - result.force).norm() < 1e-11 * result.force.norm(), "{what} {start:?}");
                }
            }
        }
    }
}

/// Two blocks, the upper one with the bottom z = ((x - 0.42)² + (y - 0.55)²) / 4, pushed down by its top into the middle of the lower one.
#[derive(Clone, Debug)]
struct Pushed {
    kinds: [Kind; 2],
    degree: usize,
    lowered: usize,
    cone: Cone,
    start: Start,
    /// Whether the lower body carries the multiplier.
    swapped: bool,
    turn: Matrix<3, 3>,
    /// Units of length, and of force per area.
    units: [f64; 2],
    /// Whether the axes of the lower and the upper body are v, w, u: those of their sides are exchanged.
    cycled: [bool; 2],
}

impl Pushed {
    fn new(kinds: [Kind; 2], degree: usize) -> Self {
        let (cone, start, turn) = (Cone::Coefficients, Start::Auto, Matrix::identity());
        Self { kinds, degree, lowered: 0, cone, start, swapped: false, turn, units: [1.0; 2], cycled: [false; 2] }
    }

    fn net(&self, upper: bool) -> ControlNet<3, 3> {
        let squares = |c: f64| [c * c, c * c - c, (1.0 - c).powi(2)];
        let (along_x, along_y) = (squares(0.42), squares(0.55));
        let point = |[i, j, k]: [usize; 3]| {
            let bottom = 0.25 * (along_x[i] + along_y[j]);
            let z = if upper { [bottom, 0.5][k] } else { [-0.5, 0.0][k] };
            self.turn * Vector::<3>::new(0.5 * i as f64, 0.5 * j as f64, z) * self.units[0]
        };
        let (bent, line) = (|| BSpline::<f64>::uniform(2, 1, 1), BSpline::uniform(1, 1, 0));
        let (axes, points): ([BSpline; 3], Vec<_>) = match self.cycled[usize::from(upper)] {
            true => ([bent(), line, bent()], (0..18).map(|q| point([q / 6, q % 3, q / 3 % 2])).collect()),
            false => ([bent(), bent(), line], (0..18).map(|q| point([q % 3, q / 3 % 3, q / 9])).collect()),
        };
        ControlNet::<3, 3>::try_new(axes, points, None).unwrap()
    }

    /// The side of a body below or above.
    fn side(&self, body: usize, up: bool) -> &'static str {
        [["w0", "w1"], ["v0", "v1"]][usize::from(self.cycled[body])][usize::from(up)]
    }

    fn solution(&self) -> (Solution<2, 3>, ContactId) {
        let mut p = Problem::<2, 3>::new();
        let [lower, upper] = std::array::from_fn(|b| {
            let [n, m, k] = [[5, 4, 2], [4, 5, 2]][b];
            let elements = if self.cycled[b] { [m, k, n] } else { [n, m, k] };
            let degree = self.degree.max(if self.kinds[b] == Kind::Spline || self.kinds[b] == Kind::Nurbs { 2 } else { 1 });
            let body = self.kinds[b].body(&PatchSpec::new(self.net(b == 1)).with_degree([degree; 3]).with_elements(elements));
            self.kinds[b].add(&mut p, ["lower", "upper"][b], body, Hooke::solid([1.0, 2.0][b] * self.units[1], 0.3).unwrap())
        });
        p.fix(lower.side(self.side(0, false)), Components::All).unwrap();
        let down = self.turn * Vector::<3>::new(0.0, 0.0, -0.02) * self.units[0];
        (0..3).for_each(|c| {
            p.prescribe(upper.side(self.side(1, true)), c, down[c]).unwrap();
        });
        let mut sides = [upper.side(self.side(1, false)), lower.side(self.side(0, true))];
        if self.swapped {
            sides.reverse();
        }
        let multiplier = MultiplierKind::Lowered(self.lowered);
        let contact = p.contact(sides[0], sides[1]).unwrap().method(Lagrange).cone(self.cone).multiplier(multiplier).start(self.start).id();
        let mut system = p.assemble().unwrap_or_else(|e| panic!("{self:?}: {e}"));
        (system.solve(0.0, None).unwrap_or_else(|e| panic!("{self:?}: {e}")), contact)
    }
}

#[test]
fn the_conditions_of_contact_of_two_bodies_hold_and_no_first_guess_matters() {
    for kinds in [[Kind::Spline, Kind::Hexahedra], [Kind::Tetrahedra, Kind::Spline], [Kind::Hexahedra, Kind::Tetrahedra], [Kind::Nurbs; 2]]
    {
        for (degree, lowered) in [(1, 0), (2, 0), (2, 1)] {
            for (cone, swapped) in [(Cone::Coefficients, false), (Cone::Coefficients, true), (Cone::Weights, false)] {
                let case = Pushed { lowered, cone, swapped, ..Pushed::new(kinds, degree) };
                let slave = kinds[usize::from(!swapped)];
                if lowered == 1 && slave != Kind::Tetrahedra {
                    continue;
                }
                let what = format!("{case:?}");
                let (solution, contact) = case.solution();
                let (result, set) = (solution.contact(contact).unwrap(), closed(&solution, contact));
                let number = set.iter().filter(|c| **c).count();
                assert!(number > 0 && number < set.len() && number == result.active, "{what}: {number} of {}", set.len());
                let (worst, largest) = (result.violation, result.largest_pressure);
                assert!(worst.lambda <= 1e-12 * largest && worst.gap <= 1e-12 && worst.product <= 1e-12 * largest, "{what}: {worst:?}");
                let force = result.force.norm();
                assert!(result.balance < 1e-12, "{what}: {:e}", result.balance);
                let net = solution.balance();
                let [net, moment] = [net.force, net.moment].map(|v| Vector::<3>::from(v).norm());
                assert!(net < 1e-12 * force && moment < 1e-12 * force, "{what}: {net:e} {moment:e} of {force:e}");
                for start in [Start::All, Start::None, Start::Seed(3), Start::Seed(17)] {
                    let (other, contact) = Pushed { start, ..case.clone() }.solution();
                    assert_eq!(closed(&other, contact), set, "{what} {start:?}");
                    let apart = (other.contact(contact).unwrap().force - result.force).norm();
                    assert!(apart < 1e-11 * force, "{what} {start:?}: {apart:e}");
                }
            }
        }
    }
}

/// The pressures of a case, those of another one in its units, and their forces.
fn assert_same(what: &str, case: &Pushed, other: &Pushed) {
    let [(a, of_a), (b, of_b)] = [case, other].map(Pushed::solution);
    let [x, y] = [a.contact(of_a).unwrap(), b.contact(of_b).unwrap()];
    assert_eq!(closed(&a, of_a), closed(&b, of_b), "{what}");
    let unit = other.units[1] / case.units[1];
    let pairs = a.multiplier(of_a).unwrap().into_iter().zip(b.multiplier(of_b).unwrap());
    let apart = pairs.map(|(a, b)| (a - b / unit).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-8 * x.largest_pressure, "{what}: {apart:e}");
    let unit = unit * (other.units[0] / case.units[0]).powi(2);
    let apart = (other.turn * case.turn.transpose() * x.force - y.force / unit).norm();
    assert!(apart < 1e-8 * x.force.norm(), "{what}: {apart:e}");
}

#[test]
fn turns_and_units_change_nothing_between_two_bodies() {
    for (kinds, degree) in
        [([Kind::Spline, Kind::Hexahedra], 2), ([Kind::Hexahedra, Kind::Tetrahedra], 1), ([Kind::Tetrahedra, Kind::Spline], 2)]
    {
        let case = Pushed::new(kinds, degree);
        for turn in turns() {
            assert_same(&format!("{kinds:?} turned"), &case, &Pushed { turn, ..case.clone() });
        }
        for units in [[1e-6, 1.0], [1e6, 1.0], [1e-3, 1e6], [1.0, 1e-6]] {
            assert_same(&format!("{kinds:?} in units {units:?}"), &case, &Pushed { units, ..case.clone() });
        }
    }
}

#[test]
fn two_bodies_in_contact_have_the_same_bits_at_any_number_of_threads() {
    for kinds in [[Kind::Spline, Kind::Hexahedra], [Kind::Hexahedra, Kind::Tetrahedra]] {
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let (solution, _) = Pushed::new(kinds, 2).solution();
                [solution.unknowns(), solution.multipliers()].concat().iter().map(|v| v.to_bits()).collect::<Vec<_>>()
            })
        };
        let one = of(1);
        assert!(!one.is_empty() && [2, 16].iter().all(|&threads| of(threads) == one), "{kinds:?}");
    }
}

#[test]
fn axes_of_the_sides_may_be_exchanged() {
    for kinds in [[Kind::Spline, Kind::Hexahedra], [Kind::Hexahedra, Kind::Nurbs]] {
        for swapped in [false, true] {
            let case = Pushed { swapped, ..Pushed::new(kinds, 2) };
            let of = |case: &Pushed| {
                let (solution, contact) = case.solution();
                solution.contact(contact).unwrap()
            };
            let plain = of(&case);
            for cycled in [[true, false], [false, true], [true, true]] {
                let (what, other) = (format!("{kinds:?} {swapped} {cycled:?}"), of(&Pushed { cycled, ..case.clone() }));
                assert_eq!(other.active, plain.active, "{what}");
                assert!((other.force - plain.force).norm() < 1e-8 * plain.force.norm(), "{what}: {:?} {:?}", other.force, plain.force);
                let moment = (Vector::<3>::from(other.moment) - Vector::<3>::from(plain.moment)).norm();
                assert!(moment < 1e-8 * plain.force.norm(), "{what}: {moment:e}");
                for (a, b) in [(other.largest_pressure, plain.largest_pressure), (other.least_pressure, plain.least_pressure)] {
                    assert!((a - b).abs() < 1e-8 * plain.largest_pressure, "{what}: {a} {b}");
                }
                assert!((other.area - plain.area).abs() < 1e-8 && (other.least_gap - plain.least_gap).abs() < 1e-8, "{what}");
            }
        }
    }
}
