//! Node orders, linear pieces and interpolation.

use super::*;

#[test]
fn node_lists_hold_every_index_once() {
    for p in 1..6 {
        let mut quads = nodes(Cell::Tensor, [p, p + 1]);
        quads.sort_unstable();
        quads.dedup();
        assert_eq!(quads.len(), (p + 1) * (p + 2));
        let mut hexes = nodes(Cell::Tensor, [p, 2, 3]);
        hexes.sort_unstable();
        hexes.dedup();
        assert_eq!(hexes.len(), (p + 1) * 12);
        let mut triangles = nodes(Cell::Simplex, [p, p]);
        triangles.sort_unstable();
        triangles.dedup();
        assert_eq!(triangles.len(), (p + 1) * (p + 2) / 2);
        let mut tetrahedra = nodes(Cell::Simplex, [p, p, p]);
        tetrahedra.sort_unstable();
        tetrahedra.dedup();
        assert_eq!(tetrahedra.len(), (p + 1) * (p + 2) * (p + 3) / 6);
    }
}

#[test]
fn linear_pieces_fill_the_cell() {
    for p in 1..5 {
        let triangle = nodes(Cell::Simplex, [p, p]);
        assert_eq!(linear_pieces(Cell::Simplex, [p, p], &triangle).len(), p * p);
        let tetrahedron = nodes(Cell::Simplex, [p, p, p]);
        let bodies = linear_pieces(Cell::Simplex, [p, p, p], &tetrahedron);
        assert_eq!(bodies.iter().map(|ways| ways[0].len()).sum::<usize>(), p * p * p);
        let x: Vec<_> = tetrahedron.iter().map(|a| Vector::<3>::from_fn(|k, _| a[k] as f64)).collect();
        for piece in bodies.iter().flatten().flatten() {
            assert_eq!(determinants::<3, 3>(&x, piece), [1.0, 1.0], "piece {piece:?} of degree {p}");
        }
        let quad = nodes(Cell::Tensor, [p, 2]);
        assert_eq!(linear_pieces(Cell::Tensor, [p, 2], &quad).len(), 2 * p);
    }
}

