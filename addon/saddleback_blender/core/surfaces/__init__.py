"""Places on surfaces and what they carry: frames, normals, walks, grids."""
