//! Which rigid motions the supports leave: rank of the constraints on the rigid modes of every body.
//!
//! Modes of a body: translations t, and in elasticity rotations w about the middle of the model, scaled by its size L:
//! u(x) = t + w x (x - center) / L. Every support is a row d . u_b(x) = 0, every tie a row d . (u_b(x) - u_c(x)) = 0.

use crate::linalg::Vector;
use nalgebra::{DMatrix, DVector};

/// Eigenvalues of the Gram matrix below this share of the largest count as zero: singular values below 1e-6.
const RANK: f64 = 1e-12;
/// Entries of a motion below this are not named.
const NEGLIGIBLE: f64 = 1e-5;

/// One condition d . (sum of sign u_b(x)) = 0; terms (body, sign, x).
#[derive(Clone, Debug)]
pub struct RigidRow<const N: usize> {
    /// Bodies that take part.
    pub terms: Vec<(usize, f64, Vector<N>)>,
    /// Direction, of length 1; for a scalar unknown only its first entry is used and is 1.
    pub direction: Vector<N>,
}

/// The motions that are left to a body, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FreeBody {
    /// Number of the body.
    pub body: usize,
    /// "translation x", "rotation", "rotation about (0, 1)", "constant".
    pub motions: Vec<String>,
}

/// Scales and modes of the bodies.
#[derive(Clone, Copy, Debug)]
pub struct RigidModes<const N: usize> {
    /// Number of bodies.
    pub bodies: usize,
    /// Components of the unknown: 1 (one mode, the constant) or N.
    pub components: usize,
    /// Middle of the model.
    pub center: Vector<N>,
    /// Size of the model.
    pub size: f64,
}

impl<const N: usize> RigidModes<N> {
    /// Modes per body.
    pub(super) fn modes(&self) -> usize {
        if self.components == 1 { 1 } else { N + N * (N - 1) / 2 }
    }

    /// d . u(x) for every mode.
    fn row(&self, direction: &Vector<N>, x: &Vector<N>) -> Vec<f64> {
        if self.components == 1 {
            return vec![1.0];
        }
        let r = (x - self.center) / self.size;
        let mut row: Vec<f64> = direction.iter().copied().collect();
        for i in 0..N {
            for j in i + 1..N {
                row.push(direction[j] * r[i] - direction[i] * r[j]); // rotation in the plane (i, j)
            }
        }
        row
    }

    /// A row as a linear form of all modes.
    pub(super) fn form(&self, row: &RigidRow<N>) -> DVector<f64> {
        let m = self.modes();
        let mut dense = DVector::<f64>::zeros(m * self.bodies);
        for (body, sign, x) in &row.terms {
            for (k, value) in self.row(&row.direction, x).into_iter().enumerate() {
                dense[m * body + k] += sign * value;
            }
        }
        dense
    }

    /// The work of a force and its moment about the origin on the modes of one body.
    pub(super) fn work(&self, force: &[f64; 3], moment: &[f64; 3]) -> Vec<f64> {
        if self.components == 1 {
            return vec![force[0]];
        }
        let center = Vector::<3>::from_fn(|k, _| if k < N { self.center[k] } else { 0.0 });
        let about = (Vector::<3>::from(*moment) - center.cross(&Vector::<3>::from(*force))) / self.size;
        let mut work = force[..N].to_vec();
        // the plane (x, z) turns about -y
        work.extend(if N == 2 { vec![about[2]] } else { vec![about[2], -about[1], about[0]] });
        work
    }

    /// The motions that `rows` leave, orthonormal columns in the modes of all bodies.
    pub(super) fn null(&self, rows: &[RigidRow<N>]) -> DMatrix<f64> {
        let n = self.modes() * self.bodies;
        let mut gram = DMatrix::<f64>::zeros(n, n);
        for row in rows {
            let dense = self.form(row);
            gram.syger(1.0, &dense, &dense, 1.0);
        }
        gram.fill_upper_triangle_with_lower_triangle();
        let eigen = gram.symmetric_eigen();
        let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
        let null: Vec<usize> = (0..n).filter(|&k| eigen.eigenvalues[k] <= RANK * largest.max(f64::MIN_POSITIVE)).collect();
        DMatrix::from_fn(n, null.len(), |i, k| eigen.eigenvectors[(i, null[k])])
    }

    /// The motions that `rows` leave.
    pub fn free(&self, rows: &[RigidRow<N>]) -> Vec<FreeBody> {
        let (m, null) = (self.modes(), self.null(rows));
        (0..self.bodies)
            .filter_map(|body| {
                let motions = self.name(&null.rows(m * body, m).into_owned());
                (!motions.is_empty()).then_some(FreeBody { body, motions })
            })
            .collect()
    }

    /// Words for the span of `vectors`.
    pub(super) fn name(&self, vectors: &DMatrix<f64>) -> Vec<String> {
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
            if share > 1.0 - NEGLIGIBLE {
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
            named.push(self.oblique(v));
        }
        named
    }

