//! Fill of the nested dissection beside that of METIS on the same graphs.

use crate::common::graphs;
use faying::linalg::ordering;

/// Entries of the Cholesky factor, diagonal included, under `METIS_NodeND` of METIS 5.1.0 (Debian 5.1.0.dfsg-7) with its default options,
/// given the graph of all unknowns without their places.
const METIS: [(&str, usize); 23] = [
    ("square, p = 1", 490_107),
    ("square, turned, p = 2", 724_724),
    ("square, graded to 1/1000, p = 2", 724_724),
    ("ring, p = 1, two components", 695_820),
    ("ring, p = 3", 1_323_936),
    ("ring, p = 5", 1_540_226),
    ("strip 1 : 100, p = 2", 318_996),
    ("cube, p = 1", 841_984),
    ("cube, p = 2", 1_054_731),
    ("cube, graded to 1/1000, p = 1", 841_984),
    ("thick ring, p = 2, three components", 2_939_397),
    ("plate 1 : 100, p = 1, three components", 2_780_442),
    ("shell 1 : 100, p = 2", 2_595_631),
    ("ring of thin cells, p = 2", 267_651),
    ("ring of thin cells, p = 3", 791_245),
    ("thick ring of thin cells, p = 2", 779_391),
    ("coil of thin cells, p = 2", 267_651),
    ("three sheets in one place", 183_022),
    ("points in the square", 226_787),
    ("points in the cube", 274_076),
    ("two tied squares with multipliers", 1_512_689),
    ("triangles, two components", 904_471),
    ("tetrahedra", 2_272_028),
];

#[test]
fn fill_is_within_fifteen_per_cent_of_metis_on_every_body() {
    let graphs = graphs::graphs();
    assert_eq!(graphs.len(), METIS.len());
    for ((name, graph), (same, metis)) in graphs.iter().zip(METIS) {
        assert_eq!(*name, same);
        let order = ordering::nested_dissection(&graph.ptr, &graph.cols, &graph.places).unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(k, &i)| k == i), "{name}: no order of all unknowns");
        let fill = ordering::factor_entries(&graph.ptr, &graph.cols, &order);
        let ratio = fill as f64 / metis as f64;
        println!("{name}: {fill}, {ratio:.3} of METIS");
        assert!(ratio < 1.15, "{name}: {fill} entries, METIS {metis}");
    }
}

/// Places decide where a body is cut, so its size and its position must not.
#[test]
fn fill_does_not_depend_on_units_and_little_on_position() {
    for (name, graph) in graphs::graphs() {
        let fill = |places: &[[f64; 3]]| {
            ordering::factor_entries(&graph.ptr, &graph.cols, &ordering::nested_dissection(&graph.ptr, &graph.cols, places).unwrap())
        };
        let reference = fill(&graph.places);
        // powers of two: the same rounding
        for unit in [2f64.powi(-600), 2f64.powi(-30), 2f64.powi(30), 2f64.powi(600)] {
            assert_eq!(fill(&graph.places.iter().map(|x| x.map(|x| unit * x)).collect::<Vec<_>>()), reference, "{name} in {unit:e}");
        }
        let (c, s) = (0.3f64.cos(), 0.3f64.sin());
        let turned: Vec<[f64; 3]> =
            graph.places.iter().map(|x| [c * x[0] - s * x[1] + 5.0, s * x[0] + c * x[1] - 3.0, x[2] + 1.0]).collect();
        let ratio = fill(&turned) as f64 / reference as f64;
        println!("{name}: turned {ratio:.3}");
        assert!((0.85..1.15).contains(&ratio), "{name}: {ratio}");
    }
}
