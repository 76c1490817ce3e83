//! Rigid motions that the supports leave: rank of the constraints on the rigid modes of every body.
//!
//! Modes of a body: translations t, and in elasticity rotations w about its middle c, scaled by its size L: u(x) = t + w x (x - c) / L, so
//! that neither position nor size of a body costs digits. A support is a row d . u_b(x) = 0, a connection of two bodies in a point a row d
//! . (u_b(x) - u_c(x)) = 0, and a multiplier function ψ the row ∫ ψ d . (u_b - u_c) ds = 0, which on rigid motions depends on ∫ ψ ds and ∫
//! ψ x ds only.

use crate::linalg::Vector;
use nalgebra::{DMatrix, DVector};

/// Eigenvalues of the Gram matrix below this share of the largest count as zero: singular values below 1e-6.
const RANK: f64 = 1e-12;
/// Entries of a motion below this are not named.
const NEGLIGIBLE: f64 = 1e-5;
/// Largest number of modes of a body.
pub(super) const MOST: usize = 6;

/// Condition d . (sum of sign u_b(x)) = 0.
#[derive(Clone, Debug)]
pub struct RigidRow<const N: usize> {
    /// (body, sign, x) per term.
    pub terms: Vec<(usize, f64, Vector<N>)>,
    /// Direction, of length 1; for a scalar unknown only its first entry is used and is 1.
    pub direction: Vector<N>,
}

/// A condition on the modes of the bodies: (body, coefficients of its modes), summed.
pub type RigidForm = Vec<(usize, [f64; MOST])>;

/// Rigid motions left to a body, in words.
#[derive(Clone, Debug, PartialEq)]
pub struct RemainingMotions {
    /// Number of the body.
    pub body: usize,
    /// Names such as "translation x", "rotation", "rotation about (0, 1)", "constant".
    pub motions: Vec<String>,
    /// Its middle, where it is one of several parts of a body that share no functions.
    pub middle: Option<[f64; 3]>,
}

/// Scales and modes of the bodies.
#[derive(Clone, Debug)]
pub struct RigidModes<const N: usize> {
    /// Components of the unknown: 1 (one mode, the constant) or N.
    pub(super) components: usize,
    /// Middle and size \[length\] of every body.
    pub(super) frames: Vec<(Vector<N>, f64)>,
}

impl<const N: usize> RigidModes<N> {
    /// Number of bodies.
    pub fn num_bodies(&self) -> usize {
        self.frames.len()
    }

    /// Modes per body.
    pub fn modes(&self) -> usize {
        if self.components == 1 { 1 } else { N + N * (N - 1) / 2 }
    }

    /// ∫ d . u for every mode of `body`, from ∫ 1 = `sum` and ∫ (x - `origin`) = `lever`.
    pub(super) fn sums(&self, body: usize, direction: &Vector<N>, sum: f64, lever: &Vector<N>, origin: &Vector<N>) -> [f64; MOST] {
        let mut out = [0.0; MOST];
        if self.components == 1 {
            out[0] = sum;
            return out;
        }
        let (center, size) = self.frames[body];
        let r = (lever + (origin - center) * sum) / size;
        for i in 0..N {
            out[i] = direction[i] * sum;
        }
        for (k, (i, j)) in planes::<N>().enumerate() {
            out[N + k] = direction[j] * r[i] - direction[i] * r[j];
        }
        out
    }

    /// A row as a linear form of the modes.
    pub fn form(&self, row: &RigidRow<N>) -> RigidForm {
        let of = |&(body, sign, x): &(usize, f64, Vector<N>)| (body, self.sums(body, &row.direction, sign, &Vector::zeros(), &x));
        row.terms.iter().map(of).collect()
    }

    /// Returns a form as a vector of the modes of all bodies.
    pub(super) fn dense(&self, form: &RigidForm) -> DVector<f64> {
        let m = self.modes();
        let mut dense = DVector::zeros(m * self.num_bodies());
        for (body, own) in form {
            (0..m).for_each(|k| dense[m * body + k] += own[k]);
        }
        dense
    }

