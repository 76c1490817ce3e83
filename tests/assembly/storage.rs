//! Sparse matrices in blocks against the same matrices entry by entry, and the bytes that both take.

use faying::assembly::{Equation, Reduced, gauss_rules, refill_stiffness, stiffness};
use faying::geometry::ControlNet;
use faying::linalg::{Csr, Operator, Real, Sparsity, Triplets, lit, product, sum};
use faying::physics::{Hooke, form};
use faying::space::{Body, Dimension, Patch, PatchSpec, Trace};
use std::sync::Arc;

/// A matrix of 5 x 4 groups of `block` rows and columns with numbers of no pattern, group 3 of rows empty.
fn blocked(block: usize, seed: f64) -> Csr {
    let (ptr, cols) = (vec![0, 2, 5, 6, 6, 8], vec![1, 3, 0, 1, 2, 2, 0, 3]);
    let pattern = Sparsity::new(block, 4, ptr, cols);
    let vals = (0..pattern.num_entries()).map(|k| (seed + k as f64).sin()).collect();
    Csr::with_values(Arc::new(pattern), vals)
}

/// Every entry by itself.
fn scattered(a: &Csr) -> Csr {
    let mut entries = Triplets::new(a.num_rows(), a.num_cols());
    for i in 0..a.num_rows() {
        let (cols, vals) = a.row(i);
        cols.zip(vals).for_each(|(j, &v)| entries.push(i, j, v));
    }
    entries.to_csr()
}

fn same_rows(a: &Csr, b: &Csr) {
    assert_eq!((a.num_rows(), a.num_cols(), a.num_entries()), (b.num_rows(), b.num_cols(), b.num_entries()));
    for i in 0..a.num_rows() {
        let ((a_cols, a_vals), (b_cols, b_vals)) = (a.row(i), b.row(i));
        assert_eq!(a_cols.len(), a_vals.len());
        assert!(a_cols.eq(b_cols) && a_vals == b_vals, "row {i}");
        assert!(a_cols.rev().eq(b_cols.rev()), "row {i} from its end");
    }
}

#[test]
fn a_matrix_in_blocks_is_the_matrix_of_its_entries() {
    for block in 1..=4 {
        let (a, b) = (blocked(block, 0.3), blocked(block, 1.7));
        let (single, other) = (scattered(&a), scattered(&b));
        assert_eq!((a.pattern().block(), single.pattern().block()), (block, 1));
        assert_eq!(a.vals(), single.vals(), "values lie row by row in both");
        same_rows(&a, &single);
        for i in 0..a.num_rows() {
            assert_eq!(a.entries(i), single.entries(i));
            for j in 0..a.num_cols() {
                assert_eq!(a.get(i, j), single.get(i, j), "{i} {j}");
            }
        }
        same_rows(&a.transposed(), &single.transposed());
        assert_eq!(a.transposed().transposed(), a);
        same_rows(&sum(2.0, &a, -3.0, &b), &sum(2.0, &single, -3.0, &other));
        same_rows(&product(&a.transposed(), &b), &product(&single.transposed(), &other));
        let x: Vec<f64> = (0..a.num_cols()).map(|k| (k as f64).cos()).collect();
        let z: Vec<f64> = (0..a.num_rows()).map(|k| (k as f64).cos()).collect();
        let (mut y, mut expected) = (vec![0.0; a.num_rows()], vec![0.0; a.num_rows()]);
        a.mul(&x, &mut y);
        single.mul(&x, &mut expected);
        assert_eq!(y, expected, "the same sums in the same order");
        let (mut y, mut expected) = (x.clone(), x.clone());
        a.add_transposed_mul(&z, &mut y);
        single.add_transposed_mul(&z, &mut expected);
        assert_eq!(y, expected);
    }
}

#[test]
fn columns_are_found_from_both_ends() {
    for block in 1..=3 {
        let a = blocked(block, 0.0);
        for i in 0..a.num_rows() {
            let all: Vec<usize> = a.row(i).0.collect();
            for gone in 0..=all.len() {
                let (mut cols, left) = (a.row(i).0, &all[gone..]);
                cols.by_ref().take(gone).for_each(drop);
                assert_eq!(cols.len(), left.len());
                for j in 0..a.num_cols() {
                    assert_eq!(cols.below(j), left.partition_point(|&c| c < j), "block {block}, row {i}, {gone} gone, column {j}");
                    assert_eq!(cols.position_of(j), left.binary_search(&j).ok());
                }
                assert!((0..=left.len()).all(|k| cols.get(k) == left.get(k).copied()));
                let mut back = cols;
                assert_eq!(std::iter::from_fn(|| back.next_back()).count(), left.len());
            }
        }
    }
}

