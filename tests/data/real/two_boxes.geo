// Two unit cubes that share a face, in two physical volumes; the face x = 0 is a physical surface.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {1, 0, 0, 1, 1, 1};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume("left", 7) = {1};
Physical Volume("right", 9) = {2};
Physical Surface("clamp", 3) = {1};
Mesh.MeshSizeMin = 1;
Mesh.MeshSizeMax = 1;
