//! Statements about regions: sides of bodies, parts of them, edges, corners, named points, edges and faces of meshes, and several of these
//! as one. Each is made once.

use super::builder::Problem;
use super::error::{ErrorKind, ProblemError};
use super::facet_owners::FacetOwners;
use super::handles::{BodyId, Kind, Region, RegionId, SideOf};
use super::model::{BodyRim, BodySide};
use super::regions::RegionPart;
use crate::assembly::{Halved, HalvedScratch};
use crate::basis::{Cell, Order};
use crate::geometry::{MapTable, cell, circumference};
use crate::linalg::{Matrix, Vector};
use crate::space::SideError;
use std::sync::Arc;

impl<const S: usize, const N: usize> Problem<S, N> {
    /// The region of a side, or of the points, edges or faces of a mesh that have this name, to refer to it by a handle; the same for the
    /// same name.
    ///
    /// # Errors
    /// [`ErrorKind::Side`] for a side that does not exist, [`ErrorKind::OtherProblem`].
    pub fn region<'a>(&mut self, on: impl Into<Region<'a>>) -> Result<RegionId, ProblemError> {
        let number = match on.into() {
            Region::Side(side) => self.side_number(side)?,
            Region::Made(region) if self.identity.knows(region) => region.number,
            Region::Made(_) => return Err(ProblemError::named(ErrorKind::OtherProblem, &[])),
        };
        Ok(self.region_id(number))
    }

    /// The facets of a side with their centres where `keep` holds; `None` if there are none. `what` says in labels which they are:
    /// "a.u0 where x > 0.5".
    ///
    /// # Errors
    /// [`ErrorKind::Side`] for a side that does not exist, [`ErrorKind::MixedCells`] for one of triangles and quadrilaterals.
    pub fn part(&mut self, side: SideOf<'_>, what: &str, keep: &dyn Fn(&Vector<N>) -> bool) -> Result<Option<RegionId>, ProblemError> {
        let whole = self.side(side)?;
        let space = &*whole.trace.space;
        let mut table = MapTable::new();
        // facets by shape of cell: meshes may have both
        let mut facets: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
        for e in 0..space.num_elements() {
            space.map(e, &[cell::center(space.cell(e))], Order::Values, &mut table);
            if keep(&table.x[0]) {
                facets[usize::from(space.cell(e) == Cell::Simplex)].push(e);
            }
        }
        let facets = match facets {
            [a, b] if a.is_empty() && b.is_empty() => return Ok(None),
            [a, b] if a.is_empty() || b.is_empty() => [a, b].concat(),
            _ => return Err(ProblemError::named(ErrorKind::MixedCells, &[&whole.label])),
        };
        let part = whole.part(&self.bodies, self.compiled, &facets, format!("{} where {what}", whole.label));
        Ok(Some(self.new_region(vec![RegionPart::Side(Arc::new(part))])))
    }

    /// The edge or the corner in which sides of a body meet: two in the plane, two or three in space. The same for the same sides.
    ///
    /// # Errors
    /// [`ErrorKind::Side`] for a side that does not exist, [`ErrorKind::NoRegion`] for sides of several bodies, of another number, and
    /// for those that share no function in an edge or a corner.
    pub fn meeting(&mut self, sides: &[SideOf<'_>]) -> Result<RegionId, ProblemError> {
        let met: Vec<Arc<BodySide<S, N>>> = sides.iter().map(|side| self.side(*side)).collect::<Result<_, _>>()?;
        let labels: Vec<&str> = met.iter().map(|s| s.label.as_str()).collect();
        let none = || ProblemError::named(ErrorKind::NoRegion, &labels);
        if !(2..=S + 1).contains(&met.len()) || met.iter().any(|s| s.patch != met[0].patch) {
            return Err(none());
        }
        let (patch, name) = (met[0].patch, sides.iter().map(|s| s.name).collect::<String>());
        if let Some(&number) = self.regions.rims.get(&(patch, name.clone())) {
            return Ok(self.region_id(number));
        }
        let others: Vec<_> = met[1..].iter().map(|s| &s.trace).collect();
        let rim = self.compiled.rim(&met[0].trace, &others, self.bodies[patch].extra_points);
        if rim.x.is_empty() {
            return Err(none());
        }
        let label = format!("{}.{name}", self.bodies[patch].name);
        let region = self.new_region(vec![RegionPart::Rim(Arc::new(BodyRim { patch, name: name.clone(), label, rim }))]);
        self.regions.rims.insert((patch, name), region.number);
        Ok(region)
    }

    /// Several regions as one: a force is spread over all of it, and a rigid side is all of it.
    ///
    /// # Errors
    /// Those of [`region`](Self::region).
    pub fn union<'a>(&mut self, regions: impl IntoIterator<Item = Region<'a>>) -> Result<RegionId, ProblemError> {
        let mut all: Vec<RegionPart<S, N>> = Vec::new();
        for region in regions {
            let number = self.region(region)?.number;
            for piece in self.regions.pieces(number) {
                if !all.iter().any(|known| known.is(piece)) {
                    all.push(piece.clone());
                }
            }
        }
        Ok(self.new_region(all))
    }

    /// The first two of `regions` whose sides have a facet in common, where loads of both would act twice.
    pub fn overlap(&self, regions: &[RegionId]) -> Option<[usize; 2]> {
        let mut before = FacetOwners::default();
        for (number, region) in regions.iter().enumerate().filter(|(_, region)| self.identity.knows(**region)) {
            let sides = || {
                self.regions.pieces(region.number).iter().filter_map(|piece| match piece {
                    RegionPart::Side(side) => Some(side),
                    RegionPart::Rim(_) => None,
                })
            };
            if let Some(first) = sides().find_map(|side| before.of(side).next()) {
                return Some([first, number]);
            }
            sides().for_each(|side| before.add(side, number));
        }
        None
    }

    fn new_region(&mut self, pieces: Vec<RegionPart<S, N>>) -> RegionId {
        let number = self.regions.add(pieces);
        self.region_id(number)
    }

    fn region_id(&self, number: usize) -> RegionId {
        RegionId { problem: self.identity.maker(Kind::Region, number), number }
    }

    /// Handle of a body.
    pub(super) fn body_id(&self, number: usize) -> BodyId {
        BodyId { problem: self.identity.maker(Kind::Body, number), number }
    }

    /// Number of a body.
    pub(super) fn number(&self, body: BodyId) -> Result<usize, ProblemError> {
        if self.identity.knows(body) { Ok(body.number) } else { Err(ProblemError::named(ErrorKind::OtherProblem, &[])) }
    }

    fn side_number(&mut self, side: SideOf<'_>) -> Result<usize, ProblemError> {
        let body = self.number(side.body)?;
        let found = self.regions.number(&self.bodies, body, side.name);
        found.map_err(|error| self.refused(side, error))
    }

    /// A side, which is made once.
    ///
    /// # Errors
    /// [`ErrorKind::Side`], [`ErrorKind::OtherProblem`].
    pub fn side(&mut self, side: SideOf<'_>) -> Result<Arc<BodySide<S, N>>, ProblemError> {
        let body = self.number(side.body)?;
        self.regions.side(&self.bodies, body, side.name).map_err(|error| self.refused(side, error))
    }

    fn refused(&self, side: SideOf<'_>, error: SideError) -> ProblemError {
        ProblemError::new(ErrorKind::Side(error), vec![side.body.into()], vec![self.bodies[side.body.number].name.clone()])
    }

    /// The pieces of a region.
    pub(super) fn pieces(&mut self, on: Region<'_>) -> Result<Vec<RegionPart<S, N>>, ProblemError> {
        let number = self.region(on)?.number;
        Ok(self.regions.pieces(number).to_vec())
    }

    /// Measure of the sides of a region, without edges and corners [length^S]; area of surfaces of revolution.
    ///
    /// # Errors
    /// [`ErrorKind::OtherProblem`].
    pub fn measure<'a>(&mut self, on: impl Into<Region<'a>>) -> Result<f64, ProblemError> {
        let pieces = self.pieces(on.into())?;
        Ok(pieces.iter().filter(|piece| matches!(piece, RegionPart::Side(_))).map(RegionPart::measure).sum())
    }

    /// Measure of the part of sides in which `holds` [length^S], which cuts through facets: they are halved where it jumps.
    ///
    /// # Errors
    /// Those of [`sides_of`](Self::sides_of).
    pub fn measure_where<'a>(&mut self, on: impl Into<Region<'a>>, holds: &dyn Fn(&Vector<N>) -> bool) -> Result<f64, ProblemError> {
        let (is_revolved, mut scratch, mut sum) = (self.is_revolved, HalvedScratch::default(), 0.0);
        let around = |x: &Vector<N>| if is_revolved { circumference(x) } else { 1.0 };
        let share = |x: &Vector<N>, _: &Matrix<N, S>| [if holds(x) { around(x) } else { 0.0 }];
        for side in self.sides_of(on)? {
            let halved = Halved::new(&*side.trace.space, side.degree() + 1, 1);
            sum += (0..side.trace.space.num_elements()).map(|e| halved.element(e, &mut scratch, &share)[0]).sum::<f64>();
        }
        Ok(sum)
    }

    /// Sides of bodies of this problem as one region.
    pub fn region_of_sides(&mut self, sides: Vec<Arc<BodySide<S, N>>>) -> RegionId {
        self.new_region(sides.into_iter().map(RegionPart::Side).collect())
    }

    /// The sides of a region.
    ///
    /// # Errors
    /// Those of [`region`](Self::region), [`ErrorKind::NotASide`] for one of edges or corners.
    pub fn sides_of<'a>(&mut self, on: impl Into<Region<'a>>) -> Result<Vec<Arc<BodySide<S, N>>>, ProblemError> {
        let pieces = self.pieces(on.into())?;
        let side = |piece: RegionPart<S, N>| match piece {
            RegionPart::Side(side) => Ok(side),
            RegionPart::Rim(rim) => Err(ProblemError::named(ErrorKind::NotASide, &[&rim.label])),
        };
        pieces.into_iter().map(side).collect()
    }
}
