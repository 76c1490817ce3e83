//! The points of a cell's map, lane by lane.

use crate::basis::Listed;
use crate::geometry::Control;
use crate::linalg::{Real, to_f64};

/// Writes number c of function a of the element of a lane at `(a * width + c) * lanes + lane`, from `width` numbers per function.
#[inline]
pub(super) fn put<T: Real>(u: &[T], width: usize, ids: impl Iterator<Item = usize>, (lane, lanes): (usize, usize), out: &mut [f64]) {
    for (out, i) in out.chunks_exact_mut(width * lanes).zip(ids) {
        for (c, &x) in u[width * i..width * (i + 1)].iter().enumerate() {
            out[c * lanes + lane] = to_f64(x);
        }
    }
}

/// A map as functions and points, with the list of its functions where there is one.
#[derive(Debug)]
pub(super) struct MapNodes<'a, const D: usize, const N: usize, T: Real> {
    control: Control<'a, D, N, T>,
    listed: Option<Listed<'a>>,
}

impl<'a, const D: usize, const N: usize, T: Real> MapNodes<'a, D, N, T> {
    pub fn new(control: Control<'a, D, N, T>) -> Self {
        Self { control, listed: control.basis.structure().listed() }
    }

    /// The numbers of the points of `element`, in `ids` where they are not listed.
    #[inline]
    pub fn of<'s>(&'s self, element: usize, ids: &'s mut Vec<usize>) -> &'s [usize] {
        match self.listed {
            Some(Listed { first, ids }) => &ids[first[element]..first[element + 1]],
            None => {
                self.control.basis.active(element, ids);
                ids
            }
        }
    }

    /// Point `i`.
    #[inline]
    pub fn point(&self, i: usize) -> [f64; N] {
        let mut x = [0.0; N];
        for (x, &p) in x.iter_mut().zip(self.control.points[i].iter()) {
            *x = to_f64(p);
        }
        x
    }

    /// Writes coordinate k of point b of the element of a lane at `(b * N + k) * lanes + lane`, one lane per element.
    pub fn gather(&self, elements: &[u32], ids: &mut Vec<usize>, out: &mut [f64]) {
        let lanes = elements.len();
        for (lane, &e) in elements.iter().enumerate() {
            // no chunks: their number is a division per cell
            let mut at = lane;
            for &i in self.of(e as usize, ids) {
                for x in self.point(i) {
                    out[at] = x;
                    at += lanes;
                }
            }
        }
    }
}
