//! Bodies that share functions: glued sides, and points in which bodies hang together.

use super::builder::Problem;
use super::error::{ErrorKind, ProblemError};
use super::glued::{Glued, SharedPoint};
use super::handles::{BodyId, Sides, Statement};
use super::said::{Gluing, Shared};
use crate::linalg::Vector;
use crate::space::Near;

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Glues sides to others of the same grid and functions, which together cover them: they share their unknowns. `near`: distance of
    /// points that are one; `None`: round-off of sides that lie exactly on their geometry, else corners of their elements.
    ///
    /// # Errors
    /// [`ErrorKind::Side`], [`ErrorKind::NoMaster`], [`ErrorKind::OtherProblem`]. Sides that do not fit are found when the problem is
    /// assembled.
    pub fn glue<'a, 'b>(
        &mut self,
        slaves: impl Into<Sides<'a>>,
        masters: impl Into<Sides<'b>>,
        near: Option<Near>,
    ) -> Result<Statement, ProblemError> {
        let masters = self.sides(masters.into())?;
        let slaves: Vec<_> = slaves.into().0.into_iter().map(|side| self.sides_of(side)).collect::<Result<_, _>>()?;
        let slaves = slaves.concat();
        let of = self.statement();
        self.gluings.extend(slaves.into_iter().map(|slave| Gluing { of, slave, masters: masters.clone(), near }));
        Ok(of)
    }

    /// Makes functions of bodies one that are interpolated at the same point `x` \[length\]: the bodies hang together there.
    ///
    /// # Errors
    /// [`ErrorKind::NoFunction`], [`ErrorKind::OtherProblem`].
    pub fn share(&mut self, functions: &[(BodyId, usize)], x: [f64; N]) -> Result<Statement, ProblemError> {
        let mut all = Vec::with_capacity(functions.len());
        for &(body, function) in functions {
            let number = self.number(body)?;
            let functions = self.bodies[number].body.space().num_functions();
            if function >= functions {
                let names = vec![self.bodies[number].name.clone()];
                return Err(ProblemError::new(ErrorKind::NoFunction { function, functions }, vec![body.into()], names));
            }
            all.push((number, function));
        }
        self.shared.push(Shared { functions: all, x: Vector::from(x) });
        Ok(self.statement())
    }

    /// Functions that glued bodies share.
    pub(super) fn joined(&self, errors: &mut Vec<ProblemError>) -> (Glued, Vec<SharedPoint<N>>) {
        let components = self.components().max(1);
        let functions = self.bodies.last().map_or(0, |b| b.range().end) / components;
        let mut glued = Glued::new(components, functions, self.bodies.len());
        for Gluing { of, slave, masters, near } in &self.gluings {
            let exact = masters.iter().chain([slave]).all(|s| self.bodies[s.patch].exact_map);
            let near = near.unwrap_or(if exact { Near::Exact } else { Near::Corners });
            if let Err(error) = glued.add(&self.bodies, slave, masters, near) {
                let labels = std::iter::once(slave).chain(masters).map(|side| side.label.clone()).collect();
                errors.push(ProblemError::new(ErrorKind::Glue(error), vec![*of], labels));
            }
        }
        let mut hinges = Vec::new();
        for Shared { functions, x } in &self.shared {
            for pair in functions.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|(body, function)| self.bodies[body].field.first / components + function);
                glued.same(a, b);
                hinges.push(SharedPoint { patches: [pair[0].0, pair[1].0], functions: [pair[0].1, pair[1].1], x: *x });
            }
        }
        glued.finish();
        (glued, hinges)
    }
}
