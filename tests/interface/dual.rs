//! Dual multipliers: biorthogonality, partition of unity, constants, what they reproduce, and where there are none.

use crate::common::coupled;
use coupled::{Bodies, KINDS, Kind, weighted};
use faying::basis::{Basis, Order, ShapeTable};
use faying::check;
use faying::constraint::{Condensed, ConstraintSolver, Direct, RowKind};
use faying::coupling::interface::{MergedCurve, Tolerance};
use faying::coupling::multiplier::{Ends, MultiplierError, MultiplierKind, build, reproduction, side_ends};
use faying::coupling::{Coupling, Interface, InterfaceQuadrature, Mortar, Side};
use faying::geometry::shapes::{annulus_sector, rectangle};
use faying::geometry::{ControlNet, MapTable};
use faying::linalg::{Vector, measure};
use faying::physics::{Conductor, form};
use faying::quadrature::gauss_legendre;
use faying::space::{Mapping, PatchSpec, Space};
use nalgebra::DMatrix;
use std::sync::Arc;

type Curve = Arc<dyn Space<1, 2>>;

/// Breakpoints whose sizes grow by a factor of 50 from the first to the last element.
fn graded(n: usize) -> Vec<f64> {
    let sizes: Vec<f64> = (0..n).map(|k| 50f64.powf(k as f64 / (n.max(2) - 1) as f64)).collect();
    let total: f64 = sizes.iter().sum();
    let mut grid = vec![0.0];
    sizes.iter().for_each(|s| grid.push(grid.last().unwrap() + s / total));
    *grid.last_mut().unwrap() = 1.0;
    grid
}

/// The side v0 of a body of `kind` on the unit square or the side u along an arc, with equal or graded elements.
fn side(kind: Kind, degree: usize, elements: usize, curved: bool, grade: bool) -> Curve {
    let mut net: ControlNet<2, 2> =
        if curved { annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap() } else { rectangle([0.0, 0.0], [1.0, 1.0]).unwrap() };
    if kind == Kind::Nurbs && !curved {
        net = weighted(&net, degree.min(2));
    }
    let spec = PatchSpec::new(net).with_degree([degree; 2]);
    let spec = if grade { spec.with_breakpoints([graded(elements), vec![0.0, 1.0]]) } else { spec.with_elements([elements, 1]) };
    kind.body(&spec).trace(if curved { "v1" } else { "v0" }).unwrap().space
}

/// ∫ psi_j N_i ds over one element and ∫ |psi_j N_i| ds, a row per multiplier, and ∫ N_i ds; by a rule of its own.
fn products(space: &dyn Space<1, 2>, psi: &dyn Basis<1>, element: usize) -> ([DMatrix<f64>; 2], Vec<f64>) {
    let rule = gauss_legendre::<f64>(61);
    let (mut own, mut shapes, mut map) = (ShapeTable::new(), ShapeTable::new(), MapTable::new());
    psi.tabulate(element, &rule.points, Order::Values, &mut own);
    space.evaluate(element, &rule.points, Order::Gradients, &mut shapes, &mut map);
    let mut blocks = [0, 1].map(|_| DMatrix::zeros(own.num_functions(), shapes.num_functions()));
    let mut weights = vec![0.0; shapes.num_functions()];
    for (q, w) in rule.weights.iter().enumerate() {
        let ds = w * measure(&map.jacobian[q]);
        for (i, &n) in shapes.values(q).iter().enumerate() {
            weights[i] += ds * n;
            for (j, &p) in own.values(q).iter().enumerate() {
                blocks[0][(j, i)] += ds * p * n;
                blocks[1][(j, i)] += (ds * p * n).abs();
            }
        }
    }
    (blocks, weights)
}

fn degrees(kind: Kind) -> std::ops::RangeInclusive<usize> {
    1..=if kind == Kind::Triangle { 4 } else { 5 }
}

