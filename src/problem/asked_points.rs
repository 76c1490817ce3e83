//! Points of a slave side at which a method without multiplier is asked for lambda.
//!
//! A method may weight fluxes by bounds that depend on all points of a master's element, as [Nitsche's](crate::coupling::nitsche) does. So
//! the points that are asked for have no weight, and behind them stand the pieces of the coupling itself on the same elements of the master:
//! bounds, weights and lambda are those of the solution.

use crate::coupling::Segments;

/// Pieces of an interface by the element of their master.
#[derive(Debug)]
pub(super) struct PiecesByMaster(Vec<usize>);

impl PiecesByMaster {
    /// The pieces of `segments`.
    pub fn of<const S: usize>(segments: &Segments<S>) -> Self {
        let mut pieces: Vec<usize> = (0..segments.num_pieces()).collect();
        pieces.sort_by_key(|&piece| segments.master[piece]);
        Self(pieces)
    }

    /// Appends to the points `asked` the pieces of `own`, those of which this is the list, at the master's elements of these points.
    pub fn complete<const S: usize>(&self, own: &Segments<S>, asked: &mut Segments<S>) {
        let mut masters = asked.master.clone();
        masters.sort_unstable();
        masters.dedup();
        for master in masters {
            let first = self.0.partition_point(|&piece| own.master[piece] < master);
            for &piece in self.0[first..].iter().take_while(|&&piece| own.master[piece] == master) {
                let points = own.points(piece).map(|q| (own.slave_xi[q], own.master_xi[q], own.ds[q]));
                asked.push_piece(own.slave[piece], master, points);
            }
        }
    }
}
