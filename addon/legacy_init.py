"""What the legacy zip, for Blender 3.4 to 4.1, adds to the package's __init__.py; extensions have a manifest."""

import sys
from pathlib import Path

bl_info = {
    "name": "Saddleback",
    "author": "The Saddleback maintainers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Saddleback",
    "description": "Geodesic Voronoi cells and even tessellations of painted meshes",
    "category": "Mesh",
}

sys.path.append(str(Path(__file__).resolve().parent / "lib"))