#[test]
fn dual_functions_are_biorthogonal_and_sum_to_one_on_all_sides_and_ends() {
    let (mut worst, mut sides) = (0.0f64, 0);
    for kind in KINDS {
        for degree in degrees(kind) {
            for (elements, curved, grade) in [(1, false, false), (5, false, false), (6, false, true), (4, true, false), (5, true, true)] {
                if curved && kind == Kind::Nurbs && degree < 2 {
                    continue; // an arc has degree two
                }
                let space = side(kind, degree, elements, curved, grade);
                let ends = side_ends(&*space);
                for constrained in [[false, false], [true, false], [false, true], [true, true]] {
                    let what = format!("{kind:?} of degree {degree}, {elements} elements, curved {curved}, ends {constrained:?}");
                    let gone = constrained.iter().filter(|&&c| c).count();
                    let psi = match build(&space, MultiplierKind::Dual, &constrained) {
                        Err(MultiplierError::NothingLeft { .. }) if elements == 1 && degree + 1 == gone => continue,
                        found => found.unwrap_or_else(|e| panic!("{what}: {e}")),
                    };
                    assert_eq!(psi.num_functions(), space.num_functions() - gone, "{what}");
                    check::basis(&*psi).unwrap_or_else(|e| panic!("{what}: {e}"));
                    check::partition_of_unity(&*psi).unwrap_or_else(|e| panic!("{what}: {e}"));
                    sides += 1;
                    let (mut ids, mut own) = (Vec::new(), Vec::new());
                    // the functions of the side behind the multipliers
                    let mut kept = vec![true; space.num_functions()];
                    for (end, _) in ends.iter().zip(constrained).filter(|(_, c)| *c) {
                        let mut table = ShapeTable::new();
                        space.active(end.element, &mut ids);
                        space.tabulate(end.element, &[Vector::<1>::new(end.at as f64)], Order::Values, &mut table);
                        let there: Vec<usize> = ids.iter().zip(table.values(0)).filter(|(_, v)| v.abs() > 1e-9).map(|(&i, _)| i).collect();
                        assert_eq!(there.len(), 1);
                        kept[there[0]] = false;
                    }
                    let function: Vec<usize> = (0..kept.len()).filter(|&i| kept[i]).collect();
                    for e in 0..space.num_elements() {
                        let ([block, sizes], weights) = products(&*space, &*psi, e);
                        space.active(e, &mut ids);
                        psi.active(e, &mut own);
                        // round-off counts against what is summed: dual functions of high degree cancel
                        let scale = sizes.amax();
                        for (j, &k) in own.iter().enumerate() {
                            for (i, &n) in ids.iter().enumerate().filter(|(_, n)| kept[**n]) {
                                let wanted = if function[k] == n { weights[i] } else { 0.0 };
                                worst = worst.max((block[(j, i)] - wanted).abs() / scale);
                            }
                        }
                    }
                    assert!(worst <= 1e-13, "{what}: {worst:e}");
                }
            }
        }
    }
    assert!(sides > 300, "{sides}");
    println!("biorthogonal to {worst:.1e} on {sides} sides");
}

