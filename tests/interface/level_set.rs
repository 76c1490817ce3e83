//! The foot of level sets against distances in closed form.

use faying::check::obstacle;
use faying::contact::{Hit, LevelSet, Obstacle};
use faying::linalg::Vector;

type Point = Vector<2>;

fn hit<F: Fn(&Point) -> (f64, Point) + Send + Sync>(f: F, x: Point, outward: Point) -> Hit<1, 2> {
    Obstacle::<1, 2>::project(&LevelSet::new(f), &x, &outward).expect("level sets always answer")
}

#[test]
fn the_gap_of_a_plane_is_its_distance_whatever_f_is_off_the_plane() {
    // f is a function of y - 0.5 alone, in sizes from 1e-3 to 1e3
    type Value = fn(f64) -> (f64, f64);
    let functions: [(&str, Value); 8] = [
        ("linear", |u| (u, 1.0)),
        ("cube", |u| (u.powi(3), 3.0 * u * u)),
        ("seventh power", |u| (u.powi(7), 7.0 * u.powi(6))),
        ("atan", |u| ((100.0 * u).atan(), 100.0 / (1.0 + 1e4 * u * u))),
        ("steep atan", |u| ((1e4 * u).atan(), 1e4 / (1.0 + 1e8 * u * u))),
        ("root", |u| (u.abs().cbrt() * u.signum(), 1.0 / (3.0 * u.abs().cbrt().powi(2)))),
        ("exponential", |u| ((9.0 * u).exp() - 1.0, 9.0 * (9.0 * u).exp())),
        ("kink", |u| if u > 0.0 { (u, 1.0) } else { (1e3 * u, 1e3) }),
    ];
    for (name, f) in functions {
        for size in [1e-3, 1.0, 1e3] {
            for (s, c) in [0.0_f64, 30.0, 117.0, -90.0].map(|angle| angle.to_radians().sin_cos()) {
                let normal = Point::new(-s, c);
                let level = |x: &Point| {
                    let (value, slope) = f(x.dot(&normal) / size - 0.5);
                    (value, normal * (slope / size))
                };
                for y in [-3.0, -0.1, 0.4, 0.499, 0.500_01, 0.6, 0.9, 2.0] {
                    let x = (normal * y + Point::new(c, s) * 0.37) * size;
                    let found = hit(level, x, -normal);
                    let known = (y - 0.5) * size;
                    assert!((found.gap - known).abs() < 1e-12 * size, "{name}, size {size}, y = {y}: {:e} for {known:e}", found.gap);
                    assert!((found.normal - normal).norm() < 1e-12, "{name}: {:?}", found.normal);
                }
            }
        }
    }
}

/// The origin tells nothing about the size of a model: f is written in coordinates that are shifted and divided by a size, and rounds to zero
/// over some length.
#[test]
fn a_foot_at_the_origin_is_found_in_any_size() {
    for size in [3.737_803_254_768_16e-9, 1e-6, 0.3, 1.0, 2.7e8] {
        for shift in [0.030_8, -0.37, 0.0, 0.5, 123.456] {
            // a parabola through (0, gap) with its axis shifted aside; slope 2 c shift at the origin
            for (c, gap) in [(0.2176, -8e-4), (0.0, 1e-6), (0.4, 0.0), (0.0, 0.0), (0.7, 1e-13)] {
                let (bend, offset) = (c / (1.0 + shift * shift), gap + 0.7);
                let level = move |x: &Point| {
                    let (u, v) = (x[0] / size - shift, x[1] / size - offset);
                    let value = v + 0.7 + bend * u * u - bend * shift * shift;
                    (value, Point::new(2.0 * bend * u, 1.0) / size)
                };
                let normal = Point::new(-2.0 * bend * shift, 1.0).normalize();
                let found = hit(level, Point::zeros(), -normal);
                let first = -gap * normal[1] * size;
                let within = 1e-14 * (1.0 + shift * shift) + 4.0 * bend * gap * gap;
                assert!((found.gap - first).abs() < within * size, "{size} {shift} {c} {gap}: {:e} for {first:e}", found.gap);
            }
        }
    }
}

