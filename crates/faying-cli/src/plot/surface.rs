//! `interface_NAME.svg` of surfaces: the sides seen along their mean normal, coloured by a number of the multiplier or the gap, with element
//! edges; where the zone of contact is small, its surroundings.

use super::fields::Scale;
use super::solids::{Camera, SolidPiece, divided, draw, fineness, middle};
use super::{FieldPlot, PlotError};
use faying::basis::{Cell, Order};
use faying::geometry::{MapTable, cell};
use faying::linalg::Vector;
use faying::space::Space;
use faying_files::vtu::Part;

/// A number on slave sides in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceQuantity {
    /// -lambda of a contact.
    Pressure,
    /// lambda of conduction.
    Flux,
    /// The part of lambda along the normal of the master: tension is positive.
    NormalPart,
    /// The length of the rest.
    TangentialPart,
    /// The gap; of ties the jump.
    Gap,
}

impl SurfaceQuantity {
    /// The pressure and the gap of a contact; what a tie transmits, whose lambda has so many components.
    pub fn all(contact: bool, components: usize) -> &'static [Self] {
        match (contact, components) {
            (true, _) => &[Self::Pressure, Self::Gap],
            (false, 1) => &[Self::Flux],
            (false, _) => &[Self::NormalPart, Self::TangentialPart],
        }
    }

    /// Its name.
    pub fn label(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::Flux => "lambda",
            Self::NormalPart => "lambda: normal part (tension positive)",
            Self::TangentialPart => "lambda: size of the tangential part",
            Self::Gap => "gap",
        }
    }

    /// Its values at local points of an element, from the fields `lambda`, `gap` and `normal`.
    ///
    /// # Errors
    /// [`PlotError`] where the part lacks a field.
    fn values(self, part: &Part<'_, 2, 3>, element: usize, xi: &[Vector<2>]) -> Result<Vec<f64>, PlotError> {
        let values = |name: &str| {
            let lacks = || PlotError::NoField { part: part.name.clone(), field: name.to_owned(), component: 0 };
            part.fields.iter().find(|f| f.name == name).map(|f| (f.sample)(element, xi)).ok_or_else(lacks)
        };
        Ok(match self {
            // no negative zeros
            Self::Pressure => values("lambda")?.iter().map(|l| 0.0 - l).collect(),
            Self::Flux => values("lambda")?,
            Self::Gap => values("gap")?,
            Self::NormalPart | Self::TangentialPart => {
                let (lambda, normal) = (values("lambda")?, values("normal")?);
                let split = |(l, n): (&[f64], &[f64])| {
                    let along: f64 = l.iter().zip(n).map(|(l, n)| l * n).sum();
                    let across = l.iter().zip(n).map(|(l, n)| (l - along * n).powi(2)).sum::<f64>().sqrt();
                    if self == Self::NormalPart { along } else { across }
                };
                lambda.chunks(3).zip(normal.chunks(3)).map(split).collect()
            }
        })
    }
}

/// A zone of contact below this share of the extent of the sides is shown alone, with this share of its own size around it.
const SMALL: f64 = 0.25;
const AROUND: f64 = 0.6;
/// Pressures below this share of the largest belong to no zone.
const NONE: f64 = 1e-6;

