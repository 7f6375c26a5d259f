// One unit cube in two physical volumes.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Physical Volume("a", 7) = {1};
Physical Volume("b", 9) = {1};
Mesh.MeshSizeMin = 1;
Mesh.MeshSizeMax = 1;
