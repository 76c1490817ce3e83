//! Maps, spaces and bodies of both backends, of traces of any body and of deformed spaces.

use faying::basis::{BSpline, Basis, Cell, Elements, LagrangeLine, Order, Polynomials, Rational, ShapeTable, TensorProduct};
use faying::check;
use faying::geometry::{Bounds, ControlNet, ControlPoints, Embedded, Embedding, Geometry, MapTable, shapes};
use faying::linalg::{Matrix, Vector};
use faying::space::{
    BasisKind, Body, Deformed, FunctionSpace, Mapping, Mesh, Patch, PatchSpec, SideError, Space, SpecError, Trace, refine,
};
use std::sync::Arc;

/// A few plane geometries: straight, curved, left-handed, closed, collapsed, with a kink.
fn plane() -> Vec<(&'static str, ControlNet<2, 2>)> {
    let mut mirrored = shapes::annulus_sector([0.3, -0.2], [1.0, 2.0], [20.0, 130.0]).unwrap();
    mirrored.points.iter_mut().for_each(|p| p[0] = -p[0]);
    let mut wavy = shapes::rectangle([0.0, 0.0], [2.0, 1.0]).unwrap().elevate(0, 2).elevate(1, 1);
    for (i, p) in wavy.points.iter_mut().enumerate() {
        p[0] += 0.05 * (3.1 * i as f64).sin();
        p[1] += 0.08 * (1.7 * i as f64).cos();
    }
    vec![
        ("rectangle", shapes::rectangle([-1.0, 0.5], [2.0, 1.5]).unwrap()),
        ("ring", shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [0.0, 90.0]).unwrap()),
        ("left-handed ring of two arcs", mirrored),
        ("full ring", shapes::annulus_sector([0.0, 0.0], [0.5, 1.0], [0.0, 360.0]).unwrap()),
        ("half disc", shapes::disc_sector([1.0, 4.0], 3.0, [180.0, 360.0]).unwrap()),
        ("plate", shapes::plate_with_hole(1.0, 4.0).unwrap()),
        ("wavy", wavy),
    ]
}

fn spec(net: &ControlNet<2, 2>, degree: [usize; 2]) -> PatchSpec<2> {
    let b = [vec![0.0, 0.2, 0.5, 0.6, 1.0], vec![0.0, 0.5, 0.8, 1.0]];
    PatchSpec::new(net.clone()).with_degree(degree).with_breakpoints(b)
}

fn pass(name: &str, body: &dyn Body<1, 2>) {
    check::closed_body(body).unwrap_or_else(|e| panic!("{name}: {e}"));
}

#[test]
fn spline_patches_keep_the_contract_of_bodies() {
    for (name, net) in plane() {
        for degree in [[1, 1], [2, 2], [3, 1], [2, 4]] {
            for basis in [BasisKind::Auto, BasisKind::BSpline] {
                let spec = spec(&net, degree).with_basis(basis);
                pass(&format!("{name}, {degree:?}, {basis:?}"), &Patch::<1, 2>::try_new(&spec).unwrap());
                pass(&format!("{name}, {degree:?}, {basis:?}, C0"), &Patch::<1, 2>::try_new(&spec.with_continuity(0)).unwrap());
            }
        }
    }
}

#[test]
fn lagrange_meshes_keep_the_contract_of_bodies() {
    for (name, net) in plane() {
        for mapping in [Mapping::Isoparametric, Mapping::Exact] {
            for degree in [[1, 1], [2, 3], [5, 2]] {
                let mesh = Mesh::<1, 2>::from_patch(&spec(&net, degree).with_mapping(mapping)).unwrap();
                pass(&format!("{name}, {degree:?}, {mapping:?}"), &mesh);
            }
            for degree in 1..=4 {
                let spec = spec(&net, [degree; 2]).with_mapping(mapping).with_cells(Cell::Simplex);
                pass(&format!("{name}, triangles, {degree}, {mapping:?}"), &Mesh::<1, 2>::from_patch(&spec).unwrap());
            }
        }
    }
}

