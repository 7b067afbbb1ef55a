// An arch of seven stones, meshed with hexahedra: gmsh -3 -format msh22 arch.geo
// Bodies of Brickwall share no nodes, so each stone has points, curves and surfaces of its own.
stones = 7; inner = 1.0; outer = 1.2; width = 0.3;           // m
around = 5; through = 4; across = 4;                         // elements of a stone
centre[] = {newp, newp + 1};
Point(centre[0]) = {0, 0, 0}; Point(centre[1]) = {0, width, 0};
For i In {0:stones-1}
  p = newp; l = newc; s = news;
  For side In {0:1}                                          // the sections at y = 0 and y = width
    For end In {0:1}                                         // the joints with the stones before and after
      angle = Pi*(i + end)/stones;
      Point(p + 4*side + 2*end) = {inner*Cos(angle), width*side, inner*Sin(angle)};
      Point(p + 4*side + 2*end + 1) = {outer*Cos(angle), width*side, outer*Sin(angle)};
    EndFor
    a = p + 4*side; c = l + 4*side;
    Line(c) = {a, a+1}; Circle(c+1) = {a+1, centre[side], a+3}; Line(c+2) = {a+3, a+2}; Circle(c+3) = {a+2, centre[side], a};
    Transfinite Curve {c, c+2} = through + 1; Transfinite Curve {c+1, c+3} = around + 1;
    Curve Loop(s + side) = {c:c+3}; Plane Surface(s + side) = {s + side};
  EndFor
  Line(l+8) = {p, p+4}; Line(l+9) = {p+1, p+5}; Line(l+10) = {p+3, p+7}; Line(l+11) = {p+2, p+6};
  Transfinite Curve {l+8:l+11} = across + 1;
  For k In {0:3}                                             // s+2: first joint, s+3: back, s+4: second joint, s+5: inside
    Curve Loop(s+2+k) = {l+k, l+8+(k+1)%4, -(l+4+k), -(l+8+k)}; Surface(s+2+k) = {s+2+k};
  EndFor
  Transfinite Surface {s:s+5}; Recombine Surface {s:s+5};    // quadrilaterals in place of triangles
  Surface Loop(s) = {s:s+5}; Volume(i + 1) = {s}; Transfinite Volume {i + 1};    // and hexahedra
  back[] += s + 3;
  If (i == 0) feet[] += s + 2; EndIf
  If (i == stones - 1) feet[] += s + 4; EndIf
EndFor
Physical Volume("stone") = {1:stones};
Physical Surface("back") = back[];
Physical Surface("feet") = feet[];
