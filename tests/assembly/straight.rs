//! Straight and bent cells in one mesh, and graphs made by any number of threads.

use crate::common::cells;
use crate::common::plain;
use cells::{Random, Shapes, bent, boxes};
use faying::assembly::{Coefficient, Form, Pattern, gauss_rules, mass, stiffness};
use faying::linalg::{Csr, Operator, Vector};
use faying::physics::{Hooke, form};
use faying::space::{Body, Mapping, Mesh, Space};
use plain::{Plain, Renumbered, apart};
use std::collections::BTreeSet;

/// Entries may differ by this share of the largest.
const SAME: f64 = 1e-13;

fn same_bits(a: &Csr, b: &Csr) -> bool {
    a.pattern() == b.pattern() && a.vals().iter().zip(b.vals()).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// A shear; beyond the middle every line of the first direction is bent by `by`.
fn half_bent<const N: usize>(by: f64) -> impl Fn(&Vector<N>) -> Vector<N> {
    move |u| {
        let x = Vector::from_fn(|k, _| 0.3 + u[k] + 0.37 * u[(k + 1) % N]);
        let beyond = (u[0] - 0.5).max(0.0);
        x + Vector::from_fn(|k, _| by * beyond * beyond * (1.0 + u[k]))
    }
}

fn agree<const C: usize, const N: usize>(space: &dyn Space<N, N>, form: &Form<'_, C, N>, what: &str) {
    let rules = gauss_rules(space, 0);
    let (fast, plain) = (stiffness(space, &rules, form), stiffness(&Plain(space), &rules, form));
    assert!(apart(&fast, &plain) <= SAME, "{what}: apart by {:e}", apart(&fast, &plain));
    let (fast, plain) = (mass(space, &rules), mass(&Plain(space), &rules));
    assert!(apart(&fast, &plain) <= SAME, "{what}: masses apart by {:e}", apart(&fast, &plain));
}

/// From no bend over bends of the last bits to large ones: none is taken for straight that changes the matrix.
const BENDS: [f64; 9] = [0.0, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-6, 0.2];

#[test]
fn straight_and_bent_plane_cells_equal_the_plain_loop() {
    let elastic = Hooke::<2>::plane_strain(1.0, 0.3).unwrap();
    for by in BENDS {
        for shapes in [Shapes::Tensor, Shapes::Simplex, Shapes::Mixed] {
            for (order, degree, mapping) in
                [(1, 2, Mapping::Exact), (1, 2, Mapping::Isoparametric), (2, 2, Mapping::Exact), (2, 3, Mapping::Isoparametric)]
            {
                let what = format!("bent by {by:e}, {shapes:?}, order {order}, degree {degree}, {mapping:?}");
                let cells = boxes([6, 3], shapes, order, Some(5), &half_bent(by));
                let body = Mesh::<1, 2>::from_cells(&cells, degree, mapping).unwrap();
                let space = &**body.space();
                agree::<1, 2>(space, &Form::laplace(), &what);
                agree::<2, 2>(space, &form(&elastic).unwrap(), &what);
                let varying = Coefficient::PerPoint(Box::new(|x: &Vector<2>| {
                    let mut tangent = [[faying::linalg::Matrix::<1, 2>::zeros(); 2]; 1];
                    (0..2).for_each(|k| tangent[0][k][(0, k)] = 1.0 + x[0] * x[0]);
                    tangent
                }));
                agree::<1, 2>(space, &Form::new(varying, true), &what);
            }
        }
    }
}

#[test]
fn straight_and_bent_solid_cells_equal_the_plain_loop() {
    let elastic = Hooke::<3>::solid(1.0, 0.3).unwrap();
    for by in BENDS {
        for shapes in [Shapes::Tensor, Shapes::Simplex] {
            for (order, mapping) in [(1, Mapping::Exact), (2, Mapping::Exact)] {
                let what = format!("bent by {by:e}, {shapes:?}, order {order}");
                let cells = boxes([4, 1, 1], shapes, order, Some(3), &half_bent(by));
                let body = Mesh::<2, 3>::from_cells(&cells, 2, mapping).unwrap();
                agree::<1, 3>(&**body.space(), &Form::laplace(), &what);
                agree::<3, 3>(&**body.space(), &form(&elastic).unwrap(), &what);
            }
        }
    }
}

/// Everything that a pattern says, checked against sets made element by element.
fn checked<const N: usize>(space: &dyn Space<N, N>) -> (Pattern, Vec<usize>, Vec<u32>) {
    let pattern = Pattern::new(space);
    let n = space.num_functions();
    let (mut rows, mut cells, mut ids) = (vec![BTreeSet::new(); n], vec![Vec::new(); n], Vec::new());
    for e in 0..space.num_elements() {
        space.active(e, &mut ids);
        assert!(ids.iter().map(|&i| i as u32).eq(pattern.ids(e).iter().copied()));
        for (a, &i) in ids.iter().enumerate() {
            rows[i].extend(ids.iter().map(|&j| j as u32));
            cells[i].push((e as u32, a as u32));
        }
    }
    for i in 0..n {
        assert!(rows[i].iter().eq(pattern.row(i)), "row {i}");
        assert_eq!(cells[i], pattern.cells(i), "cells of {i}");
    }
    let (ptr, cols) = (pattern.ptr().to_vec(), (0..n).flat_map(|i| pattern.row(i).to_vec()).collect());
    (pattern, ptr, cols)
}

#[test]
fn graphs_places_and_matrices_are_the_same_for_any_number_of_threads() {
    fn check<const N: usize>(space: &dyn Space<N, N>) {
        let mut random = Random(9);
        let mut order: Vec<(usize, usize)> = (0..space.num_functions()).map(|i| (random.below(1 << 30), i)).collect();
        order.sort_unstable();
        let scattered = Renumbered::new(space, order.into_iter().map(|o| o.1).collect());
        let rules = gauss_rules(space, 0);
        // as they are, without reference cells, and scattered, where rows of one thread reach everything
        for (way, space) in [space, &Plain(space), &scattered].into_iter().enumerate() {
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let (_, ptr, cols) = checked(space);
                    (ptr, cols, stiffness(space, &rules, &Form::<1, N>::laplace()), mass(space, &rules))
                })
            };
            let one = run(1);
            for threads in 2..=4 {
                let other = run(threads);
                assert!(other.0 == one.0 && other.1 == one.1, "way {way}, {threads} threads: the graph");
                assert!(same_bits(&other.2, &one.2) && same_bits(&other.3, &one.3), "way {way}, {threads} threads: the matrices");
                assert_eq!(other.2.dof_coordinates(), one.2.dof_coordinates(), "way {way}, {threads} threads");
            }
            let plain = stiffness(&Plain(space), &rules, &Form::<1, N>::laplace());
            assert!(apart(&one.2, &plain) <= SAME, "way {way}");
        }
    }
    for shapes in [Shapes::Tensor, Shapes::Simplex, Shapes::Mixed] {
        check::<2>(&**Mesh::<1, 2>::from_cells(&boxes([19, 14], shapes, 1, Some(2), &bent), 2, Mapping::Exact).unwrap().space());
    }
    for shapes in [Shapes::Tensor, Shapes::Simplex] {
        check::<3>(&**Mesh::<2, 3>::from_cells(&boxes([5, 4, 3], shapes, 1, Some(2), &bent), 2, Mapping::Exact).unwrap().space());
    }
}
