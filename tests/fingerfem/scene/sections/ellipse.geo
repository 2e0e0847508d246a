SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 0.008, 0.006};                  // drawn in (x, y)
Rectangle(2) = {0.003, -0.001, 0, 0.002, 0.002};    // the channel of F1, offset = [0.004, 0.0]
BooleanFragments{ Surface{1}; Delete; }{ Surface{2}; Delete; }
Rotate{ {1, 1, 1}, {0, 0, 0}, 2 * Pi / 3 }{ Surface{:}; }    // x becomes y, y becomes z
Physical Surface("channel F1") = {2};
Physical Surface("rubber") = {3};
Mesh.RecombineAll = 1;
Mesh.RecombinationAlgorithm = 3;
Mesh.MeshSizeMax = 0.0022;