/// (psi, w) / (|psi| |w|): the least over psi of the largest over w, both in L2.
fn inf_sup(space: &dyn Space<1, 2>, psi: &dyn Basis<1>, kept: &[usize]) -> f64 {
    let (n, m) = (kept.len(), psi.num_functions());
    let mut place = vec![None; space.num_functions()];
    kept.iter().enumerate().for_each(|(k, &i)| place[i] = Some(k));
    let (mut b, mut mass, mut own_mass) = (DMatrix::<f64>::zeros(m, n), DMatrix::zeros(n, n), DMatrix::zeros(m, m));
    let (mut ids, mut own) = (Vec::new(), Vec::new());
    let rule = gauss_legendre::<f64>(20);
    let (mut table, mut shapes, mut map) = (ShapeTable::new(), ShapeTable::new(), MapTable::new());
    for e in 0..space.num_elements() {
        space.active(e, &mut ids);
        psi.active(e, &mut own);
        psi.tabulate(e, &rule.points, Order::Values, &mut table);
        space.evaluate(e, &rule.points, Order::Gradients, &mut shapes, &mut map);
        for (q, w) in rule.weights.iter().enumerate() {
            let ds = w * measure(&map.jacobian[q]);
            for (j, &jj) in own.iter().enumerate() {
                for (k, &kk) in own.iter().enumerate() {
                    own_mass[(jj, kk)] += ds * table.values(q)[j] * table.values(q)[k];
                }
                for (i, &ii) in ids.iter().enumerate() {
                    if let Some(ii) = place[ii] {
                        b[(jj, ii)] += ds * table.values(q)[j] * shapes.values(q)[i];
                    }
                }
            }
            for (i, &ii) in ids.iter().enumerate() {
                for (k, &kk) in ids.iter().enumerate() {
                    if let (Some(ii), Some(kk)) = (place[ii], place[kk]) {
                        mass[(ii, kk)] += ds * shapes.values(q)[i] * shapes.values(q)[k];
                    }
                }
            }
        }
    }
    // beta^2 is the least eigenvalue of L^-1 B M^-1 B^T L^-T, L L^T the mass of the multipliers
    let l: DMatrix<f64> = own_mass.cholesky().unwrap().l();
    let s: DMatrix<f64> = &b * mass.cholesky().unwrap().solve(&b.transpose());
    let left: DMatrix<f64> = l.solve_lower_triangular(&s).unwrap();
    let both: DMatrix<f64> = l.solve_lower_triangular(&left.transpose()).unwrap();
    (both.clone() + both.transpose()).scale(0.5).symmetric_eigenvalues().min().sqrt()
}

// Benchmarks: "Linear biorthogonal basis: sqrt(3)/2". On n equal elements with free ends the cosines are eigenvectors:
// beta^2 = 3 / (4 - cos^2 theta), theta = k pi / n, least at theta = pi/2: for every even n.
#[test]
fn linear_dual_functions_have_the_inf_sup_constant_of_the_literature() {
    for kind in [Kind::Spline, Kind::Tensor, Kind::Triangle] {
        for n in [2, 8, 32] {
            let space = side(kind, 1, n, false, false);
            let psi = build(&space, MultiplierKind::Dual, &[]).unwrap();
            let all: Vec<usize> = (0..space.num_functions()).collect();
            let beta = inf_sup(&*space, &*psi, &all);
            assert!((beta - 3f64.sqrt() / 2.0).abs() < 1e-12, "{kind:?}, {n} elements: {beta}");
        }
    }
    // any degree: the same bound on all meshes, ends constrained or not; it falls with the degree
    for kind in [Kind::Spline, Kind::Tensor] {
        for degree in 1..=4 {
            for constrained in [false, true] {
                let betas: Vec<f64> = [8, 16, 32]
                    .iter()
                    .map(|&n| {
                        let space = side(kind, degree, n, false, false);
                        let psi = build(&space, MultiplierKind::Dual, &[constrained; 2]).unwrap();
                        let kept: Vec<usize> = (0..space.num_functions()).filter(|&i| !constrained || !is_at_end(&*space, i)).collect();
                        inf_sup(&*space, &*psi, &kept)
                    })
                    .collect();
                println!("{kind:?} {degree} {constrained}: {betas:?}");
                assert!(
                    betas[2] > 0.0 && (betas[1] / betas[2] - 1.0).abs() < 0.05,
                    "{kind:?} of degree {degree}, {constrained}: {betas:?}"
                );
            }
        }
    }
}

/// Whether function `i` does not vanish at an end of the side.
fn is_at_end(space: &dyn Space<1, 2>, i: usize) -> bool {
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    side_ends(space).iter().any(|end| {
        space.active(end.element, &mut ids);
        space.tabulate(end.element, &[Vector::<1>::new(end.at as f64)], Order::Values, &mut table);
        ids.iter().zip(table.values(0)).any(|(&k, v)| k == i && v.abs() > 1e-9)
    })
}

