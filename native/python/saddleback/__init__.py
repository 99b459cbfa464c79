"""Geodesic Voronoi cells and even tessellations on triangle meshes."""

from saddleback._devices import Device, cuda_status, devices
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
    "Device",
    "DeviceError",
    "Error",
    "InputError",
    "Job",
    "Mesh",
    "MeshError",
    "__version__",
    "cuda_status",
    "devices",
]