    /// Adds `factor` times the square of a form to a matrix of the modes of all bodies.
    pub fn add_square(&self, form: &RigidForm, factor: f64, sum: &mut DMatrix<f64>) {
        let m = self.modes();
        for (a, of_a) in form {
            for (b, of_b) in form {
                for i in 0..m {
                    for j in 0..m {
                        sum[(m * a + i, m * b + j)] += factor * of_a[i] * of_b[j];
                    }
                }
            }
        }
    }

    /// Work of a force and its moment about the origin on the modes of `body`.
    pub(super) fn work(&self, body: usize, force: &[f64; 3], moment: &[f64; 3]) -> Vec<f64> {
        if self.components == 1 {
            return vec![force[0]];
        }
        let (center, size) = self.frames[body];
        let center = Vector::<3>::from_fn(|k, _| if k < N { center[k] } else { 0.0 });
        let about = (Vector::<3>::from(*moment) - center.cross(&Vector::<3>::from(*force))) / size;
        let mut work = force[..N].to_vec();
        // in the plane (x, z) the positive sense is about -y
        work.extend(if N == 2 { vec![about[2]] } else { vec![about[2], -about[1], about[0]] });
        work
    }

    /// The motions that `forms` leave, orthonormal columns in the modes of all bodies.
    pub fn null(&self, forms: &[RigidForm]) -> DMatrix<f64> {
        let n = self.modes() * self.num_bodies();
        let mut gram = DMatrix::<f64>::zeros(n, n);
        forms.iter().for_each(|form| self.add_square(form, 1.0, &mut gram));
        let eigen = gram.symmetric_eigen();
        let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
        let null: Vec<usize> = (0..n).filter(|&k| eigen.eigenvalues[k] <= RANK * largest.max(f64::MIN_POSITIVE)).collect();
        DMatrix::from_fn(n, null.len(), |i, k| eigen.eigenvectors[(i, null[k])])
    }

    /// Describes the motions left by `forms`, in words.
    pub(super) fn free(&self, forms: &[RigidForm]) -> Vec<RemainingMotions> {
        self.names(&self.null(forms))
    }

    /// Words for motions of all bodies, of those that move.
    pub fn names(&self, motions: &DMatrix<f64>) -> Vec<RemainingMotions> {
        let m = self.modes();
        (0..self.num_bodies())
            .filter_map(|body| {
                let motions = self.name(body, &motions.rows(m * body, m).into_owned());
                (!motions.is_empty()).then_some(RemainingMotions { body, motions, middle: None })
            })
            .collect()
    }

    /// Words for the span of `vectors`, motions of `body`.
    pub fn name(&self, body: usize, vectors: &DMatrix<f64>) -> Vec<String> {
        if vectors.ncols() == 0 {
            return Vec::new();
        }
        let m = vectors.nrows();
        let svd = vectors.clone().svd(true, false);
        let Some(left) = svd.u else { return Vec::new() };
        let span: Vec<DVector<f64>> =
            (0..left.ncols()).filter(|&k| svd.singular_values[k] > NEGLIGIBLE).map(|k| left.column(k).into_owned()).collect();
        let words: Vec<String> = match (self.components, N) {
            (1, _) => vec!["constant".into()],
            (_, 2) => ["translation x", "translation y", "rotation"].map(String::from).to_vec(),
            _ => ["translation x", "translation y", "translation z", "rotation about z", "rotation about y", "rotation about x"]
                .map(String::from)
                .to_vec(),
        };
        let mut named = Vec::new();
        let mut rest = span.clone();
        for i in 0..m {
            let share: f64 = span.iter().map(|v| v[i] * v[i]).sum();
            // a rotation alone is described with its centre
            if share > 1.0 - NEGLIGIBLE && (i < N || span.len() > 1 || self.components == 1) {
                named.push(words[i].clone());
                for v in &mut rest {
                    v[i] = 0.0;
                }
            }
        }
        for v in rest.iter().filter(|v| v.norm() > 0.1) {
            if named.len() >= span.len() {
                break;
            }
            named.push(self.oblique(body, v));
        }
        named
    }