/// Square matrices of 3 groups of 2: a symmetric one, and the same with one entry moved or without partner.
#[test]
fn symmetry_is_seen_in_blocks_as_it_is_entry_by_entry() {
    let pattern = |lower: bool| {
        let rows: [&[u32]; 3] = [&[0, 2], &[1, 2], if lower { &[0, 1, 2] } else { &[1, 2] }];
        let ptr = rows.iter().scan(0, |s, r| {
            *s += r.len();
            Some(*s)
        });
        Arc::new(Sparsity::new(2, 3, std::iter::once(0).chain(ptr).collect(), rows.concat()))
    };
    let value = |i: usize, j: usize| 1.0 + ((i + j) as f64).sin() + (i * j) as f64;
    let fill = |pattern: &Arc<Sparsity>| {
        let vals = (0..6).flat_map(|i| pattern.row(i).map(move |j| value(i, j))).collect();
        Csr::with_values(pattern.clone(), vals)
    };
    let even = fill(&pattern(true));
    assert!(even.is_symmetric(0.0) && scattered(&even).is_symmetric(0.0));
    for k in 0..even.num_entries() {
        let mut odd = even.clone();
        odd.vals_mut()[k] += 1e-3;
        let diagonal = (0..6).any(|i| odd.entries(i).start + odd.row(i).0.position_of(i).unwrap() == k);
        assert_eq!(odd.is_symmetric(1e-6), diagonal, "entry {k}");
        assert_eq!(scattered(&odd).is_symmetric(1e-6), diagonal);
        assert!(odd.is_symmetric(1e-2));
    }
    let mut single = fill(&pattern(false));
    assert!(!single.is_symmetric(1e-6), "a block without partner");
    for i in 0..2 {
        let (cols, vals) = single.row_mut(i);
        cols.zip(vals).filter(|(j, _)| *j >= 4).for_each(|(_, v)| *v = 0.0);
    }
    assert!(single.is_symmetric(1e-6), "zeros need none");
}

#[test]
fn elasticity_takes_less_than_nine_bytes_per_entry_in_space() {
    let net = faying::geometry::shapes::brick([0.0; 3], [1.0; 3]).unwrap();
    let material = Hooke::<3>::solid(1.0, 0.3).unwrap();
    for smooth in [0, 1] {
        let spec = PatchSpec::new(net.clone()).with_degree([2; 3]).with_elements([5; 3]).with_continuity(smooth);
        let patch = Patch::<2, 3>::try_new(&spec).unwrap();
        let space = patch.space();
        let k = stiffness(space, &gauss_rules(space, 0), &form(&material).unwrap());
        assert_eq!(k.dof_coordinates().len(), k.num_rows());
        let counted = 8 * k.num_entries() + 4 * k.num_entries() / 9 + 8 * (k.num_rows() / 3 + 1) + 24 * k.num_rows();
        assert_eq!(k.bytes(), counted, "values, one column per 3 x 3 block, row pointers, places");
        let per_entry = k.bytes() as f64 / k.num_entries() as f64;
        assert!(per_entry < 9.0, "continuity {smooth}: {per_entry}");
        assert!(scattered(&k).bytes() >= 12 * k.num_entries());
    }
}

/// Pᵀ K P in blocks is what it is entry by entry, with supports of whole nodes, of some components, and with an equation.
#[test]
fn reduction_keeps_blocks_where_nodes_are_held_as_a_whole() {
    let net = faying::geometry::shapes::brick([0.0; 3], [1.0; 3]).unwrap();
    let patch = Patch::<2, 3>::try_new(&PatchSpec::new(net).with_degree([2; 3]).with_elements([2; 3])).unwrap();
    let k = stiffness(patch.space(), &gauss_rules(patch.space(), 0), &form(&Hooke::<3>::solid(1.0, 0.3).unwrap()).unwrap());
    let single = scattered(&k).with_dof_coordinates(k.dof_coordinates().to_vec());
    let n = k.num_rows();
    let f: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
    let whole: Vec<(usize, f64)> = (0..30).chain(n + 60..n + 75).map(|i| (i, 0.1 * i as f64)).collect();
    let some: Vec<(usize, f64)> = (0..30).map(|i| (3 * i + 1, 0.5)).collect();
    let equation = Equation { terms: vec![(90, 1.0), (100, -0.5), (n + 4, 0.25)], value: 0.2 };
    let nothing: &[Equation] = &[];
    for (prescribed, equations, block) in
        [(&whole, nothing, 3), (&Vec::new(), nothing, 3), (&some, nothing, 1), (&whole, std::slice::from_ref(&equation), 1)]
    {
        let blocked = Reduced::try_new(&[&k, &k], &f, prescribed, equations).unwrap();
        let expected = Reduced::try_new(&[&single, &single], &f, prescribed, equations).unwrap();
        assert_eq!(blocked.stiffness.pattern().block(), block);
        same_rows(&blocked.stiffness, &expected.stiffness);
        assert_eq!((&blocked.load, blocked.stiffness.dof_coordinates()), (&expected.load, expected.stiffness.dof_coordinates()));
        // Pᵀ K P v by products with the matrices of the bodies
        let v: Vec<f64> = (0..blocked.num_free()).map(|i| (0.7 * i as f64).cos()).collect();
        let zero = vec![0.0; blocked.num_free()];
        let moved: Vec<f64> = blocked.expand(&v).iter().zip(blocked.expand(&zero)).map(|(a, b)| a - b).collect();
        let none = Triplets::new(0, 2 * n);
        let forces = blocked.residual(&[&k, &k], &vec![0.0; 2 * n], &[&none], &[], &moved);
        let mut product = vec![0.0; v.len()];
        blocked.stiffness.mul(&v, &mut product);
        let size = forces.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        // rows of P: the force on a free unknown and what its followers bring
        let mut gathered = blocked.restrict(&forces);
        if !equations.is_empty() {
            let free = |i: usize| blocked.free().iter().position(|&f| f == i).unwrap();
            gathered[free(100)] += 0.5 * forces[90];
            gathered[free(n + 4)] -= 0.25 * forces[90];
        }
        assert!(gathered.iter().zip(&product).all(|(a, b)| (a - b).abs() <= 1e-13 * size));
    }
}

