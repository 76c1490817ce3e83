//! Obstacles with the shape of solids and surfaces: gaps by closed forms, whatever the cells, and the same pressures as analytic obstacles.

use crate::bodies::{KINDS, Kind, steel, turns};
use faying::check;
use faying::contact::{FacingSurface, HalfPlane, Hit, Obstacle, OutlineError, Sphere, body_outline, opposed, surface_outline};
use faying::geometry::{ControlNet, shapes, turn_about};
use faying::linalg::{Matrix, Vector};
use faying::problem::{Components, ContactId, Problem, Solution};
use faying::space::{Body, PatchSpec};

type Shape = std::sync::Arc<dyn Obstacle<2, 3>>;

/// The boundary of a box, turned, of cells of this kind.
fn box_of(kind: Kind, (min, max): ([f64; 3], [f64; 3]), elements: [usize; 3], turn: &Matrix<3, 3>) -> FacingSurface {
    let net = shapes::brick(min, max).unwrap().rotate(turn);
    let body = kind.body(&PatchSpec::new(net).with_degree([1; 3]).with_elements(elements));
    FacingSurface::of_pieces(body_outline(&*body, body.sides()).unwrap())
}

/// The eighths of the sphere of radius `r` around the origin, some of them walked the other way round.
fn sphere_nets(r: f64) -> Vec<ControlNet<2, 3>> {
    let solid = shapes::sphere_octant([0.0; 3], [0.5 * r, r]).unwrap();
    let [u, v, _] = solid.axes.clone();
    let outer = solid.points.len() / 2;
    let weights = solid.weights.as_ref().map(|w| w[outer..].to_vec());
    let octant = ControlNet::try_new([u, v], solid.points[outer..].to_vec(), weights).unwrap();
    let about = |axis: Vector<3>, degrees: f64| turn_about(&axis, degrees).unwrap();
    (0..8)
        .map(|k| {
            let below = if k < 4 { Matrix::identity() } else { about(Vector::<3>::x(), 180.0) };
            let net = octant.clone().rotate(&(about(Vector::<3>::z(), 90.0 * f64::from(k)) * below));
            if k % 3 == 1 { net.reverse(0) } else { net }
        })
        .collect()
}

/// Points of a box around [0, 1]^3, dense and without a pattern.
fn points(count: usize) -> impl Iterator<Item = Vector<3>> {
    let step = Vector::<3>::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3);
    (1..=count).map(move |k| (step * k as f64).map(|v| 2.0 * v.fract() - 0.5))
}

fn close(found: Option<Hit<2, 3>>, wanted: Option<(f64, Vector<3>)>, tolerance: f64) -> bool {
    match (found, wanted) {
        (None, None) => true,
        (Some(hit), Some((gap, normal))) => (hit.gap - gap).abs() <= tolerance && (hit.normal - normal).norm() <= tolerance,
        _ => false,
    }
}

/// What faces a direction of the axes is the face of the other side, above it, and in the box from behind.
#[test]
fn a_box_has_the_gap_of_the_face_that_opposes_whatever_its_cells() {
    let max = [1.0, 0.8, 0.7];
    for (k, kind) in KINDS.into_iter().enumerate() {
        for (t, turn) in turns().into_iter().enumerate() {
            let elements = [[1, 1, 1], [3, 2, 2], [1, 4, 3]][(k + t) % 3];
            let obstacle = box_of(kind, ([0.0; 3], max), elements, &turn);
            for x in points(150) {
                let holds = |i: usize| x[i] >= 0.0 && x[i] <= max[i];
                for (axis, end) in (0..3).flat_map(|axis| [(axis, 0.0), (axis, 1.0)]) {
                    let sign = 2.0 * end - 1.0;
                    let normal = Vector::<3>::from_fn(|i, _| if i == axis { sign } else { 0.0 });
                    let gap = (x[axis] - end * max[axis]) * sign;
                    let within = (0..3).all(|i| i == axis || holds(i));
                    let wanted = (within && (gap >= 0.0 || holds(axis))).then(|| (gap, turn * normal));
                    let found = opposed(&obstacle, &(turn * x), &(turn * -normal));
                    assert!(close(found, wanted, 1e-13), "{kind:?} {elements:?} {x:?} {normal:?}: {found:?} {wanted:?}");
                }
            }
        }
    }
}

