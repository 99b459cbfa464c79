"""Geodesic Voronoi cells and even tessellations on triangle meshes."""

from saddleback._saddleback import (
    Cancelled,
    DeviceError,
    Error,
    InputError,
    Job,
    Mesh,
    MeshError,
    __version__,
)

__all__ = [
    "Cancelled",
    "DeviceError",
    "Error",
    "InputError",
    "Job",
    "Mesh",
    "MeshError",
    "__version__",
]