#[test]
fn the_order_of_reproduction_is_found_for_every_multiplier() {
    let found = |space: &Curve, kind: MultiplierKind, ends: &[bool]| reproduction(&**space, &*build(space, kind, ends).unwrap());
    for kind in KINDS {
        for degree in degrees(kind) {
            for (elements, curved, grade) in [(2, false, false), (7, false, false), (9, false, true), (6, true, false), (5, true, true)] {
                if curved && kind == Kind::Nurbs && degree < 2 {
                    continue;
                }
                let space = side(kind, degree, elements, curved, grade);
                let what = format!("{kind:?} of degree {degree}, {elements} elements, curved {curved}, graded {grade}");
                assert_eq!(found(&space, MultiplierKind::Lowered(0), &[]), Some(degree), "p/p: {what}");
                assert_eq!(found(&space, MultiplierKind::Lowered(0), &[true, false]), Some(degree - 1), "p/p lowered: {what}");
                for k in 1..=degree {
                    assert_eq!(found(&space, MultiplierKind::Lowered(k), &[]), Some(degree - k), "p/p-{k}: {what}");
                }
                assert_eq!(found(&space, MultiplierKind::Constant, &[]), Some(0), "{what}");
                let data = MultiplierKind::Uniform { degree: 1, continuity: Some(0), ends: Ends::Full };
                assert_eq!(found(&space, data, &[]), Some(1), "{what}");
                // Gauss-Lobatto nodes integrate N_i times degree p - 1 exactly: coefficients are nodal values. On equal
                // elements those of an even degree p are the same on both sides of a vertex, by symmetry
                let nodal = !curved && matches!(kind, Kind::Tensor | Kind::Triangle);
                let dual = if nodal { degree - usize::from(grade || degree % 2 == 1) } else { 0 };
                assert_eq!(found(&space, MultiplierKind::Dual, &[]), Some(dual), "dual: {what}");
                let held = if nodal { degree - 1 } else { 0 };
                assert_eq!(found(&space, MultiplierKind::Dual, &[true, false]), Some(held), "dual, one end held: {what}");
            }
            // on one element the dual functions span all polynomials
            let one = side(kind, degree, 1, false, false);
            assert_eq!(found(&one, MultiplierKind::Dual, &[]), Some(degree), "{kind:?} of degree {degree}, one element");
        }
    }
}

#[test]
fn there_are_no_dual_functions_where_a_lumped_weight_is_not_positive() {
    // x = 0.01 t + 0.99 t^3 in cubic Bernstein form; (1 - 2t)(1 - t) integrates to 0.01/6 - 0.99/20 < 0
    let control = [0.0, 0.01 / 3.0, 0.02 / 3.0, 1.0];
    let mut net = rectangle([0.0, 0.0], [1.0, 1.0]).unwrap().elevate(0, 2);
    for (i, x) in control.iter().enumerate() {
        net.points[i][0] = *x;
        net.points[i + 4][0] = *x;
    }
    let spec = PatchSpec::new(net).with_degree([2, 2]).with_mapping(Mapping::Exact);
    let space = Kind::Tensor.body(&spec).trace("v0").unwrap().space;
    let error = build(&space, MultiplierKind::Dual, &[]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no multiplier \"dual\" here: the lumped weight of function 0 on element 0 is -4.783e-2, not positive; \
         this side has p/p, p/p-1, p/p-2, constant"
    );
    // a prescribed end does not need its weight
    assert_eq!(build(&space, MultiplierKind::Dual, &[true, false]).unwrap().num_functions(), 2);
    // the mesh of its own nodes has positive weights, as have B-splines on the same map
    assert!(build(&side(Kind::Tensor, 2, 3, false, true), MultiplierKind::Dual, &[]).is_ok());
}

