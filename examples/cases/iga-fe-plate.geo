// A quarter of a square plate without the ring 1 < r < 2 around its hole, which a NURBS patch fills.
//
//   gmsh -2 -order 2 -format msh41 iga-fe-plate.geo       (made with Gmsh 4.15.2)
//
// Cells along the arc r = 2 are curved: triangles of order 2.
half = 4;
arc  = 2;

Point(1) = {0, 0, 0, 0.3};
Point(2) = {arc, 0, 0, 0.3};
Point(3) = {half, 0, 0, 0.7};
Point(4) = {half, half, 0, 0.7};
Point(5) = {0, half, 0, 0.7};
Point(6) = {0, arc, 0, 0.3};
Line(1) = {2, 3};
Line(2) = {3, 4};
Line(3) = {4, 5};
Line(4) = {5, 6};
Circle(5) = {6, 1, 2};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};

Physical Surface("plate") = {1};
Physical Curve("x axis") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("y axis") = {4};
Physical Curve("arc") = {5};
