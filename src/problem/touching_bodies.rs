//! Statements about whole bodies: sides that touch are found, and glued or tied.

use super::builder::Problem;
use super::coupled::{Tie, TiePair};
use super::error::{ErrorKind, ProblemError};
use super::facets_apart::FacetsApart;
use super::handles::{BodyId, Kind, SideOf, Statement};
use super::said::Gluing;
use super::touching::{Finding, PairedSides, Search, TouchError};
use crate::space::Near;

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Ties the sides of bodies that touch and that no statement before this one joins or names as a pair. Among sides that touch one
    /// another the slaves are those that are fully covered, or else the finer ones. `tolerance`: largest distance of the centres of
    /// facets \[length\]; `None`: as far as the sag of the facets explains.
    ///
    /// # Errors
    /// [`ErrorKind::NothingTouches`], [`ErrorKind::TouchesBeyond`], [`ErrorKind::Side`], [`ErrorKind::OtherProblem`].
    pub fn tie_touching(&mut self, bodies: &[BodyId], tolerance: Option<f64>) -> Result<&mut Tie<S, N>, ProblemError> {
        let numbers = self.numbers(bodies)?;
        let found = self.search(|search| search.tie_touching(&numbers, tolerance));
        let couples = found.map_err(|error| self.not_found(&error, bodies))?;
        let tie = self.tie_couples(couples);
        if let Some(distance) = tolerance {
            tie.tolerance(distance);
        }
        Ok(tie)
    }

    /// Glues the sides of bodies that touch and that no statement before this one joins or names as a pair: they share their unknowns.
    /// `tolerance` as in [`tie_touching`](Self::tie_touching).
    ///
    /// # Errors
    /// Those of [`tie_touching`](Self::tie_touching).
    pub fn glue_touching(&mut self, bodies: &[BodyId], tolerance: Option<f64>) -> Result<Statement, ProblemError> {
        let numbers = self.numbers(bodies)?;
        let found = self.search(|search| search.tie_touching(&numbers, tolerance));
        let couples = found.map_err(|error| self.not_found(&error, bodies))?;
        let of = self.statement();
        couples.into_iter().for_each(|couple| self.push_couple(of, couple));
        Ok(of)
    }

    /// Glues the sides of a couple that a search found.
    pub fn glue_couple(&mut self, couple: PairedSides<S, N>) -> Statement {
        let of = self.statement();
        self.push_couple(of, couple);
        of
    }

    fn push_couple(&mut self, of: Statement, couple: PairedSides<S, N>) {
        let exact = couple.masters.iter().chain([&couple.slave]).all(|side| self.bodies[side.patch].exact_map);
        let near = match couple.tolerance {
            Some(distance) => Near::Given(distance),
            None if exact => Near::Exact,
            None if couple.is_named => Near::Corners,
            None => Near::Facets,
        };
        self.gluings.push(Gluing { of, slave: couple.slave, masters: couple.masters, near: Some(near) });
    }

    /// Ties the slaves of couples that a search found to their masters.
    pub fn tie_couples(&mut self, couples: Vec<PairedSides<S, N>>) -> &mut Tie<S, N> {
        let pair = |c: PairedSides<S, N>| TiePair { slave: c.slave, masters: c.masters, explained: c.explained, is_asked: false };
        self.tie_pairs(couples.into_iter().map(pair).collect())
    }

    /// Lets `ask` search among the bodies for sides that touch; the search begins with no sides joined, and states nothing.
    pub fn look_for_touching<R>(&mut self, ask: impl FnOnce(&mut Search<'_, S, N>) -> R) -> R {
        let Self { compiled, bodies, regions, .. } = self;
        let mut source = |body: usize, name: &str| regions.side(bodies, body, name);
        ask(&mut Search::new(*compiled, bodies, &mut source))
    }

    /// The slave sides of a tie with their masters, by labels.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`] for what is no tie of this problem.
    pub fn pairs(&self, tie: impl Into<Statement>) -> Result<Vec<(&str, Vec<&str>)>, ProblemError> {
        let of = tie.into();
        let tie = self.ties.get(of.number).filter(|_| of.kind == Kind::Tie && self.identity.knows(of));
        let tie = tie.ok_or_else(|| ProblemError::named(ErrorKind::OtherProblem, &[]))?;
        let pairs = tie.own.pairs.iter();
        Ok(pairs.map(|pair| (pair.slave.label.as_str(), pair.masters.iter().map(|m| m.label.as_str()).collect())).collect())
    }

    /// Whether a side is glued or tied to another one.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`].
    pub fn is_coupled(&self, side: SideOf<'_>) -> Result<bool, ProblemError> {
        let number = self.number(side.body)?;
        let glued = self.gluings.iter().flat_map(|g| g.masters.iter().chain([&g.slave]));
        let mut all = glued.chain(self.ties.iter().flat_map(|t| &t.own.pairs).flat_map(|p| p.masters.iter().chain([&p.slave])));
        Ok(all.any(|s| s.patch == number && s.side == side.name))
    }

    fn numbers(&self, bodies: &[BodyId]) -> Result<Vec<usize>, ProblemError> {
        bodies.iter().map(|body| self.number(*body)).collect()
    }

    /// Asks a search that knows all sides which are joined or named as pairs; what it finds is kept for warnings.
    fn search<R>(&mut self, ask: impl FnOnce(&mut Search<'_, S, N>) -> R) -> R {
        let Self { compiled, bodies, regions, ties, contacts, gluings, findings, .. } = self;
        let mut source = |body: usize, name: &str| regions.side(bodies, body, name);
        let mut search = Search::new(*compiled, bodies, &mut source);
        let couple = |slave: &_, masters: &[_]| PairedSides {
            slave: std::sync::Arc::clone(slave),
            masters: masters.to_vec(),
            tolerance: None,
            is_named: true,
            explained: None,
        };
        gluings.iter().for_each(|g| search.join(&couple(&g.slave, &g.masters)));
        ties.iter().flat_map(|t| &t.own.pairs).for_each(|p| search.join(&couple(&p.slave, &p.masters)));
        for contact in contacts.iter() {
            let masters = contact.masters();
            search.contact(&contact.own.slaves, masters);
            for (slave, master) in contact.own.slaves.iter().flat_map(|s| masters.iter().map(move |m| (s, m))) {
                search.exclude((slave.patch, &slave.side), (master.patch, &master.side));
            }
        }
        let found = ask(&mut search);
        findings.extend(search.findings.iter().filter_map(apart));
        found
    }

    fn not_found(&self, error: &TouchError<S, N>, bodies: &[BodyId]) -> ProblemError {
        let of = bodies.iter().map(|body| (*body).into()).collect();
        let labels = |sides: &[std::sync::Arc<super::model::BodySide<S, N>>; 2]| sides.iter().map(|s| s.label.clone()).collect();
        match error {
            TouchError::Side { patch, error, .. } => {
                ProblemError::new(ErrorKind::Side(error.clone()), of, vec![self.bodies[*patch].name.clone()])
            }
            TouchError::Beyond { sides } => ProblemError::new(ErrorKind::TouchesBeyond, of, labels(sides)),
            TouchError::Nothing { nearest: Some(pair) } => {
                ProblemError::new(ErrorKind::NothingTouches { distance: Some(pair.facing.distance) }, of, labels(&pair.sides))
            }
            TouchError::Nothing { nearest: None } => ProblemError::new(ErrorKind::NothingTouches { distance: None }, of, Vec::new()),
        }
    }
}

/// The data of a finding about sides that are, or are not, tied.
pub(super) fn apart<const S: usize, const N: usize>(finding: &Finding<S, N>) -> Option<FacetsApart> {
    let (sides, clearance, is_tied) = match finding {
        Finding::NotTied { sides, clearance } => (sides.iter().map(|s| s.label.clone()).collect(), clearance, false),
        Finding::NotExplained { slave, masters, clearance } => {
            (std::iter::once(slave).chain(masters).map(|s| s.label.clone()).collect(), clearance, true)
        }
        _ => return None,
    };
    Some(FacetsApart { sides, mean: clearance.mean(), greatest: clearance.greatest, explained: clearance.allowed(), is_tied })
}
