//! Rows of a system by the ties and contacts that they belong to.

use super::handles::InterfaceId;
use super::model::{ContactPart, Model};
use crate::basis::{Order, ShapeTable};
use crate::linalg::Vector;

/// Some rows of one slave side of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct RowsOfSide<const N: usize> {
    /// Name of the contact.
    pub contact: String,
    /// Name of the slave side in results.
    pub slave: String,
    /// Numbers of the rows among those of the side: of functions of the multiplier, or of points where it has none.
    pub numbers: Vec<usize>,
    /// Whether they belong to points.
    pub at_points: bool,
    /// Place of the first of them: its point, or that of the largest value of its function \[length\]; `None` if it faces nothing.
    pub place: Option<Vector<N>>,
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// Returns those of `rows` that belong to contacts, side by side in the order of the contacts.
    pub(super) fn contact_rows(&self, rows: &[usize]) -> Vec<RowsOfSide<N>> {
        let mut all = Vec::new();
        for contact in &self.contacts {
            for part in &contact.parts {
                let range = part.rows();
                let numbers: Vec<usize> = rows.iter().filter(|r| range.contains(r)).map(|r| r - part.first_row).collect();
                let Some(&first) = numbers.first() else { continue };
                all.push(RowsOfSide {
                    contact: contact.name.clone(),
                    slave: part.slave.label.clone(),
                    numbers,
                    at_points: part.multiplier.is_none(),
                    place: place_of(part, first),
                });
            }
        }
        all
    }

    /// The tie or contact that a row belongs to, its name, and the number of the row among those of its slave side.
    pub(super) fn row_owner(&self, row: usize) -> Option<(InterfaceId, &str, usize)> {
        let ties = self.ties.iter().flat_map(|t| t.parts.iter().map(move |p| (t.id.into(), &t.name, p.first_row, p.num_rows)));
        let contacts = self.contacts.iter().flat_map(|c| c.parts.iter().map(move |p| (c.id.into(), &c.name, p.first_row, p.num_rows)));
        let owner = ties.chain(contacts).find(|(_, _, first, n)| (*first..first + n).contains(&row));
        owner.map(|(id, name, first, _)| (id, name.as_str(), row - first))
    }
}

/// Place of a row of a contact: its point, or that of the largest value of its function.
fn place_of<const S: usize, const N: usize>(part: &ContactPart<S, N>, row: usize) -> Option<Vector<N>> {
    let s = &part.first.segments;
    let (mut best, mut pieces): (Option<(f64, usize)>, _) = (None, 0..s.num_pieces());
    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
    if let Some(of_points) = part.first.row_of_points() {
        best = of_points.iter().position(|&j| j == row).map(|q| (1.0, q));
        pieces = 0..0;
    }
    for piece in pieces {
        let psi = part.multiplier.as_ref()?;
        psi.active(s.slave[piece], &mut ids);
        let Some(a) = ids.iter().position(|&j| j == row) else { continue };
        psi.tabulate(s.slave[piece], &s.slave_xi[s.points(piece)], Order::Values, &mut table);
        for (k, q) in s.points(piece).enumerate() {
            let value = table.values(k)[a];
            if best.is_none_or(|b| value > b.0) {
                best = Some((value, q));
            }
        }
    }
    best.map(|(_, q)| part.first.frames.x[q])
}
