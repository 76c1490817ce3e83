// A steel bracket in the plane: two legs, a fillet in the inner corner, two bolt holes in the upright leg. Lengths in mm.
//
//   gmsh -2 -order 2 -format msh41 l-bracket.geo          (made with Gmsh 4.15.2)
//
// Cells along the holes and the fillet are curved: triangles of order 2.
leg    = 120;   // length of both legs
wide   = 40;    // their width
fillet = 15;    // radius in the inner corner
bolt   = 6;     // radius of the holes
coarse = 9;
fine   = 2.4;

Point(1) = {0, 0, 0, coarse};
Point(2) = {leg, 0, 0, coarse};
Point(3) = {leg, wide, 0, coarse};
Point(4) = {wide + fillet, wide, 0, fine};
Point(5) = {wide + fillet, wide + fillet, 0, fine};
Point(6) = {wide, wide + fillet, 0, fine};
Point(7) = {wide, leg, 0, coarse};
Point(8) = {0, leg, 0, coarse};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Circle(4) = {4, 5, 6};
Line(5) = {6, 7};
Line(6) = {7, 8};
Line(7) = {8, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7};

For k In {0 : 1}
  y = 65 + 35 * k;
  p = 20 + 10 * k;
  Point(p) = {wide / 2, y, 0, fine};
  Point(p + 1) = {wide / 2 + bolt, y, 0, fine};
  Point(p + 2) = {wide / 2, y + bolt, 0, fine};
  Point(p + 3) = {wide / 2 - bolt, y, 0, fine};
  Point(p + 4) = {wide / 2, y - bolt, 0, fine};
  Circle(p) = {p + 1, p, p + 2};
  Circle(p + 1) = {p + 2, p, p + 3};
  Circle(p + 2) = {p + 3, p, p + 4};
  Circle(p + 3) = {p + 4, p, p + 1};
  Curve Loop(2 + k) = {p, p + 1, p + 2, p + 3};
EndFor

Plane Surface(1) = {1, 2, 3};

Physical Surface("bracket") = {1};
Physical Curve("upper bolt") = {30, 31, 32, 33};
Physical Curve("lower bolt") = {20, 21, 22, 23};
Physical Curve("load") = {2};
Physical Curve("fillet") = {4};
Physical Point("tip") = {3};