#[test]
fn bodies_in_space_keep_the_contract_of_bodies() {
    let ring = shapes::annulus_sector([0.0, 0.0], [1.0, 2.0], [90.0, 0.0]).unwrap().extrude(0.5);
    let disc = shapes::disc_sector([0.0, 0.0], 1.0, [0.0, 180.0]).unwrap().extrude(2.0);
    let brick = shapes::brick([0.0, 0.0, -1.0], [1.0, 2.0, 0.5]).unwrap();
    for (name, net) in [("left-handed ring", ring), ("half cylinder", disc), ("brick", brick)] {
        let spec = PatchSpec::new(net).with_elements([2, 2, 1]);
        for basis in [BasisKind::Auto, BasisKind::BSpline] {
            let patch = Patch::<2, 3>::try_new(&spec.clone().with_basis(basis)).unwrap();
            check::closed_body(&patch).unwrap_or_else(|e| panic!("{name}, {basis:?}: {e}"));
        }
        for mapping in [Mapping::Isoparametric, Mapping::Exact] {
            let mesh = Mesh::<2, 3>::from_patch(&spec.clone().with_mapping(mapping)).unwrap();
            check::closed_body(&mesh).unwrap_or_else(|e| panic!("{name}, {mapping:?}: {e}"));
        }
        for degree in 1..=4 {
            let spec = spec.clone().with_cells(Cell::Simplex).with_degree([degree; 3]);
            let mesh = Mesh::<2, 3>::from_patch(&spec).unwrap();
            check::closed_body(&mesh).unwrap_or_else(|e| panic!("{name}, tetrahedra of degree {degree}: {e}"));
            let exact = Mesh::<2, 3>::from_patch(&spec.with_mapping(Mapping::Exact));
            if mesh.collapsed_sides().is_empty() {
                check::closed_body(&exact.unwrap()).unwrap_or_else(|e| panic!("{name}, tetrahedra on the exact map, {degree}: {e}"));
            } else {
                assert_eq!(exact.unwrap_err(), SpecError::ExactCollapsed { side: "v0".into() });
            }
        }
    }
}

/// A body from outside: functions permuted and scaled, sides as lists of facets only.
#[derive(Debug)]
struct Outside {
    space: Arc<dyn Space<2, 2>>,
    facets: Vec<(String, Vec<Embedding<1, 2>>)>,
    kind: Cell,
}

impl Outside {
    fn of(body: &dyn Body<1, 2>) -> Self {
        let facets = body.sides().into_iter().map(|s| (s.clone(), body.trace(&s).unwrap().facets)).collect();
        Self { space: body.space().clone(), facets, kind: Cell::Tensor }
    }
}

impl Body<1, 2> for Outside {
    fn space(&self) -> &Arc<dyn Space<2, 2>> {
        &self.space
    }
    fn sides(&self) -> Vec<String> {
        self.facets.iter().map(|f| f.0.clone()).collect()
    }
    fn trace(&self, side: &str) -> Result<Trace<1, 2>, SideError> {
        let known = self.sides().join(", ");
        let found = self.facets.iter().find(|f| f.0 == side);
        let (_, facets) = found.ok_or(SideError::Unknown { side: side.to_string(), known })?;
        Trace::from_facets(&self.space, facets.clone(), self.kind)
    }
}

#[test]
fn a_list_of_facets_makes_the_sides_of_any_body() {
    for (name, net) in plane() {
        let spec = spec(&net, [2, 2]);
        let bodies: [Box<dyn Body<1, 2>>; 3] = [
            Box::new(Patch::<1, 2>::try_new(&spec).unwrap()),
            Box::new(Mesh::<1, 2>::from_patch(&spec).unwrap()),
            Box::new(Mesh::<1, 2>::from_patch(&spec.with_cells(Cell::Simplex)).unwrap()),
        ];
        for body in bodies {
            let outside = Outside::of(&*body);
            pass(name, &outside);
            for side in body.sides() {
                let (own, listed) = (body.trace(&side).unwrap(), outside.trace(&side).unwrap());
                let sorted = |mut d: Vec<usize>| {
                    d.sort_unstable();
                    d
                };
                assert_eq!(sorted(own.dofs), sorted(listed.dofs), "{name}, {side}");
                assert_eq!(own.outward, listed.outward);
                assert!(listed.space.polynomials(Polynomials::Lowered(1)).is_none());
            }
        }
    }
}

#[test]
fn sides_of_both_backends_answer_multiplier_polynomials_on_their_elements() {
    for (name, net) in plane() {
        let spec = spec(&net, [3, 3]);
        let bodies: [(Box<dyn Body<1, 2>>, bool); 3] = [
            (Box::new(Patch::<1, 2>::try_new(&spec).unwrap()), true),
            (Box::new(Mesh::<1, 2>::from_patch(&spec).unwrap()), false),
            (Box::new(Mesh::<1, 2>::from_patch(&spec.with_cells(Cell::Simplex)).unwrap()), false),
        ];
        for (body, smooth) in bodies {
            for side in body.sides() {
                let space = body.trace(&side).unwrap().space;
                let n = space.num_elements();
                for lowered in 0..=3 {
                    let psi = space.polynomials(Polynomials::Lowered(lowered)).unwrap();
                    assert_eq!((psi.num_elements(), psi.degree(0)), (n, [3 - lowered]), "{name}, {side}");
                    // a Lagrange side counts as C^0: continuous at no reduction, discontinuous at any
                    let functions = if lowered == 0 { 3 * n + 1 } else { (4 - lowered) * n };
                    assert!(smooth || psi.num_functions() == functions, "{name}, {side}");
                }
                assert!(space.polynomials(Polynomials::Lowered(4)).is_none());
            }
        }
    }
}

