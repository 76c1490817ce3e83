//! Terms of lower order: matrices, products without a matrix and energy norms, beside every way to compute the other terms.

use crate::common::products;
use faying::assembly::{
    Assembler, Coefficient, Form, LowerOrder, MatrixFree, Pattern, add_stiffness, errors, gauss_rules, refill_stiffness, stiffness,
};
use faying::basis::{Order, ShapeTable, TensorProduct};
use faying::geometry::{MapTable, shapes};
use faying::linalg::{Csr, Matrix, Operator, Vector, determinant, inverse};
use faying::physics::{Hooke, form};
use faying::quadrature::Quadrature;
use faying::space::{Body, FunctionSpace, Mesh, Patch, PatchSpec, Space};
use products::{Plain, largest, maps, noise, spline};

/// Entries may differ by this share of the largest.
const SAME: f64 = 1e-13;

/// Terms that vary, all of them, C symmetric.
fn terms<const C: usize, const N: usize>(x: &Vector<N>) -> LowerOrder<C, N> {
    let mixed = std::array::from_fn(|e| Matrix::from_fn(|c, j| 0.3 * (1 + c + 2 * e) as f64 - x[j] * (1.0 + e as f64)));
    let value = Matrix::from_fn(|c, e| 5.0 + x[0] * (c + e) as f64 + if c == e { 3.0 } else { 0.0 });
    LowerOrder { mixed: Some(mixed), value }
}

/// The matrix of the terms by the definition: products of functions at points, entry by entry.
fn dense<const C: usize, const N: usize>(space: &dyn Space<N, N>) -> Vec<Vec<f64>> {
    let n = C * space.num_functions();
    let (mut all, rules) = (vec![vec![0.0; n]; n], gauss_rules(space, 0));
    let (mut ids, mut table, mut map) = (Vec::new(), ShapeTable::new(), MapTable::new());
    for e in 0..space.num_elements() {
        let rule = rules.rule(e);
        space.active(e, &mut ids);
        space.evaluate(e, &rule.points, Order::Gradients, &mut table, &mut map);
        for (q, w) in rule.weights.iter().enumerate() {
            let dx = w * determinant(&map.jacobian[q]).abs();
            let back = inverse(&map.jacobian[q]).unwrap().transpose();
            let at = terms::<C, N>(&map.x[q]);
            let slope = |a: usize| back * table.grads(q)[a];
            for (a, &i) in ids.iter().enumerate() {
                for (b, &j) in ids.iter().enumerate() {
                    let (va, vb, ga, gb) = (table.values(q)[a], table.values(q)[b], slope(a), slope(b));
                    for c in 0..C {
                        for d in 0..C {
                            let mixed = at.mixed.unwrap();
                            let stress: f64 = (0..N).map(|l| ga[l] * mixed[d][(c, l)]).sum();
                            let other: f64 = (0..N).map(|l| gb[l] * mixed[c][(d, l)]).sum();
                            all[C * i + c][C * j + d] += dx * (stress * vb + other * va + va * at.value[(c, d)] * vb);
                        }
                    }
                }
            }
        }
    }
    all
}

fn rows(matrix: &Csr) -> Vec<Vec<f64>> {
    let n = matrix.num_rows();
    (0..n).map(|i| (0..n).map(|j| matrix.get(i, j)).collect()).collect()
}

