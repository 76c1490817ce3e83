//! Cells so thin that round-off affects the result.
//!
//! The aspect of a cell is its longest edge over its least height, by the Jacobian at its centre. Entries of its stiffness differ by the
//! square of the aspect, so that at 1e8 no digit of the small ones is left beside the large ones.

use super::warning::{Subject, Warning};
use crate::basis::{Cell, Order};
use crate::geometry::{MapTable, cell};
use crate::linalg::{Matrix, Vector, determinant};
use crate::parallel;
use crate::problem::model::{BodyModel, Model};

/// Largest aspect without a warning: the inverse of its square is the round-off of a double.
const MOST: f64 = 1e8;

/// Finds the patches with such cells.
pub(super) fn thin_cells<const S: usize, const N: usize>(model: &Model<S, N>) -> Vec<Warning> {
    let of = |k: usize| {
        let (aspect, element, x) = worst(&model.patches[k]);
        let x = x.as_slice().to_vec();
        (aspect > MOST).then(|| Warning::ThinCells { of: Subject::body(model, k), aspect, allowed: MOST, element, x })
    };
    (0..model.patches.len()).filter_map(of).collect()
}

/// Returns the largest aspect, the first element that has it, and its position.
fn worst<const S: usize, const N: usize>(patch: &BodyModel<S, N>) -> (f64, usize, Vector<N>) {
    let space = &**patch.body.space();
    let centers = [Cell::Tensor, Cell::Simplex].map(cell::center::<N, f64>);
    let of = |table: &mut MapTable<N, N>, e: usize| {
        let center = &centers[usize::from(space.cell(e) == Cell::Simplex)];
        space.map(e, std::slice::from_ref(center), Order::Gradients, table);
        (aspect(&table.jacobian[0]), e, table.x[0])
    };
    let aspects = parallel::map_init(space.num_elements(), MapTable::new, of);
    aspects.into_iter().fold((0.0, usize::MAX, Vector::zeros()), |a, b| if b.0 > a.0 { b } else { a })
}

/// Longest column over the least height of the parallelepiped; zero for degenerate ones, which are reported elsewhere.
fn aspect<const N: usize>(j: &Matrix<N, N>) -> f64 {
    let lengths: [f64; N] = std::array::from_fn(|k| j.column(k).norm());
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let volume = determinant(j).abs();
    // the largest face: of two columns in space the length of their product
    let face = (0..N).map(|k| {
        let others: Vec<usize> = (0..N).filter(|&i| i != k).collect();
        match others[..] {
            [a, b] => {
                let (a, b) = (j.column(a), j.column(b));
                let part = |r: usize, s: usize| a[r] * b[s] - a[s] * b[r];
                (part(0, 1).powi(2) + part(1, 2).powi(2) + part(2, 0).powi(2)).sqrt()
            }
            [a] => lengths[a],
            _ => 1.0,
        }
    });
    let height = volume / face.fold(0.0, f64::max);
    if height > 0.0 { longest / height } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aspects_of_boxes_and_slanted_cells() {
        let j = Matrix::<2, 2>::new(2.0, 0.0, 0.0, 1e-3);
        assert!((aspect(&j) - 2e3).abs() < 1e-9);
        // a parallelogram of height 1e-3 on a base of sqrt(2)
        let j = Matrix::<2, 2>::new(1.0, 1.0, 1.0, 1.0 + 2e-3);
        assert!((aspect(&j) / (1.0 + 1.0020f64.powi(2)) * 2e-3 - 1.0).abs() < 2e-3, "{}", aspect(&j));
        let j = Matrix::<3, 3>::new(1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1e-2);
        assert!((aspect(&j) - 300.0).abs() < 1e-9);
    }
}