#[test]
fn a_facet_inside_a_body_is_refused() {
    let spec = spec(&shapes::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap(), [2, 2]);
    let across = |origin: [f64; 2], axis: [f64; 2]| Embedding {
        element: 1,
        origin: Vector::<2>::from(origin),
        axes: Matrix::<2, 1>::new(axis[0], axis[1]),
    };
    let patch = Patch::<1, 2>::try_new(&spec).unwrap();
    // the u1 edge of element 1 is shared with element 2; its v0 edge is on the boundary; a diagonal is no edge
    for (facet, fine) in
        [(across([1.0, 0.0], [0.0, 1.0]), false), (across([0.0, 0.0], [1.0, 0.0]), true), (across([0.0, 0.0], [1.0, 1.0]), false)]
    {
        let found = Trace::from_facets(patch.space(), vec![facet], Cell::Tensor);
        assert_eq!(found.is_ok(), fine);
        if !fine {
            assert_eq!(found.unwrap_err(), SideError::Interior { facet: 0 });
        }
    }
    /// The same elements without corner ids.
    #[derive(Debug)]
    struct Nameless<X>(X);
    impl<X: Elements> Elements for Nameless<X> {
        fn num_elements(&self) -> usize {
            self.0.num_elements()
        }
    }
    impl<X: Basis<2>> Basis<2> for Nameless<X> {
        fn num_functions(&self) -> usize {
            self.0.num_functions()
        }
        fn degree(&self, element: usize) -> [usize; 2] {
            self.0.degree(element)
        }
        fn active(&self, element: usize, ids: &mut Vec<usize>) {
            self.0.active(element, ids)
        }
        fn tabulate(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut ShapeTable<2>) {
            self.0.tabulate(element, xi, order, table)
        }
    }
    impl<X: Geometry<2, 2>> Geometry<2, 2> for Nameless<X> {
        fn map(&self, element: usize, xi: &[Vector<2>], order: Order, table: &mut MapTable<2, 2>) {
            self.0.map(element, xi, order, table)
        }
        fn bounds(&self, element: usize) -> Bounds<2> {
            self.0.bounds(element)
        }
    }
    impl<X: Space<2, 2>> Space<2, 2> for Nameless<X> {}
    let nameless: Arc<dyn Space<2, 2>> = Arc::new(Nameless(patch.space().clone()));
    check::space(&*nameless).unwrap();
    assert!(Trace::from_facets(&nameless, vec![across([1.0, 0.0], [0.0, 1.0])], Cell::Tensor).is_err());
    assert!(Trace::from_facets(&nameless, vec![across([0.0, 0.0], [1.0, 0.0])], Cell::Tensor).is_ok());
}

#[test]
fn embedded_cells_and_deformed_spaces_keep_the_contract_of_spaces() {
    for (name, net) in plane() {
        let patch = Patch::<1, 2>::try_new(&spec(&net, [2, 3])).unwrap();
        let space = patch.space().clone();
        let cells = (0..space.num_elements())
            .map(|element| Embedding { element, origin: Vector::<2>::new(0.9, 0.8), axes: Matrix::<2, 2>::new(-0.7, 0.05, 0.1, -0.6) })
            .collect();
        let (cut, _) = Embedded::new(space.clone(), cells, Cell::Simplex).restricted();
        check::space(&cut).unwrap_or_else(|e| panic!("{name}, cut: {e}"));
        let u = (0..space.num_functions()).map(|i| Vector::<2>::new((i as f64).sin(), (2.0 * i as f64).cos()) * 0.02).collect();
        check::space(&Deformed { space, u }).unwrap_or_else(|e| panic!("{name}, deformed: {e}"));
    }
    let mesh = Mesh::<1, 2>::from_patch(&spec(&plane()[6].1, [3, 3])).unwrap();
    let u = (0..mesh.space().num_functions()).map(|i| Vector::<2>::new((i as f64).sin(), (2.0 * i as f64).cos()) * 0.02).collect();
    check::space(&Deformed { space: mesh.space().clone(), u }).unwrap();
}