#[test]
fn the_gap_of_an_ellipse_is_its_distance_on_both_sides() {
    for (a, b) in [(1.0, 1.0), (2.0, 1.0), (5.0, 1.0), (0.03, 0.02), (1.2e3, 2.5e3)] {
        let ellipse = move |x: &Point| {
            let value = (x[0] / a).powi(2) + (x[1] / b).powi(2) - 1.0;
            (value, Point::new(2.0 * x[0] / (a * a), 2.0 * x[1] / (b * b)))
        };
        let cubed = move |x: &Point| {
            let (value, gradient) = ellipse(x);
            (value.powi(3), gradient * (3.0 * value * value))
        };
        for k in 0..36 {
            let (s, c) = (0.03 + 0.1745 * f64::from(k)).sin_cos();
            let (on, normal) = (Point::new(a * c, b * s), Point::new(b * c, a * s).normalize());
            // the least radius of curvature bounds the depth up to which the foot is the closest point
            let deep = 0.6 * f64::min(a * a / b, b * b / a);
            for d in [-deep, -0.3 * deep, -1e-3 * deep, 1e-3 * deep, 0.5 * b, 3.0 * a] {
                for (found, name) in [(hit(ellipse, on + normal * d, -normal), "ellipse"), (hit(cubed, on + normal * d, -normal), "cubed")]
                {
                    assert!((found.gap - d).abs() < 1e-11 * a.max(b).max(d), "{name} {a} {b} at {k}: {:e} for {d:e}", found.gap);
                    assert!((found.normal - normal).norm() < 1e-6 && (found.x - on).norm() < 1e-6 * a.max(b), "{name} {a} {b} at {k}, {d}");
                }
            }
        }
    }
}

#[test]
fn a_parabola_keeps_the_contract_of_obstacles_far_from_it_too() {
    let parabola = |x: &Point| (x[1] - 0.1 * x[0] * x[0], Point::new(-0.2 * x[0], 1.0));
    let points: Vec<Point> = (0..60).map(|k| Point::new(f64::from(k % 10) * 0.31 - 1.2, f64::from(k / 10) * 0.27 - 0.4)).collect();
    obstacle::<1, 2, f64>(&LevelSet::new(parabola), &points, 1e-10).unwrap();
    let along = LevelSet::try_along(parabola, Point::new(0.0, 2.0)).unwrap();
    let hit = Obstacle::<1, 2>::project(&along, &Point::new(1.0, 0.35), &Point::new(0.0, -1.0)).unwrap();
    assert!((hit.gap - 0.25).abs() < 1e-15 && hit.normal == Point::new(0.0, 1.0));
}

#[test]
fn the_face_that_opposes_is_found_deeper_than_an_edge_is_far() {
    // the square |x| < 1, |y| < 1 as the larger of two functions, without a slope where both are equal
    let square = |x: &Point| {
        let axis = usize::from(x[1].abs() > x[0].abs());
        let mut gradient = Point::zeros();
        gradient[axis] = x[axis].signum();
        (x[axis].abs() - 1.0, gradient)
    };
    let down = Point::new(0.0, -1.0);
    for (x, y) in [(0.99, 0.9), (-0.999, 0.98), (0.2, 0.9), (0.5, 1.3)] {
        let found = hit(square, Point::new(x, y), down);
        assert!((found.gap - (y - 1.0)).abs() < 1e-14 && found.normal == -down, "{x} {y}: {found:?}");
    }
    // beside the square nothing opposes
    let beside = hit(square, Point::new(1.2, 0.5), down);
    assert!(beside.gap.is_finite() && !faying::contact::opposes(&down, &beside.normal), "{beside:?}");
}

#[test]
fn what_has_no_zero_or_no_number_has_no_gap() {
    let down = Point::new(0.0, -1.0);
    let none = [
        hit(|x: &Point| (1.0 + x[1] * x[1], Point::new(0.0, 2.0 * x[1])), Point::new(0.3, 0.7), down),
        hit(|x: &Point| ((-x[1]).exp(), Point::new(0.0, -(-x[1]).exp())), Point::new(0.3, 0.7), down),
        hit(|_: &Point| (2.0, Point::zeros()), Point::new(0.3, 0.7), down),
        hit(|x: &Point| (x[1].sqrt() - 1.0, Point::new(0.0, 0.5 / x[1].sqrt())), Point::new(0.3, -0.7), down),
        // these touch zero and do not change their sign
        hit(|x: &Point| ((x[1] - 0.2).powi(2), Point::new(0.0, 2.0 * (x[1] - 0.2))), Point::new(0.3, 0.7), down),
        hit(|x: &Point| ((x.norm() - 1.0).powi(2), x * (2.0 * (x.norm() - 1.0) / x.norm())), Point::new(0.3, 1.7), down),
    ];
    assert!(none.iter().all(|hit| hit.gap.is_nan()), "{none:?}");
    // defined on one side only
    let half = hit(|x: &Point| (x[1].sqrt() - 0.5, Point::new(0.0, 0.5 / x[1].sqrt())), Point::new(0.3, 0.7), down);
    assert!((half.gap - 0.45).abs() < 1e-14, "{half:?}");
    // at the centre of a circle any direction will do: that of the slave is taken
    let circle = hit(|x: &Point| (x.norm_squared() - 4.0, x * 2.0), Point::zeros(), down);
    assert!((circle.gap + 2.0).abs() < 1e-14 && (circle.normal + down).norm() < 1e-14, "{circle:?}");
}
