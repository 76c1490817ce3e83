//! Statements about interfaces: ties and contacts.

use super::builder::Problem;
use super::changing::Changing;
use super::coupled::{Contact, ContactOptions, Coupled, Opponent, StatedOpponent, Tie, TieOptions, TiePair};
use super::data::Data;
use super::error::{ErrorKind, ProblemError};
use super::handles::{Kind, Sides};
use super::model::BodySide;
use super::start::Start;
use crate::contact::{Cone, Lagrange, Obstacle};
use crate::coupling::Mortar;
use std::sync::Arc;

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Ties slave sides to master sides: every slave to all masters, which together cover it.
    ///
    /// # Errors
    /// [`ErrorKind::Side`], [`ErrorKind::NoMaster`], [`ErrorKind::OtherProblem`]. Sides that do not meet are found when the problem is
    /// assembled.
    pub fn tie<'a, 'b>(&mut self, slaves: impl Into<Sides<'a>>, masters: impl Into<Sides<'b>>) -> Result<&mut Tie<S, N>, ProblemError> {
        let (slaves, masters) = (self.sides(slaves.into())?, self.sides(masters.into())?);
        let pair = |slave| TiePair { slave, masters: masters.clone(), explained: None, is_asked: true };
        Ok(self.tie_pairs(slaves.into_iter().map(pair).collect()))
    }

    /// Ties pairs of sides, found by a search.
    pub(super) fn tie_pairs(&mut self, pairs: Vec<TiePair<S, N>>) -> &mut Tie<S, N> {
        let name = pairs.first().map_or_else(String::new, |p| format!("{} - {}", p.slave.label, labels(&p.masters)));
        let own = TieOptions { pairs, coupling: Arc::new(Mortar), tolerance: None };
        let number = self.ties.len();
        let maker = self.identity.maker(Kind::Tie, number);
        self.ties.push(Coupled::new(maker, number, name, own));
        &mut self.ties[number]
    }

    /// Presses slave sides against other sides or a rigid obstacle.
    ///
    /// # Errors
    /// [`ErrorKind::Side`], [`ErrorKind::NoMaster`], [`ErrorKind::OtherProblem`], and [`ErrorKind::Scalar`] in problems of one component.
    pub fn contact<'a, 'b>(
        &mut self,
        slaves: impl Into<Sides<'a>>,
        opponent: impl Into<Opponent<'b, S, N>>,
    ) -> Result<&mut Contact<S, N>, ProblemError> {
        let slaves = self.sides(slaves.into())?;
        let (text, faced) = match opponent.into() {
            Opponent::Sides(masters) => {
                let masters = self.sides(masters)?;
                (labels(&masters), StatedOpponent::Sides(masters))
            }
            Opponent::Obstacle(shape) => {
                let at_rest = Changing(Arc::new(move |_| Box::new(Arc::clone(&shape)) as Box<dyn Obstacle<S, N>>));
                ("obstacle".to_owned(), StatedOpponent::Obstacle { at_rest, changes: false })
            }
            Opponent::Changing(at_rest) => ("obstacle".to_owned(), StatedOpponent::Obstacle { at_rest, changes: true }),
        };
        let name = format!("{} - {text}", labels(&slaves));
        if self.components() == 1 {
            return Err(ProblemError::named(ErrorKind::Scalar, &[&name]));
        }
        let own = ContactOptions {
            slaves,
            faced,
            method: Arc::new(Lagrange),
            cone: Cone::Coefficients,
            gap: Data::gap(),
            reach: None,
            start: Start::default(),
            symmetry: false,
            adjust: false,
            motion: Vec::new(),
            forces: Vec::new(),
        };
        let number = self.contacts.len();
        let maker = self.identity.maker(Kind::Contact, number);
        self.contacts.push(Coupled::new(maker, number, name, own));
        Ok(&mut self.contacts[number])
    }
}

/// Names of sides in a sentence.
fn labels<const S: usize, const N: usize>(sides: &[Arc<BodySide<S, N>>]) -> String {
    sides.iter().map(|s| s.label.as_str()).collect::<Vec<_>>().join(", ")
}
