//! Partners oppose each other: obstacles and masters round corners, sides that do not face their opponent, level sets.

use faying_cli::{Case, Registry, RunResult};

const HEAD: &str = "[model]\nphysics = \"elasticity\"\ndimension = 2\n[[material]]\nname = \"m\"\nyoung = 1.0\npoisson = 0.3\n[discretization]\ndegree = 2\n";

fn run(text: &str) -> RunResult {
    let case = Case::parse("opposed.toml", text, &Default::default()).unwrap_or_else(|d| panic!("{d}\n{text}"));
    let result = case.run(&Registry::default()).unwrap_or_else(|d| panic!("{d}\n{text}"));
    assert_eq!(result.exit, 0, "{:?}\n{text}", result.diagnostics);
    result
}

/// The faults of a case that is refused.
fn refused(text: &str) -> String {
    match Case::parse("opposed.toml", text, &Default::default()).and_then(|case| case.run(&Registry::default())) {
        Err(faults) => faults.to_string(),
        Ok(result) => panic!("exit {}, force {:?}\n{text}", result.exit, force(&result)),
    }
}

fn force(result: &RunResult) -> [f64; 2] {
    let force = &result.contact.get("c").unwrap().force;
    [force[0], force[1]]
}

fn near(a: [f64; 2], b: [f64; 2], share: f64) -> bool {
    let scale = b[0].hypot(b[1]);
    (a[0] - b[0]).hypot(a[1] - b[1]) <= share * scale
}

/// A block on the ground under an obstacle, all lengths times `size`, turned by `angle` degrees; `ground` is the displacement of its bottom.
struct Block {
    size: f64,
    angle: f64,
    more: &'static str,
}

impl Block {
    fn vector(&self, v: [f64; 2]) -> String {
        let (s, c) = self.angle.to_radians().sin_cos();
        format!("[{:?}, {:?}]", self.size * (c * v[0] - s * v[1]), self.size * (s * v[0] + c * v[1]))
    }

    fn placed(&self) -> String {
        format!("scale = {:?}, rotate_deg = {:?}", self.size, self.angle)
    }

    fn case(&self, rigid: &str, ground: [f64; 2]) -> String {
        let Self { more, .. } = self;
        format!(
            "{HEAD}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [-2, -1], max = [2, 0], {} }}\nelements = [16, 4]\n\
             [[boundary]]\non = \"b.bottom\"\ndirichlet = {}\n\
             [[contact]]\nname = \"c\"\nslave = \"b.top\"\n{more}\nrigid = {{ {rigid} }}\n",
            self.placed(),
            self.vector(ground).replace('[', "[\"").replace(", ", "\", \"").replace(']', "\"]"),
        )
    }

    fn moved(&self, shape: &str, by: [f64; 2]) -> String {
        format!("{shape}, {}, move = {}", self.placed(), self.vector(by))
    }
}

const PLAIN: Block = Block { size: 1.0, angle: 0.0, more: "" };

fn polyline(points: &[[f64; 2]]) -> String {
    let inner: Vec<String> = (1..points.len() - 1).map(|k| k.to_string()).collect();
    format!(
        "kind = \"nurbs\", degree = 1, knots = [0, 0, {}{}{n}, {n}], points = {points:?}",
        inner.join(", "),
        if inner.is_empty() { "" } else { ", " },
        n = points.len() - 1
    )
}