/// Every way to have the matrix of a form, with terms of lower order and without, is off from the other by those terms.
fn compare<const C: usize, const N: usize>(space: &dyn Space<N, N>, make: &dyn Fn() -> Form<'static, C, N>) -> f64 {
    let rules = gauss_rules(space, 0);
    let (plain, whole) = (make(), make().with_lower_order(terms::<C, N>));
    let (without, found) = (rows(&stiffness(space, &rules, &plain)), stiffness(space, &rules, &whole));
    let expected = dense::<C, N>(space);
    let size = largest(expected.iter().flatten().map(|v| v.abs())).max(largest(without.iter().flatten().map(|v| v.abs())));
    let all = rows(&found);
    let n = all.len();
    let pairs = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let mut most = largest(pairs().map(|(i, j)| (all[i][j] - without[i][j] - expected[i][j]).abs() / size));
    assert!(pairs().all(|(i, j)| all[i][j] == all[j][i]), "symmetric to the last bit");
    // refilled, by a stored graph, and added to another
    let (mut again, mut stored, mut added) = (found.clone(), found.clone(), found.clone());
    refill_stiffness(space, &rules, &whole, &mut again);
    Assembler::new(space, &rules).refill_stiffness(space, &rules, &whole, &mut stored);
    added.vals_mut().fill(0.0);
    add_stiffness(&Pattern::new(space), space, &rules, &whole, &mut added);
    assert!(again.vals() == found.vals() && stored.vals() == found.vals() && added.vals() == found.vals());
    let x: Vec<f64> = (0..n).map(|i| noise(3 * i + 2) - 0.5).collect();
    let (mut product, mut wanted) = (vec![0.0; n], vec![f64::NAN; n]);
    found.apply(&x, &mut wanted);
    for free in [MatrixFree::new(space, &rules, &whole), MatrixFree::lean(space, &rules, &whole)] {
        free.apply(&x, &mut product);
        most = most.max(largest(product.iter().zip(&wanted).map(|(a, b)| (a - b).abs() / size)) / n as f64);
        most = most.max(largest(free.diagonal().iter().zip(found.diagonal()).map(|(a, b)| (a - b).abs() / size)));
    }
    // the energy norm of a field is the form with itself
    let zero = |_: &Vector<N>| (Vector::<C>::zeros(), Matrix::<C, N>::zeros());
    let energy: f64 = x.iter().zip(&wanted).map(|(a, b)| a * b).sum();
    let norm = errors(space, &rules, &whole, &x, &zero).error.energy;
    assert!(energy > 0.0, "the terms leave the form positive here");
    assert!((norm * norm - energy).abs() <= 1e-11 * energy, "{norm} for {}", energy.sqrt());
    assert!(most <= SAME, "apart by {most:e}");
    most
}

#[test]
fn terms_of_lower_order_stand_beside_every_way_of_assembly() {
    let steel = Hooke::plane_strain(40.0, 0.3).unwrap();
    let hooke = || {
        let tangent = form(&steel).unwrap().coefficient.at(&Vector::zeros(), &Matrix::zeros());
        Form::new(Coefficient::Constant(tangent), true)
    };
    let laplace = || Form::<1, 2>::new(Form::<1, 2>::laplace().coefficient, true);
    for p in [[1, 2], [2, 2], [3, 2]] {
        let axes = || [spline(p[0], 3), spline(p[1], 4)];
        for geometry in maps(axes) {
            let space = FunctionSpace { basis: TensorProduct::new(axes()), geometry };
            // contracted, and element by element
            compare::<1, 2>(&space, &laplace);
            compare::<2, 2>(&space, &hooke);
            compare::<2, 2>(&Plain(&space), &hooke);
        }
    }
    // cells in lanes, and several patches' worth of them
    let net = shapes::annulus_sector([0.3, -0.2], [1.0, 2.0], [10.0, 80.0]).unwrap();
    for p in [1, 2] {
        let spec =
            PatchSpec { degree: [p; 2], breakpoints: [vec![0.0, 0.3, 1.0], vec![0.0, 0.5, 0.8, 1.0]], ..PatchSpec::new(net.clone()) };
        let (mesh, patch): (Mesh<1, 2>, Patch<1, 2>) =
            (Mesh::from_patch(&spec).unwrap(), Patch::try_new(&PatchSpec { degree: [2; 2], ..spec }).unwrap());
        compare::<1, 2>(&**mesh.space(), &laplace);
        compare::<2, 2>(&**mesh.space(), &hooke);
        compare::<2, 2>(&**patch.space(), &hooke);
    }
}