/// Six times the volume behind the lattice triangles of the four sides, which neighbours cut alike.
fn within_sides(p: usize, x: impl Fn([usize; 3]) -> Vector<3>) -> f64 {
    let sides: [[[usize; 3]; 3]; 4] = [
        [[0, 0, 0], [0, 1, 0], [1, 0, 0]],
        [[0, 0, 0], [1, 0, 0], [0, 0, 1]],
        [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ];
    let side = |[a, b, c]: [[usize; 3]; 3]| -> f64 {
        let at = |i: usize, j: usize| x(std::array::from_fn(|k| (p - i - j) * a[k] + i * b[k] + j * c[k]));
        let flux = |a: Vector<3>, b: Vector<3>, c: Vector<3>| a.cross(&b).dot(&c);
        let triangles = (0..p).flat_map(|j| (0..p - j).map(move |i| (i, j)));
        triangles
            .map(|(i, j)| {
                let between = if i + j + 2 > p { 0.0 } else { flux(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) };
                flux(at(i, j), at(i + 1, j), at(i, j + 1)) + between
            })
            .sum()
    };
    sides.into_iter().map(side).sum()
}

#[test]
fn every_cut_of_a_bent_tetrahedron_fills_what_its_sides_enclose() {
    for p in 1..=5 {
        let of = Interpolant::<3>::new(Cell::Simplex, [p; 3], 1);
        let bent = |x: &Vector<3>| Vector::<3>::new(x[0] + 0.3 * x[1] * x[1], x[1] - 0.2 * x[2] * x[0], x[2] + 0.25 * x[0] * x[0]);
        let x: Vec<_> = of.lattice.iter().map(bent).collect();
        let expected = within_sides(p, |a| bent(&(Vector::<3>::from_fn(|k, _| a[k] as f64) / p as f64)));
        for way in 0..3 {
            let own = of.linear.iter().flat_map(|ways| &ways[way % ways.len()]);
            let volume: f64 = own.map(|piece| determinants::<3, 3>(&x, piece)[1]).sum();
            assert!((volume - expected).abs() < 1e-13 && volume > 0.5, "degree {p}, way {way}: {volume} {expected}");
        }
    }
}

/// Volume of a hexahedron or tetrahedron, area of a quadrilateral or triangle with straight edges, times a positive number.
fn signed<const D: usize>(nodes: &[[usize; D]], corners: &[usize]) -> f64 {
    let x = |i: usize| nalgebra::Vector3::from_fn(|k, _| if k < D { nodes[corners[i]][k] as f64 } else { 0.0 });
    let third = if D == 2 { nalgebra::Vector3::z() } else { x(if corners.len() == 8 { 4 } else { 3 }) - x(0) };
    let second = if corners.len() == 3 || corners.len() == 4 && D == 3 { 2 } else { 3 };
    (x(1) - x(0)).cross(&(x(second) - x(0))).dot(&third)
}

#[test]
fn cells_of_left_handed_elements_are_mirrored() {
    fn check<const D: usize>(cell: Cell, degree: [usize; D]) {
        let of = Interpolant::<D>::new(cell, degree, 1);
        let corners = if cell == Cell::Simplex { D + 1 } else { 1 << D };
        // the second places are mirrored
        let swapped = |xi: &Vector<D>| Vector::<D>::from_fn(|k, _| xi[if k < 2 { 1 - k } else { k }]);
        let mirror: Vec<_> = of.lattice.iter().map(swapped).collect();
        let linear = [of.cut(&of.lattice, false), of.cut(&mirror, true)].map(|(pieces, positive)| {
            assert!(positive);
            pieces
        });
        assert!(!of.cut(&mirror, false).1, "a map that is inside out is noticed");
        assert_eq!(of.cut(&mirror, false).0, linear[1], "and its cells are turned all the same");
        for (list, count) in [(&of.whole, of.nodes.len()), (&linear, corners)] {
            assert_eq!(list[0].len(), list[1].len());
            for (right, left) in list[0].iter().zip(&list[1]) {
                let (a, b) = (signed(&of.nodes, &right[..corners]), signed(&of.nodes, &left[..corners]));
                assert!(a > 0.0 && b < 0.0, "{cell:?} {degree:?}: {a} {b}");
                let sorted = |list: &[usize]| {
                    let mut list = list.to_vec();
                    list.sort_unstable();
                    list
                };
                assert_eq!((sorted(right), right.len()), (sorted(left), count));
            }
        }
    }
    for p in 1..=4 {
        check(Cell::Tensor, [p, 2]);
        check(Cell::Tensor, [p, 2, 3]);
        check(Cell::Simplex, [p, p]);
        check(Cell::Simplex, [p, p, p]);
    }
}

#[test]
fn neighbours_of_any_shape_see_a_common_node_alike() {
    // the point at 1/3 of an edge: degree 3 on a triangle, 6 along the edge of a quadrilateral
    assert_eq!(around(Cell::Simplex, [3, 3], [1, 0]), Some(vec![(0, 2), (1, 1)]));
    assert_eq!(around(Cell::Tensor, [6, 4], [2, 0]), Some(vec![(0, 2), (1, 1)]));
    assert_eq!(around(Cell::Tensor, [6, 4], [6, 4]), Some(vec![(3, 1)]));
    assert_eq!(around(Cell::Tensor, [2, 2, 2], [1, 2, 1]).map(|list| list.len()), Some(4));
    assert_eq!(around(Cell::Tensor, [2, 2], [1, 1]), None);
    assert_eq!(around(Cell::Simplex, [3, 3], [1, 1]), None);
}

#[test]
fn bernstein_interpolation_of_high_degree_keeps_twelve_digits() {
    let of = Interpolant::<2>::new(Cell::Tensor, [10, 10], 1);
    let f = |xi: &Vector<2>| xi[0].powi(10) - 3.0 * xi[0] * xi[1].powi(9) + 0.5;
    let values = nalgebra::DVector::from_iterator(of.points.len(), of.points.iter().map(f));
    let coefficients = &of.to_bezier * values;
    for xi in [Vector::<2>::new(0.1, 0.9), Vector::<2>::new(1.0, 1.0), Vector::<2>::new(0.0, 0.37)] {
        let b = bernstein(Cell::Tensor, &of.nodes, [10, 10], &xi);
        let value: f64 = b.iter().zip(coefficients.iter()).map(|(b, c)| b * c).sum();
        assert!((value - f(&xi)).abs() < 1e-11, "{value} {}", f(&xi));
    }
}