    /// Describes a motion that is no single mode.
    fn oblique(&self, body: usize, v: &DVector<f64>) -> String {
        let (center, size) = self.frames[body];
        let turning = (N..v.len()).any(|k| v[k].abs() > NEGLIGIBLE * v.norm());
        if N == 2 && turning {
            let w = v[2] / size;
            let (x, y) = (center[0] - v[1] / w, center[1] + v[0] / w);
            return format!("rotation about ({}, {})", short(x, size), short(y, size));
        }
        if turning {
            return self.turn(body, v);
        }
        let list: Vec<String> = (0..N).map(|k| short(v[k] / v.norm(), 1.0)).collect();
        format!("translation along ({})", list.join(", "))
    }
}

impl<const N: usize> RigidModes<N> {
    /// Describes a motion in space with a rotation: about a line, or a screw motion.
    ///
    /// With u = t + w x r, r from the middle of the body: the line runs along w through r = (w x t) / w.w if w.t = 0.
    fn turn(&self, body: usize, v: &DVector<f64>) -> String {
        let (center, size) = self.frames[body];
        let t = Vector::<3>::new(v[0], v[1], v[2]);
        // planes (x, y), (x, z), (y, z): in the second the positive sense is about -y
        let w = Vector::<3>::new(v[5], -v[4], v[3]) / size;
        let list = |x: &Vector<3>, scale: f64| x.iter().map(|&c| short(c, scale)).collect::<Vec<_>>().join(", ");
        let along = w / w[w.iamax()];
        if w.dot(&t).abs() > NEGLIGIBLE * w.norm() * v.norm() {
            return format!("screw motion along ({})", list(&along, 1.0));
        }
        let center = Vector::<3>::from_fn(|k, _| if k < N { center[k] } else { 0.0 });
        let point = center + w.cross(&t) / w.norm_squared();
        // the point of the line that is nearest to the origin
        let point = point - along * (point.dot(&along) / along.norm_squared());
        format!("rotation about the line along ({}) through ({})", list(&along, 1.0), list(&point, size))
    }
}

/// The planes (i, j) of rotations.
fn planes<const N: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..N).flat_map(|i| (i + 1..N).map(move |j| (i, j)))
}

