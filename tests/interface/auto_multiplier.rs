//! `MultiplierKind::Auto`: one multiplier for equal spaces, whatever body they belong to.

use faying::basis::{BSpline, Basis, Cell};
use faying::coupling::multiplier::{MultiplierKind, build};
use faying::geometry::ControlNet;
use faying::geometry::shapes::rectangle;
use faying::linalg::Vector;
use faying::space::{Body, Mapping, Mesh, MultiPatch, Near, Patch, PatchSpec, Seam, Trace};
use std::sync::Arc;

type AnyBody = Arc<dyn Body<1, 2>>;

fn spec(degree: usize, elements: usize) -> PatchSpec<2> {
    PatchSpec::new(rectangle([0.0, 0.0], [2.0, 1.0]).unwrap()).with_degree([degree; 2]).with_elements([elements, 2])
}

/// Name, number of functions, and degree per element of the multiplier of `auto` on a side.
fn chosen(trace: &Trace<1, 2>) -> (MultiplierKind, usize, Vec<usize>) {
    let kind = MultiplierKind::Auto.resolved(&*trace.space);
    let [psi, named] = [MultiplierKind::Auto, kind].map(|kind| build(&trace.space, kind, &[]).unwrap());
    assert_eq!(psi.num_functions(), named.num_functions());
    assert_eq!(MultiplierKind::Auto.lowers_ends(&*trace.space), kind.lowers_ends(&*trace.space));
    (kind, psi.num_functions(), (0..psi.num_elements()).map(|e| psi.degree(e)[0]).collect())
}

/// The kind that the degree alone decides.
fn expected(degree: usize) -> MultiplierKind {
    MultiplierKind::Lowered(if degree < 2 { 0 } else { 2 })
}

#[test]
fn splines_and_meshes_of_equal_spaces_have_the_same_multiplier() {
    for degree in 1..=4 {
        for elements in [1, 2, 5] {
            let spec = spec(degree, elements);
            let continuous: AnyBody = Arc::new(Patch::try_new(&spec.clone().with_continuity(0)).unwrap());
            let mesh: AnyBody = Arc::new(Mesh::from_patch(&spec).unwrap());
            let triangles: AnyBody = Arc::new(Mesh::from_patch(&spec.clone().with_cells(Cell::Simplex)).unwrap());
            let smooth: AnyBody = Arc::new(Patch::try_new(&spec).unwrap());
            for side in ["u0", "u1", "v0", "v1"] {
                let [of_spline, of_mesh, of_triangles, of_smooth] =
                    [&continuous, &mesh, &triangles, &smooth].map(|body| chosen(&body.trace(side).unwrap()));
                assert_eq!(of_spline.0, expected(degree), "degree {degree}, {elements} elements, {side}");
                assert_eq!(of_mesh, of_spline, "degree {degree}, {elements} elements, {side}");
                assert_eq!(of_triangles, of_spline, "degree {degree}, {elements} elements, {side}");
                assert_eq!((of_smooth.0, of_smooth.2), (of_spline.0, of_spline.2), "degree {degree}, {elements} elements, {side}");
            }
        }
    }
}

#[test]
fn the_order_of_sides_does_not_matter_and_the_least_degree_decides() {
    for degrees in [[1, 3], [2, 3], [4, 2]] {
        let part = |k: usize| -> AnyBody {
            let x = k as f64;
            let net = rectangle([x, 0.0], [x + 1.0, 1.0]).unwrap();
            Arc::new(Mesh::from_patch(&PatchSpec::new(net).with_degree([degrees[k]; 2]).with_elements([2, 2])).unwrap())
        };
        let both = MultiPatch::try_new(vec![("a".into(), part(0)), ("b".into(), part(1))], &[], Near::Exact).unwrap();
        let [one, other] = [["a.v0", "b.v0"], ["b.v0", "a.v0"]].map(|sides| chosen(&both.trace_of(&sides).unwrap()));
        assert_eq!(one.0, expected(*degrees.iter().min().unwrap()));
        assert_eq!((one.0, one.1), (other.0, other.1));
        assert!(one.2.iter().rev().eq(&other.2) || one.2.iter().skip(2).chain(&one.2[..2]).eq(&other.2), "{one:?} and {other:?}");
    }
}

/// The area between a drop, one cubic arc from its tip back to it, and a smaller one inside.
fn drop() -> ControlNet<2, 2> {
    let outer = [[0.0, 0.0], [3.0, 2.0], [-3.0, 2.0], [0.0, 0.0]];
    let inner = outer.map(|[x, y]| [0.5 * x, 0.9 + 0.5 * (y - 0.9)]);
    let points = outer.iter().chain(&inner).map(|&p| Vector::from(p)).collect();
    ControlNet::try_new([BSpline::uniform(3, 1, 2), BSpline::uniform(1, 1, 0)], points, None).unwrap()
}

#[test]
fn closed_sides_of_any_number_of_elements_have_the_multiplier_of_their_degree() {
    for degree in 2..=4 {
        for elements in [1, 2, 4] {
            let spec = PatchSpec::new(drop()).with_degree([degree; 2]).with_elements([elements, 1]).with_mapping(Mapping::Exact);
            let bodies: [AnyBody; 2] = [Arc::new(Patch::try_new(&spec).unwrap()), Arc::new(Mesh::from_patch(&spec).unwrap())];
            for body in bodies {
                let ring = MultiPatch::try_new(vec![("a".into(), body)], &[Seam::new((0, "u0"), (0, "u1"))], Near::Exact).unwrap();
                let trace = ring.trace("a.v0").unwrap();
                let (kind, functions, degrees) = chosen(&trace);
                assert_eq!(trace.space.num_elements(), elements);
                assert_eq!((kind, degrees), (expected(degree), vec![degree - 2; elements]));
                assert!(functions >= degree - 1 && functions <= elements * (degree - 1), "{functions} functions");
            }
        }
    }
}