/// A direction that two faces oppose, one by 40 and one by 50 degrees. In the fan of their edge the face counts above which the point is
/// more; inside the nearer one, unless the point is on the other side of the edge for one that came in along the direction.
#[test]
fn at_an_edge_the_face_counts_that_opposes_most() {
    for (kind, elements) in KINDS.into_iter().zip([[1, 1, 1], [2, 3, 2], [3, 3, 3], [2, 2, 2]]) {
        let obstacle = box_of(kind, ([0.0; 3], [1.0; 3]), elements, &Matrix::identity());
        let (s, c) = 40f64.to_radians().sin_cos();
        let outward = -Vector::<3>::new(s, 0.0, c);
        let mut seen = [0; 4];
        for k in 0..400 {
            let x = points(400).nth(k).unwrap();
            // depths below both faces, near the edge
            let [a, b] = [x[0], x[2]].map(|v| 0.3 * (v - 0.5));
            let at = Vector::<3>::new(1.0 - a, 0.5 * (x[1] + 0.5), 1.0 - b);
            let by_x = (-a, Vector::<3>::x());
            let by_z = (-b, Vector::<3>::z());
            let (case, wanted) = match (a > 0.0, b > 0.0) {
                (false, false) => (0, if -a > -b { by_x } else { by_z }),
                (false, true) => (1, by_x),
                (true, false) => (1, by_z),
                (true, true) if b < a => (2, by_z),
                (true, true) if b * s < a * c => (3, by_z),
                (true, true) => (2, by_x),
            };
            seen[case] += 1;
            let found = opposed(&obstacle, &at, &outward);
            assert!(close(found, Some(wanted), 1e-12), "{kind:?} {a} {b}: {found:?}");
        }
        assert!(seen.iter().all(|n| *n > 3), "{seen:?}");
    }
}

/// Beside a box that stands on a floor, both one solid: what is in the wall, near the floor, has come in by no face above.
#[test]
fn a_floor_hides_the_top_of_a_wall() {
    let solids = [([-1.0, 0.0, -0.5], [0.0, 1.0, 0.0]), ([0.0, 0.0, -0.5], [1.0, 1.0, 0.0]), ([0.0, 0.0, 0.0], [1.0, 1.0, 1.0])];
    let pieces = solids.into_iter().flat_map(|(min, max)| {
        let body = Kind::Hexahedra.body(&PatchSpec::new(shapes::brick(min, max).unwrap()).with_degree([1; 3]).with_elements([2, 2, 2]));
        body_outline(&*body, body.sides()).unwrap()
    });
    let obstacle = FacingSurface::of_pieces(faying::contact::without_seams(pieces.collect()));
    let down = -Vector::<3>::z();
    let gap = |x: f64, z: f64| opposed(&obstacle, &Vector::<3>::new(x, 0.37, z), &down).map(|hit| hit.gap);
    for z in [0.05, 0.0, -0.001] {
        assert_eq!(gap(0.01, z), None, "{z}");
    }
    for (x, z, wanted) in [(0.01, 0.999, -0.001), (-0.01, 0.1, 0.1), (-0.01, -0.1, -0.1), (0.5, 1.2, 0.2)] {
        assert!((gap(x, z).unwrap() - wanted).abs() < 1e-14, "{x} {z}");
    }
}

/// Eight surfaces that close on themselves, in any order of their parameters, and the outer sides of eight solids.
#[test]
fn a_nurbs_sphere_is_a_sphere_with_its_poles() {
    let center = Vector::<3>::new(0.5, 0.4, 0.55);
    let placed: Vec<_> = sphere_nets(0.45).into_iter().map(|net| net.translate(&center)).collect();
    let surface = FacingSurface::of_pieces(surface_outline(placed.clone()).unwrap());
    let sphere = Sphere::<3> { center, radius: 0.45, inside: false };
    let poles = [0.2, -0.2, 0.6].map(|z| center + Vector::<3>::new(0.0, 0.0, z));
    let directions = [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.3, -0.5, 0.8], [-0.6, 0.7, 0.1]].map(|d| Vector::<3>::from(d).normalize());
    let mut faced = 0;
    for x in points(300).chain(poles) {
        for outward in &directions {
            let wanted = opposed::<2, 3, f64>(&sphere, &x, outward).map(|hit| (hit.gap, hit.normal));
            let found = opposed(&surface, &x, outward);
            assert!(close(found, wanted, 1e-12), "{x:?} {outward:?}: {found:?} {wanted:?}");
            faced += usize::from(wanted.is_some());
        }
    }
    assert!(faced > 100, "{faced}");
    let kept: Vec<Vector<3>> = points(60).collect();
    check::obstacle::<2, 3, f64>(&surface, &kept, 1e-11).unwrap();
    // one eighth alone is open: it has its normal t_u x t_v
    let one = FacingSurface::of_pieces(surface_outline(vec![placed[0].clone()]).unwrap());
    let turned = FacingSurface::of_pieces(surface_outline(vec![placed[0].reverse(0)]).unwrap());
    let d = Vector::<3>::new(1.0, 1.2, 0.9).normalize();
    let x = center + d * 0.7;
    let (a, b) = (one.project(&x, &-d), turned.project(&x, &-d));
    assert!(a.is_some() != b.is_some(), "{a:?} {b:?}");
}

#[test]
fn a_surface_without_normals_is_refused() {
    let knots = || vec![0.0, 0.0, 1.0, 1.0];
    let line = (0..4).map(|k| Vector::<3>::new(f64::from(k), 0.0, 0.0)).collect();
    let net = ControlNet::from_knots([1, 1], [knots(), knots()], line, None).unwrap();
    assert!(matches!(surface_outline(vec![net]), Err(OutlineError::NoNormal { element: 0, .. })));
}