#[test]
fn a_punch_sunk_deeper_than_its_corner_is_far_from_the_side_presses_with_its_face_alone() {
    for (a, b) in [(-0.5, 0.5), (-0.43, 0.61)] {
        let line = polyline(&[[b, 0.0], [a, 0.0]]);
        let shapes = [
            format!("kind = \"box\", min = [{a:?}, 0], max = [{b:?}, 1.5]"),
            polyline(&[[a, 0.0], [a, 1.5], [b, 1.5], [b, 0.0], [a, 0.0]]),
            polyline(&[[b, 1.0], [b, 0.0], [a, 0.0], [a, 1.0]]),
        ];
        for depth in [1e-3, 0.02, 0.15] {
            for (size, angle) in [(1.0, 0.0), (1e-3, 0.0), (1e3, 0.0), (1.0, 37.0), (1.0, 180.0), (2.0, -113.0)] {
                for more in ["", "method = \"nitsche\"", "multiplier = \"p/p\""] {
                    if !more.is_empty() && (size, angle) != (1.0, 0.0) {
                        continue;
                    }
                    let block = Block { size, angle, more };
                    let face = force(&run(&block.case(&block.moved(&line, [0.0, -depth]), [0.0; 2])));
                    let (s, c) = angle.to_radians().sin_cos();
                    // the punch pushes along its normal alone
                    assert!((c * face[0] + s * face[1]).abs() < 1e-9 * face[0].hypot(face[1]), "{face:?}");
                    for shape in &shapes {
                        let what = format!("{shape} {depth} {size} {angle} {more}");
                        let moved = force(&run(&block.case(&block.moved(shape, [0.0, -depth]), [0.0; 2])));
                        // what overhangs an end by 1e-8 of the size of a shape is on it, and the shapes differ in size
                        assert!(near(moved, face, 3e-8), "{what}: {moved:?} for {face:?}");
                        // the block moved up by as much
                        let twin = force(&run(&block.case(&block.moved(shape, [0.0; 2]), [0.0, depth])));
                        assert!(near(twin, face, 3e-8), "{what}: {twin:?} for {face:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_punch_of_several_teeth_presses_alike_whether_it_moves_or_the_block() {
    // teeth at 0, a groove of depth 0.01 between them, flanks far up
    let comb = polyline(&[[1.5, 1.0], [1.5, 0.0], [0.5, 0.0], [0.5, 0.01], [-0.5, 0.01], [-0.5, 0.0], [-1.5, 0.0], [-1.5, 1.0]]);
    for depth in [0.005, 0.02, 0.05] {
        let moved = force(&run(&PLAIN.case(&PLAIN.moved(&comb, [0.0, -depth]), [0.0; 2])));
        let twin = force(&run(&PLAIN.case(&PLAIN.moved(&comb, [0.0; 2]), [0.0, depth])));
        assert!(near(moved, twin, 1e-9) && moved[0].abs() < 1e-12, "{depth}: {moved:?} {twin:?}");
        // from far below
        let far = force(&run(&PLAIN.case(&PLAIN.moved(&comb, [0.0, 0.3]), [0.0, 0.3 + depth])));
        assert!(near(far, twin, 1e-9), "{depth}: {far:?} {twin:?}");
    }
}

#[test]
fn a_punch_with_chamfers_presses_alike_whether_it_moves_or_the_block() {
    for degrees in [12.0, 30.0, 45.0, 58.0] {
        let (s, c) = f64::to_radians(degrees).sin_cos();
        let punch = polyline(&[[0.5 + c, s], [0.5, 0.0], [-0.4, 0.0], [-0.4 - c, s]]);
        for depth in [0.01, 0.1] {
            let moved = force(&run(&PLAIN.case(&PLAIN.moved(&punch, [0.0, -depth]), [0.0; 2])));
            let twin = force(&run(&PLAIN.case(&PLAIN.moved(&punch, [0.0; 2]), [0.0, depth])));
            assert!(near(moved, twin, 1e-9), "{degrees} {depth}: {moved:?} {twin:?}");
        }
    }
}

#[test]
fn mirrored_obstacles_have_mirrored_forces() {
    for depth in [0.01, 0.1] {
        for points in [vec![[0.9, 1.0], [0.7, 0.0], [-0.2, 0.0], [-0.5, 0.3], [-0.5, 1.0]], vec![[0.8, 1.0], [0.1, 0.0], [-0.9, 0.9]]] {
            let mirrored: Vec<[f64; 2]> = points.iter().rev().map(|[x, y]| [-x, *y]).collect();
            let of = |points: &[[f64; 2]]| force(&run(&PLAIN.case(&PLAIN.moved(&polyline(points), [0.0, -depth]), [0.0; 2])));
            let (a, b) = (of(&points), of(&mirrored));
            assert!(near([-a[0], a[1]], b, 1e-9), "{points:?}: {a:?} {b:?}");
        }
    }
}

#[test]
fn a_side_that_does_not_face_its_obstacle_is_refused_with_the_side_that_was_meant() {
    let block = |size: f64, slave: &str, rigid: &str| {
        format!(
            "{HEAD}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1], scale = {size:?} }}\nelements = [8, 4]\n\
             [[boundary]]\non = \"b.top\"\ndirichlet = [\"0\", \"{:?}\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.{slave}\"\nrigid = {{ {rigid} }}\n",
            -0.02 * size
        )
    };
    for size in [1e-3, 1.0, 1e3] {
        for tilt in [0.0, 0.01, 5.0, 29.0, -20.0] {
            let (s, c) = f64::to_radians(tilt).sin_cos();
            let floor = |point: [f64; 2]| {
                let at = point.map(|v| v * size);
                format!("kind = \"half-plane\", point = {at:?}, normal = [{:?}, {c:?}]", -s)
            };
            let low = if tilt > 0.0 { [2.0, 0.0] } else { [0.0, 0.0] };
            let touching = [low[0], low[1] - 1e-3];
            for slave in ["left", "right"] {
                let text = refused(&block(size, slave, &floor(touching)));
                assert!(text.contains("E023") && text.contains("`b.bottom`"), "{size} {tilt} {slave}: {text}");
            }
            if tilt.abs() < 10.0 {
                run(&block(size, "bottom", &floor(touching)));
            }
        }
        // a wall that stands in the bottom side
        for normal in ["[1, 0]", "[-1, 0]"] {
            let wall = format!("kind = \"half-plane\", point = [{:?}, 0], normal = {normal}", 0.02 * size);
            let text = refused(&block(size, "bottom", &wall));
            assert!(text.contains("E023"), "{text}");
        }
        // and one beside the block
        let wall = format!("kind = \"half-plane\", point = [{:?}, 0], normal = [1, 0]", -1e-3 * size);
        let text = refused(&block(size, "bottom", &wall));
        assert!(text.contains("E023") && text.contains("`b.left`"), "{text}");
    }
}

#[test]
fn sixty_degrees_still_oppose_and_61_do_not() {
    // a half-plane that cuts off an end of the bottom
    let block = |degrees: f64, angle: f64| {
        let (s, c) = (degrees + angle).to_radians().sin_cos();
        let end = if degrees > 0.0 { 2.0 } else { 0.0 };
        let point = [end * angle.to_radians().cos(), end * angle.to_radians().sin()];
        format!(
            "{HEAD}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1], rotate_deg = {angle:?} }}\nelements = [8, 4]\n\
             [[boundary]]\non = \"b.top\"\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nrigid = {{ kind = \"half-plane\", point = {point:?}, normal = [{:?}, {c:?}], move = [{:?}, {:?}] }}\n",
            -s,
            -0.2 * s,
            0.2 * c
        )
    };
    for angle in [0.0, 17.0, 90.0, 200.0] {
        for degrees in [0.0, 30.0, -45.0, 60.0, -60.0] {
            let found = force(&run(&block(degrees, angle)));
            let (s, c) = (degrees + angle).to_radians().sin_cos();
            let along = -s * found[0] + c * found[1];
            assert!(along > 0.0 && (found[0].hypot(found[1]) - along).abs() < 1e-9 * along, "{angle} {degrees}: {found:?}");
        }
        for degrees in [61.0, -61.0, 90.0, 120.0] {
            assert!(refused(&block(degrees, angle)).contains("E023"), "{angle} {degrees}");
        }
    }
}

/// A block on another one, pressed down by `depth`; `lower` lists sides of the one below.
fn on_block(lower: &str, [from, to]: [f64; 2], integration: &str, depth: f64, size: f64, angle: f64) -> String {
    let (s, c) = angle.to_radians().sin_cos();
    let placed = format!("scale = {size:?}, rotate_deg = {angle:?}");
    format!(
        "{HEAD}[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, -1], max = [1, 0], {placed} }}\nelements = [5, 4]\n\
         [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [{from:?}, 0], max = [{to:?}, 1], {placed} }}\nelements = [7, 4]\n\
         [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.top\"\ndirichlet = [\"{:?}\", \"{:?}\"]\n\
         [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = [{lower}]\nintegration = \"{integration}\"\ngap = \"g - {:?}\"\n",
        depth * size * s,
        -depth * size * c,
        0.3 * depth * size
    )
}

#[test]
fn a_master_list_round_a_corner_presses_as_its_face_alone() {
    for integration in ["merged", "slave", "mixed"] {
        for range in [[-0.5, 1.5], [0.2, 1.3], [-0.33, 0.9]] {
            for (depth, size, angle) in [(0.01, 1.0, 0.0), (0.05, 1.0, 0.0), (0.01, 1e-3, 0.0), (0.01, 1e3, 25.0), (0.01, 1.0, 90.0)] {
                let of = |list: &str| force(&run(&on_block(list, range, integration, depth, size, angle)));
                let face = of("\"a.top\"");
                for list in
                    ["\"a.top\", \"a.right\"", "\"a.left\", \"a.top\", \"a.right\"", "\"a.right\", \"a.bottom\", \"a.left\", \"a.top\""]
                {
                    let all = of(list);
                    assert!(near(all, face, 1e-8), "{integration} {range:?} {depth} {size} {angle} {list}: {all:?} for {face:?}");
                }
            }
        }
    }
}

#[test]
fn overlapping_blocks_press_as_the_face_alone_round_a_corner() {
    // the upper block lies in the lower one by 0.05, far more than the distance of some of its points to the sides of that
    let case = |list: &str, integration: &str, overlap: f64| {
        format!(
            "{HEAD}[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [0, -1], max = [1, 0] }}\nelements = [5, 4]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [-0.5, {:?}], max = [1.5, 1] }}\nelements = [7, 4]\n\
             [[boundary]]\non = [\"a.bottom\", \"b.top\"]\nfix = [\"x\", \"y\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.bottom\"\nmaster = [{list}]\nintegration = \"{integration}\"\n",
            -overlap
        )
    };
    for integration in ["merged", "slave", "mixed"] {
        for overlap in [1e-3, 0.05, 0.2] {
            let of = |list: &str| force(&run(&case(list, integration, overlap)));
            let (face, all) = (of("\"a.top\""), of("\"a.left\", \"a.top\", \"a.right\""));
            assert!(near(all, face, 1e-9) && face[0].abs() < 1e-9 * face[1], "{integration} {overlap}: {all:?} for {face:?}");
        }
    }
}

#[test]
fn masters_that_do_not_oppose_are_refused_with_the_sides_that_were_meant() {
    for tilt in [0.0, 0.01, 3.0] {
        let text = refused(&format!(
            "{HEAD}[[patch]]\nname = \"a\"\ngeometry = {{ kind = \"box\", min = [-1, -1], max = [3, 0], rotate_deg = {tilt:?} }}\nelements = [5, 4]\n\
             [[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [1, 1] }}\nelements = [7, 4]\n\
             [[boundary]]\non = \"a.bottom\"\nfix = [\"x\", \"y\"]\n[[boundary]]\non = \"b.top\"\ndirichlet = [\"0\", \"-0.02\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.left\"\nmaster = \"a.top\"\n"
        ));
        assert!(text.contains("E023") && text.contains("`b.bottom` on `a.top`"), "{tilt}: {text}");
    }
}

#[test]
fn closed_outlines_the_wrong_way_round_are_refused() {
    // a block in a frame of four lines: right counterclockwise; clockwise the frame is a solid box around the block
    let inside = |points: &[[f64; 2]], slave: &str, more: &str| {
        format!(
            "{HEAD}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1] }}\nelements = [8, 4]\n\
             [[boundary]]\non = \"b.top\"\ndirichlet = [\"0\", \"-0.02\"]\n\
             [[contact]]\nname = \"c\"\nslave = \"b.{slave}\"\nrigid = {{ {}{more} }}\n",
            polyline(points)
        )
    };
    let frame = [[-0.1, 0.0], [2.5, 0.0], [2.5, 1.7], [-0.1, 1.7], [-0.1, 0.0]];
    let clockwise: Vec<[f64; 2]> = frame.iter().rev().copied().collect();
    let right = force(&run(&inside(&frame, "bottom", "")));
    assert!(right[1] > 0.0 && right[0].abs() < 1e-9 * right[1], "{right:?}");
    for more in ["", ", force = { y = 0.01 }"] {
        for slave in ["bottom", "left", "right"] {
            let text = refused(&inside(&clockwise, slave, more));
            assert!(text.contains("E023") && text.contains("reverse the order of the points"), "{slave}: {text}");
        }
    }
    // a punch given counterclockwise is a hole around everything else
    let hole = polyline(&[[-0.5, 0.0], [0.5, 0.0], [0.5, 1.5], [-0.5, 1.5], [-0.5, 0.0]]);
    let text = refused(&PLAIN.case(&PLAIN.moved(&hole, [0.0, -0.02]), [0.0; 2]));
    assert!(text.contains("E023") && text.contains("reverse the order of the points"), "{text}");
}

#[test]
fn a_level_set_presses_as_the_surface_on_which_it_vanishes() {
    // whatever the values of f off its surface
    for (size, depth) in [(1.0, 0.02), (1e-3, 0.1), (1e3, 1e-3)] {
        let block = Block { size, ..PLAIN };
        let y = -depth * size;
        let plane = force(&run(&block.case(&format!("kind = \"half-plane\", point = [0, {y:?}], normal = [0, -1]"), [0.0; 2])));
        for f in ["Y", "Y^3", "atan(100*Y)", "atan(100*Y/L)", "Y*(1 + x^2/L^2)", "Y + Y^3/L^2", "Y^3*exp(3*Y/L)", "if(Y > 0, 2, 0.1)*Y"] {
            let f = f.replace('Y', &format!("({y:?} - y)")).replace('L', &format!("{size:?}"));
            let level = force(&run(&block.case(&format!("kind = \"level-set\", f = \"{f}\""), [0.0; 2])));
            assert!(near(level, plane, 1e-9), "{f}: {level:?} for {plane:?}");
        }
        let (x, y, r) = (0.3 * size, (1.5 - depth) * size, 1.5 * size);
        let disc = force(&run(&block.case(&format!("kind = \"sphere\", center = [{x:?}, {y:?}], radius = {r:?}"), [0.0; 2])));
        let u = format!("(((x - {x:?})^2 + (y - {y:?})^2)/{:?})", r * r);
        for f in [format!("{u} - 1"), format!("({u} - 1)^3"), format!("1 - 1/{u}"), format!("log({u})")] {
            let level = force(&run(&block.case(&format!("kind = \"level-set\", f = \"{f}\""), [0.0; 2])));
            assert!(near(level, disc, 1e-9), "{f}: {level:?} for {disc:?}");
        }
    }
}

#[test]
fn a_level_set_of_a_punch_presses_as_the_box() {
    for depth in [0.01, 0.05] {
        let punch = force(&run(&PLAIN.case(&PLAIN.moved("kind = \"box\", min = [-0.5, 0], max = [0.5, 1.5]", [0.0, -depth]), [0.0; 2])));
        let level = force(&run(
            &PLAIN.case(&format!("kind = \"level-set\", f = \"max(abs(x) - 0.5, -y)\", move = {{ y = -{depth:?} }}"), [0.0; 2])
        ));
        assert!(near(level, punch, 1e-9), "{depth}: {level:?} for {punch:?}");
    }
}

#[test]
fn a_level_set_without_a_zero_is_refused_with_the_place() {
    for f in ["1 + y^2", "exp(-y)", "2 + sin(x)"] {
        let text = refused(&PLAIN.case(&format!("kind = \"level-set\", f = \"{f}\""), [0.0; 2]));
        assert!(text.contains("E017") && text.contains("no zero at which its sign changes") && text.contains("from x = "), "{f}: {text}");
    }
}

/// A block whose left edge lies under an opponent that is sunk `depth` into its top and overhangs that edge; `tool`: as a body.
fn overhung(slave: &str, depth: f64, n: usize, tool: bool) -> String {
    let face = 1.0 - depth;
    let (patch, held, opponent) = if tool {
        let patch = format!(
            "[[patch]]\nname = \"t\"\ngeometry = {{ kind = \"box\", min = [-1, {face:?}], max = [0.7, 2] }}\nelements = [{}, {}]\n",
            n / 2,
            n / 2
        );
        (patch, "[\"b.bottom\", \"t.top\"]", "master = [\"t.bottom\", \"t.right\"]".to_owned())
    } else {
        (String::new(), "\"b.bottom\"", format!("rigid = {{ kind = \"box\", min = [-1, {face:?}], max = [0.8, 2] }}"))
    };
    format!(
        "{HEAD}[[patch]]\nname = \"b\"\ngeometry = {{ kind = \"box\", min = [0, 0], max = [2, 1] }}\nelements = [{n}, {}]\n{patch}\
         [[boundary]]\non = {held}\nfix = [\"x\", \"y\"]\n[[contact]]\nname = \"c\"\nslave = {slave}\n{opponent}\n",
        n / 2
    )
}

#[test]
fn a_side_that_meets_its_opponent_edge_on_beside_the_pressed_one_takes_no_part() {
    for (depth, n) in [(0.02, 32), (0.02, 80), (0.06, 32)] {
        for tool in [false, true] {
            let top = force(&run(&overhung("\"b.top\"", depth, n, tool)));
            let list = force(&run(&overhung("[\"b.left\", \"b.top\"]", depth, n, tool)));
            // the multiplier is lowered where two slave sides meet
            assert!(near(list, top, 0.01), "{depth} {n} {tool}: {list:?} for {top:?}");
            assert!(top[0].abs() <= 1e-9 * top[1].abs());
        }
    }
    let text = refused(&overhung("\"b.left\"", 0.02, 32, false));
    assert!(text.contains("E023"), "{text}");
}
