//! Tests for the same bits at every SIMD width: AVX2 against AVX-512 if the processor has both, straight and bent cells in one batch.

use super::{CellSpace, Sums};
use crate::assembly::sum_factorization::QuadraturePoints;
use crate::assembly::{Coefficient, Form, Pattern, gauss_rules};
use crate::basis::Cell;
use crate::linalg::{Csr, Matrix, Vector};
use crate::space::{Body, CellBlock, FieldAt, Mapping, Mesh, MeshCells, Space};
use pulp::x86::{V3, V4};

/// A row of 20 quadratic quadrilaterals, or of twice as many triangles; those in the middle are bent.
fn row(cell: Cell) -> MeshCells<2> {
    let bend = |x: f64| if x > 6.0 && x < 11.0 { 0.05 * (3.0 * x).sin() } else { 0.0 };
    let points = (0..41 * 3).map(|i| {
        let x = (i % 41) as f64 / 2.0;
        Vector::<2>::new(x, (i / 41) as f64 / 2.0 + bend(x))
    });
    let at = |e: usize, i: usize, j: usize| 2 * e + i + 41 * j;
    let nodes = (0..20).flat_map(|e| match cell {
        Cell::Tensor => (0..9).map(|k| at(e, k % 3, k / 3)).collect::<Vec<_>>(),
        Cell::Simplex => {
            let lower = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [0, 2]];
            lower.iter().map(|[i, j]| at(e, *i, *j)).chain(lower.iter().map(|[i, j]| at(e, 2 - i, 2 - j))).collect()
        }
    });
    MeshCells { points: points.collect(), blocks: vec![CellBlock { cell, order: 2, nodes: nodes.collect() }], tags: Vec::new() }
}

/// The matrix, a load with its moments, squares, and a field, with the lanes of `arch`.
fn numbers(space: &dyn Space<2, 2>, arch: pulp::Arch) -> Vec<f64> {
    let (rules, pattern, form) = (gauss_rules(space, 0), Pattern::new(space), Form::<1, 2>::laplace());
    let mut matrix: Csr = pattern.csr(1);
    let mut cells = CellSpace::new(&pattern, space, &rules).expect("cells with reference cells");
    cells.arch = arch;
    cells.stiffness(&pattern, &form, false, &mut matrix);
    let mut all = matrix.vals().to_vec();
    cells.mass(&pattern, &mut matrix);
    all.extend(matrix.vals());
    let state: Vec<f64> = (0..space.num_functions()).map(|i| (i as f64).sin()).collect();
    let tangent = |_: &Vector<2>, h: &Matrix<1, 2>| [[*h * h[0], *h * h[1]]];
    let stated = Form::<1, 2>::new(Coefficient::PerState(Box::new(tangent)), true).with_state(&state);
    cells.stiffness(&pattern, &stated, false, &mut matrix);
    all.extend(matrix.vals());
    let mut sums = Sums::new(space, &rules).expect("cells with reference cells");
    sums.arch = arch;
    let sine = |sites: &QuadraturePoints, out: &mut [f64]| {
        let size = out.len() * 2 / sites.x.len();
        out.iter_mut().enumerate().for_each(|(k, out)| *out = (sites.x[k / size * 2] + k as f64 % size as f64).sin());
    };
    let (load, moments) = sums.load(1, &sine);
    all.extend(sums.deviation(&form, &load, &sine));
    all.extend(sums.deviation(&stated, &load, &sine));
    let cubes = |sites: &QuadraturePoints, out: &mut [f64]| {
        for (h, out) in sites.gradients.chunks_exact(2).zip(out.chunks_exact_mut(3)) {
            out.copy_from_slice(&[h[0] + h[0] * h[1], h[1], h[0] * h[0]]);
        }
    };
    let (forces, energy) = sums.internal_force::<1>(&state, &cubes);
    all.extend(forces);
    all.push(energy);
    all.extend(load.iter().chain(&moments));
    let states = sums.states(&load, &|(), _, states: &[FieldAt<1, 2>]| {
        states.iter().flat_map(|s| [s.x[0], s.x[1], s.value[0], s.gradient[0], s.gradient[1]]).collect::<Vec<f64>>()
    });
    all.extend(states.into_iter().flatten());
    all
}

#[test]
fn avx2_and_avx512_give_the_same_bits_on_cells() {
    let (Some(v3), Some(v4)) = (V3::try_new(), V4::try_new()) else {
        println!("skipped: the processor lacks AVX2 or AVX-512");
        return;
    };
    for cell in [Cell::Tensor, Cell::Simplex] {
        let body = Mesh::<1, 2>::from_cells(&row(cell), 2, Mapping::Exact).expect("a mesh");
        let [narrow, wide] = [pulp::Arch::V3(v3), pulp::Arch::V4(v4)].map(|arch| numbers(&**body.space(), arch));
        assert!(narrow.iter().all(|v| v.is_finite()) && narrow.iter().any(|v| *v != 0.0));
        let apart = narrow.iter().zip(&wide).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        assert_eq!(apart, 0, "{cell:?}: of {} numbers", wide.len());
    }
}