/// A block of 1 x 1 x 0.5 with its top held, moved down by 0.02 onto an obstacle.
fn pressed(kind: Kind, obstacle: Shape) -> (Solution<2, 3>, ContactId) {
    let net = shapes::brick([0.0, 0.0, -0.02], [1.0, 1.0, 0.48]).unwrap();
    let mut p = Problem::<2, 3>::new();
    let block = kind.add(&mut p, "block", kind.body(&PatchSpec::new(net).with_degree([2; 3]).with_elements([4, 4, 2])), steel());
    p.fix(block.side("w1"), Components::All).unwrap();
    let contact = p.contact(block.side("w0"), faying::problem::Opponent::Obstacle(obstacle)).unwrap().id();
    (p.assemble().unwrap().solve(0.0, None).unwrap(), contact)
}

#[test]
fn pressures_are_those_of_analytic_obstacles() {
    let floor = HalfPlane::try_new(Vector::<3>::zeros(), Vector::<3>::z()).unwrap();
    let center = Vector::<3>::new(0.45, 0.5, -2.0);
    let ball = sphere_nets(2.0).into_iter().map(|net| net.translate(&center)).collect();
    let slab = |kind, elements| box_of(kind, ([-0.5, -0.3, -1.0], [1.4, 1.2, 0.0]), elements, &Matrix::identity());
    let pairs: [(Shape, Shape); 4] = [
        (std::sync::Arc::new(floor), std::sync::Arc::new(slab(Kind::Hexahedra, [1, 1, 1]))),
        (std::sync::Arc::new(floor), std::sync::Arc::new(slab(Kind::Tetrahedra, [2, 3, 1]))),
        (std::sync::Arc::new(floor), std::sync::Arc::new(slab(Kind::Nurbs, [3, 2, 2]))),
        (
            std::sync::Arc::new(Sphere::<3> { center, radius: 2.0, inside: false }),
            std::sync::Arc::new(FacingSurface::of_pieces(surface_outline(ball).unwrap())),
        ),
    ];
    for (k, (known, shaped)) in pairs.into_iter().enumerate() {
        let kind = KINDS[k];
        let [(a, id), (b, other)] = [pressed(kind, known), pressed(kind, shaped)];
        let (wanted, found) = (a.contact(id).unwrap(), b.contact(other).unwrap());
        assert!(wanted.active > 0 && (found.force - wanted.force).norm() < 1e-10 * wanted.force.norm(), "{k}: {found:?} {wanted:?}");
        let apart = a.multiplier(id).unwrap().iter().zip(b.multiplier(other).unwrap()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9 * wanted.largest_pressure, "{k}: {apart:e}");
    }
}

/// A punch sunk deeper into a block than some of its points are from its sides: no point takes a side, or overhangs an edge or a corner, so that
/// it is pressed along its axis alone; mirrored punches have mirrored forces.
#[test]
fn a_punch_is_pressed_by_its_face_alone() {
    let punched = |kind: Kind, [x, y]: [f64; 2]| {
        let net = shapes::brick([-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]).unwrap();
        let mut p = Problem::<2, 3>::new();
        let body = kind.body(&PatchSpec::new(net).with_degree([1; 3]).with_elements([10, 10, 3]));
        let block = kind.add(&mut p, "block", body, steel());
        p.fix(block.side("w1"), Components::All).unwrap();
        let punch = box_of(Kind::Hexahedra, ([x - 0.43, y - 0.32, -1.0], [x + 0.43, y + 0.32, 0.0]), [1, 1, 1], &Matrix::identity());
        let contact = p.contact(block.side("w0"), punch).unwrap().moved(2, 0.15).id();
        p.assemble().unwrap().solve(0.0, None).unwrap().contact(contact).unwrap()
    };
    for kind in [Kind::Spline, Kind::Tetrahedra] {
        // over the middle, and with a corner alone under the block
        for at in [[0.17, 0.08], [0.9, 0.85]] {
            let one = punched(kind, at);
            let up = one.force[2];
            assert!(up > 0.0 && one.force[0].abs() < 1e-13 * up && one.force[1].abs() < 1e-13 * up, "{kind:?} {at:?}: {:?}", one.force);
            assert!(one.measure > 0.0 && one.measure < 4.0 * 0.43 * 0.32 + 0.2, "{kind:?} {at:?}: {}", one.measure);
            let [x, y] = at;
            // tetrahedra are mirrored in themselves by the diagonal alone
            let mirrored: &[[f64; 2]] = if kind == Kind::Spline { &[[-x, y], [x, -y], [-x, -y]] } else { &[[-x, -y]] };
            for other in mirrored {
                let two = punched(kind, *other);
                if kind == Kind::Spline {
                    assert!((two.force[2] - up).abs() < 1e-9 * up, "{at:?} {other:?}: {} {up}", two.force[2]);
                }
                assert!(two.force[0].abs() < 1e-13 * up && two.force[1].abs() < 1e-13 * up, "{kind:?} {other:?}: {:?}", two.force);
            }
        }
    }
}