    /// A motion that is no single mode.
    fn oblique(&self, v: &DVector<f64>) -> String {
        let turning = (N..v.len()).any(|k| v[k].abs() > NEGLIGIBLE * v.norm());
        if N == 2 && turning {
            let w = v[2] / self.size;
            let (x, y) = (self.center[0] - v[1] / w, self.center[1] + v[0] / w);
            return format!("rotation about ({}, {})", short(x, self.size), short(y, self.size));
        }
        if turning {
            return self.turn(v);
        }
        let list: Vec<String> = (0..N).map(|k| short(v[k] / v.norm(), 1.0)).collect();
        format!("translation along ({})", list.join(", "))
    }
}

impl<const N: usize> RigidModes<N> {
    /// A motion of space that turns: about a line, or along it, too.
    ///
    /// With u = t + w x r, r from the middle of the model: the line runs along w through r = (w x t) / w.w if w.t = 0.
    fn turn(&self, v: &DVector<f64>) -> String {
        let t = Vector::<3>::new(v[0], v[1], v[2]);
        // planes (x, y), (x, z), (y, z): the second turns about -y
        let w = Vector::<3>::new(v[5], -v[4], v[3]) / self.size;
        let list = |x: &Vector<3>, scale: f64| x.iter().map(|&c| short(c, scale)).collect::<Vec<_>>().join(", ");
        let along = w / w[w.iamax()];
        if w.dot(&t).abs() > NEGLIGIBLE * w.norm() * v.norm() {
            return format!("screw motion along ({})", list(&along, 1.0));
        }
        let center = Vector::<3>::from_fn(|k, _| if k < N { self.center[k] } else { 0.0 });
        let point = center + w.cross(&t) / w.norm_squared();
        // the point of the line that is nearest to the origin
        let point = point - along * (point.dot(&along) / along.norm_squared());
        format!("rotation about the line along ({}) through ({})", list(&along, 1.0), list(&point, self.size))
    }
}

/// Three digits of `x`, rounded to zero below 1e-6 of `scale`.
fn short(x: f64, scale: f64) -> String {
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
        RigidModes { bodies, components: 2, center: Vector::from([0.5, 0.5]), size: 1.0 }
    }
    fn fixed(body: usize, c: usize, x: [f64; 2]) -> RigidRow<2> {
        RigidRow { terms: vec![(body, 1.0, Vector::from(x))], direction: Vector::from_fn(|k, _| f64::from(u8::from(k == c))) }
    }

    #[test]
    fn a_body_without_supports_has_all_motions() {
        let free = modes(1).free(&[]);
        assert_eq!(free, [FreeBody { body: 0, motions: vec!["translation x".into(), "translation y".into(), "rotation".into()] }]);
    }

    #[test]
    fn rollers_leave_a_translation_and_a_hinge_a_rotation() {
        let roller = [fixed(0, 1, [0.0, 0.0]), fixed(0, 1, [1.0, 0.0])];
        assert_eq!(modes(1).free(&roller)[0].motions, ["translation x"]);
        let hinge = [fixed(0, 0, [0.0, 1.0]), fixed(0, 1, [0.0, 1.0])];
        assert_eq!(modes(1).free(&hinge)[0].motions, ["rotation about (0, 1)"]);
        let clamped = [fixed(0, 0, [0.0, 0.0]), fixed(0, 1, [0.0, 0.0]), fixed(0, 1, [1.0, 0.0])];
        assert!(modes(1).free(&clamped).is_empty());
    }

    #[test]
    fn a_solid_on_two_hinges_turns_about_their_line() {
        let modes = RigidModes::<3> { bodies: 1, components: 3, center: Vector::from([0.5, 0.5, 0.5]), size: 2.0 };
        let at = |c: usize, x: [f64; 3]| RigidRow::<3> {
            terms: vec![(0, 1.0, Vector::from(x))],
            direction: Vector::from_fn(|k, _| f64::from(u8::from(k == c))),
        };
        // all of (1, 0, 2), x and z of (1, 3, 2): the line x = 1, z = 2
        let mut rows: Vec<_> = (0..3).map(|c| at(c, [1.0, 0.0, 2.0])).collect();
        rows.extend([at(0, [1.0, 3.0, 2.0]), at(2, [1.0, 3.0, 2.0])]);
        assert_eq!(modes.free(&rows)[0].motions, ["rotation about the line along (0, 1, 0) through (1, 0, 2)"]);
    }

    #[test]
    fn a_frictionless_tie_leaves_only_sliding_to_the_upper_body() {
        let mut rows = vec![fixed(0, 0, [0.0, 0.0]), fixed(0, 1, [0.0, 0.0]), fixed(0, 1, [1.0, 0.0])];
        for x in [0.0, 0.5, 1.0] {
            let at = Vector::from([x, 0.5]);
            rows.push(RigidRow { terms: vec![(1, 1.0, at), (0, -1.0, at)], direction: Vector::from([0.0, 1.0]) });
        }
        assert_eq!(modes(2).free(&rows), [FreeBody { body: 1, motions: vec!["translation x".into()] }]);
    }
}
