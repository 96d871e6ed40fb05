// Cook's membrane (Cook, Malkus, Plesha 1989), m. Mesh: gmsh -2 -order 2 -format msh41 cook.geo
Point(1) = {0, 0, 0};
Point(2) = {48, 44, 0};
Point(3) = {48, 60, 0};
Point(4) = {0, 44, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = 17;
Transfinite Curve {2, 4} = 17;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1} = {1, 2, 3, 4} Alternated;
Physical Curve("clamp") = {4};
Physical Curve("end") = {2};
Physical Surface("membrane") = {1};