#[test]
fn maps_of_curves_keep_the_contract_in_double_and_single_precision() {
    let points: Vec<Vector<2>> = (0..7).map(|i| Vector::<2>::new(i as f64, (2.1 * i as f64).sin())).collect();
    let weights: Vec<f64> = (0..7).map(|i| 1.0 + 0.5 * (i as f64).cos()).collect();
    let spline = BSpline::uniform(3, 4, 2);
    check::geometry::<1, 2, f64, _>(&ControlPoints { basis: spline.clone(), points: points.clone() }).unwrap();
    check::geometry::<1, 2, f64, _>(&ControlPoints { basis: Rational::new::<1>(spline, weights), points: points.clone() }).unwrap();
    for degree in [1, 2, 3, 6] {
        check::geometry::<1, 2, f64, _>(&ControlPoints { basis: LagrangeLine::<f64>::new(degree, 6 / degree), points: points.clone() })
            .unwrap();
    }
    let single: Vec<Vector<2, f32>> = points.iter().map(|p| p.map(|v| v as f32)).collect();
    let basis = TensorProduct::<1, _, f32>::new([BSpline::<f32>::uniform(3, 4, 2)]);
    check::space::<1, 2, f32, _>(&ControlPoints { basis: basis.clone(), points: single.clone() }).unwrap();
    let over = FunctionSpace { geometry: ControlPoints { basis: basis.clone(), points: single }, basis };
    check::space::<1, 2, f32, _>(&over).unwrap();
}

#[test]
fn the_checkers_find_what_is_broken() {
    /// A map whose second derivatives, boxes or block are wrong.
    #[derive(Debug)]
    struct Broken(ControlPoints<BSpline<f64>, 2>, &'static str);
    impl Elements for Broken {
        fn num_elements(&self) -> usize {
            self.0.num_elements()
        }
    }
    impl Geometry<1, 2> for Broken {
        fn map(&self, element: usize, xi: &[Vector<1>], order: Order, table: &mut MapTable<1, 2>) {
            self.0.map(element, xi, order, table);
            if self.1 == "derivative" {
                table.hessian.iter_mut().for_each(|h| h[0] *= 1.001);
            }
        }
        fn bounds(&self, element: usize) -> Bounds<2> {
            let b = self.0.bounds(element);
            if self.1 == "box" { Bounds { lo: b.lo, hi: b.lo + (b.hi - b.lo) * 0.7 } } else { b }
        }
        fn all_bounds(&self) -> Vec<Bounds<2>> {
            let mut all: Vec<Bounds<2>> = (0..self.num_elements()).map(|e| self.bounds(e)).collect();
            match self.1 {
                "few" => all.truncate(1),
                "moved" => all[1] = all[0],
                _ => {}
            }
            all
        }
    }
    let points: Vec<Vector<2>> = (0..6).map(|i| Vector::<2>::new(i as f64, (2.1 * i as f64).sin())).collect();
    let make = |what| Broken(ControlPoints { basis: BSpline::uniform(3, 3, 2), points: points.clone() }, what);
    check::geometry(&make("nothing")).unwrap();
    assert!(check::geometry(&make("derivative")).unwrap_err().contains("derivative"));
    assert!(check::geometry(&make("box")).unwrap_err().contains("box"));
    assert!(check::geometry(&make("few")).unwrap_err().contains("1 boxes for 3 elements"));
    assert!(check::geometry(&make("moved")).unwrap_err().contains("another box"));

    /// A body one of whose sides is turned inside out.
    #[derive(Debug)]
    struct Turned(Patch<1, 2>);
    impl Body<1, 2> for Turned {
        fn space(&self) -> &Arc<dyn Space<2, 2>> {
            self.0.space()
        }
        fn sides(&self) -> Vec<String> {
            self.0.sides()
        }
        fn trace(&self, side: &str) -> Result<Trace<1, 2>, SideError> {
            let mut trace = self.0.trace(side)?;
            if side == "v1" {
                trace.outward.iter_mut().for_each(|s| *s = -*s);
            }
            Ok(trace)
        }
    }
    let patch = Patch::try_new(&spec(&plane()[1].1, [2, 2])).unwrap();
    assert!(check::body(&Turned(patch)).unwrap_err().contains("does not point out"));
}

#[test]
fn halving_elements_is_what_refined_does() {
    let spec = spec(&plane()[3].1, [2, 2]);
    let patch = Patch::<1, 2>::try_new(&spec.clone().refined(1)).unwrap();
    let coarse = Patch::<1, 2>::try_new(&spec).unwrap();
    assert_eq!(patch.elements(), coarse.elements().map(|n| 2 * n));
    assert_eq!(patch.breakpoints()[0], refine::halved(&coarse.breakpoints()[0], 1));
}