/// The picture of a number on sides.
///
/// # Errors
/// [`PlotError`] where a part lacks a field or there is nothing to draw.
pub fn surface(plot: &FieldPlot<'_>, shown: SurfaceQuantity, parts: &[&Part<'_, 2, 3>]) -> Result<String, PlotError> {
    let spaces: Vec<&dyn Space<2, 3>> = parts.iter().map(|part| &*part.space).collect();
    let camera = camera(&spaces).ok_or_else(|| PlotError::Empty(plot.title.to_owned()))?;
    let zone = if matches!(shown, SurfaceQuantity::Pressure | SurfaceQuantity::Gap) { zone(parts, &camera)? } else { None };
    let kept = |part: &Part<'_, 2, 3>, element: usize| {
        let Some([low, high]) = zone else { return true };
        let corners = corners(&*part.space, element, &camera);
        (0..2).all(|k| corners.iter().any(|c| c[k] >= low[k]) && corners.iter().any(|c| c[k] <= high[k]))
    };
    let elements: Vec<(&Part<'_, 2, 3>, usize)> =
        parts.iter().flat_map(|part| (0..part.space.num_elements()).map(|e| (*part, e))).filter(|(part, e)| kept(part, *e)).collect();
    let m = fineness(elements.len());
    let (mut all, mut table) = (Vec::new(), MapTable::new());
    for (part, e) in elements {
        let cells = divided(part.space.cell(e) == Cell::Simplex, m);
        let middles: Vec<Vector<2>> = cells.iter().map(|(c, _)| Vector::from(middle(c))).collect();
        let values = shown.values(part, e, &middles)?;
        let corners: Vec<Vector<2>> = cells.iter().flat_map(|(c, _)| c.iter().map(|p| Vector::from(*p))).collect();
        part.space.map(e, &corners, Order::Values, &mut table);
        let mut places = table.x.iter().map(|x| camera.see(x));
        for ((c, edges), value) in cells.into_iter().zip(values) {
            let corners: Vec<[f64; 3]> = places.by_ref().take(c.len()).collect();
            if corners.iter().flatten().all(|v| v.is_finite()) {
                all.push(SolidPiece { corners, value, edges });
            }
        }
    }
    if all.is_empty() {
        return Err(PlotError::Empty(plot.title.to_owned()));
    }
    let scale = Scale::of_values(all.iter().map(|p| p.value));
    let label = if zone.is_some() { format!("{}, near the contact zone", plot.label) } else { plot.label.to_owned() };
    draw(&FieldPlot { label: &label, ..*plot }, all, &scale, &camera)
}

/// The corners of an element as the camera sees them.
fn corners(space: &dyn Space<2, 3>, element: usize, camera: &Camera) -> Vec<[f64; 3]> {
    let mut table = MapTable::new();
    space.map(element, &cell::corners(space.cell(element)), Order::Values, &mut table);
    table.x.iter().map(|x| camera.see(x)).collect()
}

/// The box, right and up, around the elements whose middle is pressed, with room around it; `None` where it is no small part of all.
///
/// # Errors
/// [`PlotError`] where a part lacks a field.
fn zone(parts: &[&Part<'_, 2, 3>], camera: &Camera) -> Result<Option<[[f64; 2]; 2]>, PlotError> {
    let mut seen: Vec<(f64, Vec<[f64; 3]>)> = Vec::new();
    for part in parts {
        for e in 0..part.space.num_elements() {
            let pressure = SurfaceQuantity::Pressure.values(part, e, &[cell::center(part.space.cell(e))])?;
            seen.push((pressure.first().copied().unwrap_or(0.0), corners(&*part.space, e, camera)));
        }
    }
    let most = seen.iter().map(|(p, _)| *p).fold(0.0, f64::max);
    let around = |least: f64| {
        let inside = seen.iter().filter(|(p, _)| *p > least).flat_map(|(_, corners)| corners);
        let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        inside.fold(start, |[low, high], c| [[0, 1].map(|k| low[k].min(c[k])), [0, 1].map(|k| high[k].max(c[k]))])
    };
    let size = |[low, high]: &[[f64; 2]; 2]| (high[0] - low[0]).max(high[1] - low[1]);
    let (pressed, all) = (around(NONE * most), around(f64::NEG_INFINITY));
    let room = AROUND * size(&pressed);
    let small = room > 0.0 && size(&pressed) < SMALL * size(&all);
    Ok(small.then(|| [pressed[0].map(|v| v - room), pressed[1].map(|v| v + room)]))
}

/// Least length of the mean normal of sides that are seen along it; others are seen from the corner, as bodies are.
const ONE_WAY: f64 = 0.3;

/// Along the mean normal of surfaces at the centres of their elements, on the side that the first element shows; `None` if they have none.
fn camera(spaces: &[&dyn Space<2, 3>]) -> Option<Camera> {
    let (mut sum, mut whole, mut first, mut table) = (Vector::<3>::zeros(), 0.0, None, MapTable::new());
    for space in spaces {
        for e in 0..space.num_elements() {
            space.map(e, &[cell::center(space.cell(e))], Order::Gradients, &mut table);
            let jacobian = &table.jacobian[0];
            let normal = jacobian.column(0).cross(&jacobian.column(1));
            if normal.iter().all(|v| v.is_finite()) {
                let first = *first.get_or_insert(normal);
                sum += if normal.dot(&first) < 0.0 { -normal } else { normal };
                whole += normal.norm();
            }
        }
    }
    let same = sum.norm() > ONE_WAY * whole;
    (whole > 0.0).then(|| if same { Camera::from(&sum) } else { Camera::new() })
}
