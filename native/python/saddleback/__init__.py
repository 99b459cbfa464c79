"""Geodesic Voronoi cells and even tessellations on triangle meshes."""

from saddleback._devices import Device, cuda_status, devices
from saddleback._saddleback import (
    Cancelled,
    DeviceError,
    Error,
    GeodesicPath,
    InputError,
    Job,
    Mesh,
    MeshError,
    RepairReport,
    SurfacePoints,
    TracedPath,
    __version__,
    repair,
    project,
    sample,
    trace,
)

__all__ = [
    "Cancelled",
    "Device",
    "DeviceError",
    "Error",
    "GeodesicPath",
    "InputError",
    "Job",
    "Mesh",
    "MeshError",
    "RepairReport",
    "SurfacePoints",
    "TracedPath",
    "__version__",
    "cuda_status",
    "devices",
    "repair",
    "project",
    "sample",
    "trace",
]
