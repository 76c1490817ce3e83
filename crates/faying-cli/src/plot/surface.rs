//! `interface_NAME.svg` of a surface: the side seen along its mean normal, coloured by a number of its multiplier, with element edges.

use super::fields::Scale;
use super::solids::{Camera, SolidPiece, divided, draw, fineness, middle};
use super::{FieldPlot, PlotError};
use faying::basis::{Cell, Order};
use faying::geometry::{MapTable, cell};
use faying::linalg::Vector;
use faying::space::Space;
use faying_files::vtu::Part;

/// The number that a picture shows of the components of a field at a point.
pub type Shown = fn(&[f64]) -> f64;

/// The picture of what is `shown` of the field of a surface.
///
/// # Errors
/// [`PlotError`] where the part lacks the field or there is nothing to draw.
pub fn surface(plot: &FieldPlot<'_>, shown: Shown, part: &Part<'_, 2, 3>) -> Result<String, PlotError> {
    let lacks = || PlotError::NoField { part: part.name.clone(), field: plot.field.to_owned(), component: plot.component };
    let field = part.fields.iter().find(|f| f.name == plot.field && f.components > 0).ok_or_else(lacks)?;
    let camera = Camera::from(&mean_normal(&*part.space).ok_or_else(|| PlotError::Empty(plot.title.to_owned()))?);
    let m = fineness(part.space.num_elements());
    let (mut all, mut table) = (Vec::new(), MapTable::new());
    for e in 0..part.space.num_elements() {
        let cells = divided(part.space.cell(e) == Cell::Simplex, m);
        let middles: Vec<Vector<2>> = cells.iter().map(|(c, _)| Vector::from(middle(c))).collect();
        let values = (field.sample)(e, &middles);
        let corners: Vec<Vector<2>> = cells.iter().flat_map(|(c, _)| c.iter().map(|p| Vector::from(*p))).collect();
        part.space.map(e, &corners, Order::Values, &mut table);
        let mut places = table.x.iter().map(|x| camera.see(x));
        for (k, (c, edges)) in cells.into_iter().enumerate() {
            let corners: Vec<[f64; 3]> = places.by_ref().take(c.len()).collect();
            let value = values.get(k * field.components..(k + 1) * field.components).map_or(f64::NAN, shown);
            if corners.iter().flatten().all(|v| v.is_finite()) {
                all.push(SolidPiece { corners, value, edges });
            }
        }
    }
    if all.is_empty() {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let scale = Scale::of_values(all.iter().map(|p| p.value));
    draw(plot, all, &scale, &camera)
}

/// The mean normal of a surface at the centres of its elements, on the side that its first element shows; `None` if it has none.
fn mean_normal(space: &dyn Space<2, 3>) -> Option<Vector<3>> {
    let (mut sum, mut first, mut table) = (Vector::<3>::zeros(), None, MapTable::new());
    for e in 0..space.num_elements() {
        space.map(e, &[cell::center(space.cell(e))], Order::Gradients, &mut table);
        let jacobian = &table.jacobian[0];
        let normal = jacobian.column(0).cross(&jacobian.column(1));
        if normal.iter().all(|v| v.is_finite()) {
            let first = *first.get_or_insert(normal);
            sum += if normal.dot(&first) < 0.0 { -normal } else { normal };
        }
    }
    (sum.norm() > 0.0).then_some(sum)
}