/// Rows of an interface between two bodies, lower v1 (slave) and upper v0, and both solutions of a Poisson problem.
#[test]
fn the_slave_block_is_diagonal_and_condensation_answers_as_the_saddle_point_does() {
    let conductor = Conductor::<2>::try_new(1.0).unwrap();
    let exact = |x: &Vector<2>| Vector::<1>::new((3.0 * x[0] + 0.3).cos() * x[1].exp());
    for (a, b) in [(Kind::Spline, Kind::Tensor), (Kind::Tensor, Kind::Spline), (Kind::Triangle, Kind::Nurbs), (Kind::Nurbs, Kind::Triangle)]
    {
        for (degree, curved) in [(1, false), (2, false), (3, false), (4, false), (2, true), (3, true)] {
            let what = format!("{a:?} below {b:?}, degree {degree}, curved {curved}");
            let ring = |radius: [f64; 2]| annulus_sector([0.0, 0.0], radius, [0.0, 90.0]).unwrap();
            let body = |kind: Kind, low: bool, elements: usize| {
                let net = match (curved, low) {
                    (true, true) => ring([1.0, 1.5]),
                    (true, false) => ring([1.5, 2.0]),
                    (false, true) => rectangle([0.0, 0.0], [1.0, 0.5]).unwrap(),
                    (false, false) => rectangle([0.0, 0.5], [1.0, 1.0]).unwrap(),
                };
                kind.body(&PatchSpec::new(net).with_degree([degree; 2]).with_elements([elements, 2]).with_mapping(Mapping::Exact))
            };
            let mut model = Bodies::<1>::new(vec![body(a, true, 4), body(b, false, 6)], &form(&conductor).unwrap(), 2);
            model.fix(0, &[("u0", 0), ("u1", 0), ("v0", 0)], &exact);
            model.fix(1, &[("u0", 0), ("u1", 0), ("v1", 0)], &exact);
            let sides = [model.trace(0, "v1"), model.trace(1, "v0")];
            let psi = model.multipliers(0, &sides[0], MultiplierKind::Dual);
            let segments = MergedCurve::tied(degree + if curved { 14 } else { 1 }, Tolerance::Exact)
                .segments(&*sides[0].space, &*sides[1].space)
                .unwrap();
            let interface = Interface {
                slave: Side { trace: &sides[0], field: model.fields[0], flux: None },
                master: Some(Side { trace: &sides[1], field: model.fields[1], flux: None }),
                multiplier: &[&*psi[0]],
                segments: &segments,
                master_segments: None,
                direction: None,
            };
            check::coupling(&Mortar, &interface, model.unknowns()).unwrap();
            let rows = Mortar.assemble(&interface, model.unknowns()).unwrap().constraint;
            let m = rows.slave.rows;
            let mut d = DMatrix::<f64>::zeros(m, model.unknowns());
            rows.slave.entries.iter().for_each(|&(i, j, v)| d[(i, j)] += v);
            let free: Vec<usize> = sides[0].dofs.iter().copied().filter(|&f| !model.is_fixed(0, f, 0)).collect();
            assert_eq!(free.len(), m, "{what}");
            let scale = d.amax();
            for j in 0..m {
                let coupled: Vec<usize> = free.iter().copied().filter(|&f| d[(j, f)].abs() > 1e-13 * scale).collect();
                assert_eq!(coupled.len(), 1, "{what}: row {j}");
            }
            let kinds = vec![RowKind::Equal; m];
            let solve = |solver: &mut dyn ConstraintSolver| model.solve(&rows, None, &vec![0.0; m], &kinds, solver).unwrap();
            let (saddle, condensed) = (solve(&mut Direct::new()), solve(&mut Condensed::new()));
            let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            let apart = differ(&saddle.unknowns, &condensed.unknowns).max(differ(&saddle.multipliers, &condensed.multipliers));
            assert!(apart < 1e-9, "{what}: {apart:e}");
        }
    }
}