/// Three digits of `x`, rounded to zero below 1e-6 of `scale`.
pub(super) fn short(x: f64, scale: f64) -> String {
    if x.abs() < 1e-6 * scale {
        return "0".into();
    }
    let text = format!("{x:.2e}");
    text.parse::<f64>().map_or(text, |rounded| format!("{rounded}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modes(bodies: usize) -> RigidModes<2> {
        RigidModes { components: 2, frames: vec![(Vector::from([0.5, 0.5]), 1.0); bodies] }
    }
    fn free<const N: usize>(modes: &RigidModes<N>, rows: &[RigidRow<N>]) -> Vec<RemainingMotions> {
        modes.free(&rows.iter().map(|row| modes.form(row)).collect::<Vec<_>>())
    }
    fn fixed(body: usize, c: usize, x: [f64; 2]) -> RigidRow<2> {
        RigidRow { terms: vec![(body, 1.0, Vector::from(x))], direction: Vector::from_fn(|k, _| f64::from(u8::from(k == c))) }
    }

    #[test]
    fn a_body_without_supports_has_all_motions() {
        let free = free(&modes(1), &[]);
        assert_eq!(
            free,
            [RemainingMotions { body: 0, motions: vec!["translation x".into(), "translation y".into(), "rotation".into()], middle: None }]
        );
    }

    #[test]
    fn rollers_leave_a_translation_and_a_hinge_a_rotation() {
        let roller = [fixed(0, 1, [0.0, 0.0]), fixed(0, 1, [1.0, 0.0])];
        assert_eq!(free(&modes(1), &roller)[0].motions, ["translation x"]);
        let hinge = [fixed(0, 0, [0.0, 1.0]), fixed(0, 1, [0.0, 1.0])];
        assert_eq!(free(&modes(1), &hinge)[0].motions, ["rotation about (0, 1)"]);
        let clamped = [fixed(0, 0, [0.0, 0.0]), fixed(0, 1, [0.0, 0.0]), fixed(0, 1, [1.0, 0.0])];
        assert!(free(&modes(1), &clamped).is_empty());
    }

    #[test]
    fn a_solid_on_two_hinges_turns_about_their_line() {
        let modes = RigidModes::<3> { components: 3, frames: vec![(Vector::from([0.5, 0.5, 0.5]), 2.0)] };
        let at = |c: usize, x: [f64; 3]| RigidRow::<3> {
            terms: vec![(0, 1.0, Vector::from(x))],
            direction: Vector::from_fn(|k, _| f64::from(u8::from(k == c))),
        };
        // all of (1, 0, 2), x and z of (1, 3, 2): the line x = 1, z = 2
        let mut rows: Vec<_> = (0..3).map(|c| at(c, [1.0, 0.0, 2.0])).collect();
        rows.extend([at(0, [1.0, 3.0, 2.0]), at(2, [1.0, 3.0, 2.0])]);
        assert_eq!(free(&modes, &rows)[0].motions, ["rotation about the line along (0, 1, 0) through (1, 0, 2)"]);
    }

    #[test]
    fn a_frictionless_tie_leaves_only_sliding_to_the_upper_body() {
        let mut rows = vec![fixed(0, 0, [0.0, 0.0]), fixed(0, 1, [0.0, 0.0]), fixed(0, 1, [1.0, 0.0])];
        for x in [0.0, 0.5, 1.0] {
            let at = Vector::from([x, 0.5]);
            rows.push(RigidRow { terms: vec![(1, 1.0, at), (0, -1.0, at)], direction: Vector::from([0.0, 1.0]) });
        }
        assert_eq!(free(&modes(2), &rows), [RemainingMotions { body: 1, motions: vec!["translation x".into()], middle: None }]);
    }
    /// Rows of constants on the cells of an n x m grid of the unit square z = 1, for the modes of a block upon it.
    fn constants(n: usize, m: usize) -> Vec<RemainingMotions> {
        let modes = RigidModes::<3> { components: 3, frames: vec![(Vector::from([0.5, 0.5, 1.5]), 3.0_f64.sqrt())] };
        let cells = (0..n).flat_map(|i| (0..m).map(move |j| [(i as f64 + 0.5) / n as f64, (j as f64 + 0.5) / m as f64, 1.0]));
        let axis = |c: usize| Vector::<3>::from_fn(|k, _| f64::from(u8::from(k == c)));
        let area = 1.0 / (n * m) as f64;
        // the mean of x over a cell is its middle
        let form = |x: [f64; 3], c: usize| vec![(0, modes.sums(0, &axis(c), area, &(Vector::from(x) * area), &Vector::zeros()))];
        let forms: Vec<_> = cells.flat_map(|x| (0..3).map(move |c| (x, c))).map(|(x, c)| form(x, c)).collect();
        modes.free(&forms)
    }

    #[test]
    fn constants_on_a_square_hold_a_block_from_two_by_two_cells_on() {
        let [one] = &constants(1, 1)[..] else { panic!("one body") };
        assert_eq!(one.motions.len(), 3, "{one:?}");
        assert_eq!(constants(2, 1)[0].motions, ["rotation about the line along (1, 0, 0) through (0, 0.5, 1)"]);
        assert_eq!(constants(1, 3)[0].motions, ["rotation about the line along (0, 1, 0) through (0.5, 0, 1)"]);
        assert!(constants(2, 2).is_empty());
    }
}