/// Allocations per layer of elements: tables of the directions, lists of tasks.
const PER_LAYER: u64 = 16;

/// Numbers of times that refilling the matrix of n elements per direction allocates, on one thread.
fn allocations<const S: usize, const N: usize>(n: usize, material: &dyn faying::physics::Material<N, N>, net: ControlNet<N, N>) -> u64
where
    Trace<S, N>: Dimension<S, N>,
{
    let patch = Patch::<S, N>::try_new(&PatchSpec::new(net).with_degree([2; N]).with_elements([n; N])).unwrap();
    let rules = gauss_rules(patch.space(), 0);
    let mut k = stiffness(patch.space(), &rules, &form(material).unwrap());
    let fresh = k.clone();
    k.vals_mut().fill(f64::NAN);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut refill = || refill_stiffness(patch.space(), &rules, &form(material).unwrap(), &mut k);
    let count = pool.install(|| {
        refill();
        allocation_counter::measure(&mut refill).count_total
    });
    assert_eq!(k, fresh);
    count
}

/// Memory of tasks is kept from layer to layer: elements, eight times as many in space, allocate nothing, layers a few times.
#[test]
fn refilling_allocates_per_layer_and_not_per_element() {
    let square = faying::geometry::shapes::annulus_sector([0.0; 2], [1.0, 2.0], [0.0, 90.0]).unwrap();
    let cube = faying::geometry::shapes::brick([0.0; 3], [1.0; 3]).unwrap();
    let (plane, solid) = (Hooke::<2>::plane_stress(1.0, 0.3).unwrap(), Hooke::<3>::solid(1.0, 0.3).unwrap());
    let counts = [16, 32].map(|n| allocations::<1, 2>(n, &plane, square.clone()));
    let solids = [8, 16].map(|n| allocations::<2, 3>(n, &solid, cube.clone()));
    for ([few, many], layers) in [(counts, 16), (solids, 8)] {
        assert!(many <= few + PER_LAYER * layers, "{counts:?} {solids:?}");
    }
}

/// A matrix whose values and columns lie in mapped pages where the system has them.
#[test]
fn large_matrices_behave_like_small_ones() {
    fn checked<T: Real>() {
        let n = 3000;
        let pattern = Arc::new(Sparsity::new(1, n, (0..=n).map(|i| i * n).collect(), (0..n * n).map(|k| (k % n) as u32).collect()));
        let mut a = Csr::<T>::zeros(pattern);
        assert!(a.vals().iter().all(|&v| v == T::zero()));
        let value = |i: usize, j: usize| lit::<T>((i as f64 - 2.0 * j as f64) / 1024.0);
        for i in 0..n {
            let (cols, vals) = a.row_mut(i);
            cols.zip(vals).for_each(|(j, v)| *v = value(i, j));
        }
        let mut b = a.clone();
        assert!(b == a);
        b.vals_mut()[n * n - 1] += T::one();
        assert!(b != a && a.get(n - 1, n - 1) == value(n - 1, n - 1));
        let t = a.transposed();
        for (i, j) in [(0, 0), (1, 2), (n - 1, 0), (17, n - 1)] {
            assert!(a.get(i, j) == value(i, j) && t.get(j, i) == value(i, j));
        }
        let mut y = vec![T::zero(); n];
        let x: Vec<T> = (0..n).map(|j| if j % 1000 == 0 { lit(1024.0) } else { T::zero() }).collect();
        a.mul(&x, &mut y);
        assert!((0..n).all(|i| y[i] == lit(3.0 * i as f64 - 2.0 * (1000.0 + 2000.0))));
    }
    checked::<f64>();
    checked::<f32>();
}
