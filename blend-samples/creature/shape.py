# SPDX-License-Identifier: GPL-3.0-or-later
"""A chameleon: the solids that it is made of, its painted density, and the places of its eyes.

x points from tail to head, z up; the branch under its feet runs along x. Lengths are in units of about ten centimeters.
"""

from __future__ import annotations

import numpy as np
from implicit import Array, Tube, catmull_rom, mirrored, tube

EYE_CENTER = np.array([1.30, 0.262, 0.845])
EYE_AXIS = np.array([0.22, 0.97, 0.06]) / np.linalg.norm([0.22, 0.97, 0.06])
TAIL_CENTER = np.array([-1.72, 0.0, -0.15])
MOUTH = np.array([(1.80, 0.655), (1.66, 0.625), (1.48, 0.60), (1.30, 0.575), (1.14, 0.60), (1.04, 0.66)])
BRANCH_HEIGHT = -0.13


def tail_stations() -> list[tuple[float, ...]]:
    """The tail as a spiral in the plane y = 0 that tightens and thins towards its tip."""
    turn = np.linspace(0, 1, 64)
    angle = np.pi / 2 + turn * 2 * np.pi * 2.0
    away = 0.60 * (1 - 0.86 * turn**0.9)
    radius = 0.100 * (1 - turn) ** 0.75 + 0.030
    x = TAIL_CENTER[0] + away * np.cos(angle)
    z = TAIL_CENTER[2] + away * np.sin(angle)
    return [(*row,) for row in np.stack([x, 0 * x, z, radius, 0.92 * radius], axis=1)]


def trunk() -> list[Tube]:
    """Body, neck and tail."""
    body = [
        (-1.72, 0, 0.450, 0.122, 0.112),
        (-1.30, 0, 0.485, 0.155, 0.135),
        (-1.00, 0, 0.540, 0.220, 0.178),
        (-0.68, 0, 0.620, 0.330, 0.228),
        (-0.30, 0, 0.690, 0.430, 0.278),
        (0.12, 0, 0.710, 0.450, 0.290),
        (0.50, 0, 0.690, 0.375, 0.255),
        (0.82, 0, 0.69, 0.285, 0.215),
        (1.02, 0, 0.72, 0.26, 0.215),
    ]
    return [tube(body, 0.05, 48), Tube(np.array(tail_stations()), 0.03)]


def head() -> list[Tube]:
    """Skull, jaws, the casque with its ridges, and the turrets of the eyes."""
    skull = [
        (0.96, 0, 0.77, 0.25, 0.22),
        (1.14, 0, 0.785, 0.245, 0.23),
        (1.34, 0, 0.735, 0.20, 0.195),
        (1.54, 0, 0.68, 0.145, 0.150),
        (1.70, 0, 0.645, 0.098, 0.105),
    ]
    casque = [
        (1.42, 0, 0.86, 0.085, 0.09),
        (1.22, 0, 0.99, 0.12, 0.10),
        (1.02, 0, 1.14, 0.115, 0.075),
        (0.84, 0, 1.275, 0.065, 0.042),
        (0.765, 0, 1.335, 0.032, 0.028),
    ]
    throat = [(0.92, 0, 0.55, 0.16, 0.13), (1.18, 0, 0.545, 0.13, 0.12), (1.42, 0, 0.57, 0.085, 0.095)]
    brow = [
        (1.73, 0.055, 0.70, 0.028),
        (1.58, 0.115, 0.80, 0.036),
        (1.40, 0.165, 0.945, 0.042),
        (1.22, 0.165, 1.035, 0.042),
        (1.02, 0.105, 1.155, 0.038),
        (0.84, 0.03, 1.29, 0.034),
    ]
    cheek = [
        (1.02, 0.14, 1.06, 0.035),
        (0.99, 0.20, 0.90, 0.045),
        (1.02, 0.205, 0.76, 0.045),
        (1.12, 0.195, 0.64, 0.04),
    ]
    socket = EYE_CENTER - 0.07 * EYE_AXIS
    rim = EYE_CENTER + 0.068 * EYE_AXIS
    turret = Tube(np.array([[*socket, 0.150, 0.150], [*rim, 0.082, 0.082]]), 0.045)
    nose = tube([(1.66, 0.0, 0.72, 0.05), (1.715, 0.0, 0.80, 0.034), (1.755, 0.0, 0.885, 0.013)], 0.05)
    sides = [tube(brow, 0.045, 40), tube(cheek, 0.05, 24), turret]
    return [
        tube(skull, 0.10, 32),
        tube(throat, 0.10, 16),
        tube(casque, 0.10, 32),
        nose,
        *[part for side in sides for part in (side, mirrored(side))],
    ]


def foot(x: float, y: float, ahead: float) -> list[Tube]:
    """A hand like a mitten: one bundle of toes on each side of the branch, claws at their ends."""
    parts = []
    for bundle, (inward, spread) in enumerate(((-0.20, (-0.085, 0.0, 0.085)), (0.10, (-0.055, 0.06)))):
        for lean in spread:
            tip = x + ahead * (0.05 + 0.02 * bundle) + 1.1 * lean
            knots = [
                (x + 0.3 * lean, y, 0.035, 0.058),
                (x + 0.7 * lean, y + 0.45 * inward, 0.045 - 0.03 * bundle, 0.047),
                (tip, y + inward * (0.95 if bundle == 0 else 1.1), -0.03 - 0.05 * bundle, 0.040),
                (tip + 0.012, y + inward * (1.12 if bundle == 0 else 1.25), -0.115 - 0.03 * bundle, 0.026),
            ]
            parts.append(tube(knots, 0.022, 14))
    return parts


def leg(hip: Array, knee: Array, wrist: Array, thick: float, ahead: float) -> list[Tube]:
    """A leg on the side y > 0, bent at the knee."""
    upper = hip + 0.5 * (knee - hip) + [0, 0.03, 0.02]
    lower = knee + 0.55 * (wrist - knee) + [0, 0.015, 0]
    knots = [
        (*hip, 1.35 * thick),
        (*upper, 1.12 * thick),
        (*knee, 0.86 * thick),
        (*lower, 0.78 * thick),
        (*wrist, 0.55 * thick),
        (wrist[0], wrist[1], 0.03, 0.060),
    ]
    return [tube(knots, 0.07, 36), *foot(wrist[0], wrist[1], ahead)]


def legs() -> list[Tube]:
    """Four legs in a walk: the left hand and the right foot reach forward."""
    left = [
        leg(np.array([0.60, 0.17, 0.46]), np.array([0.56, 0.40, 0.335]), np.array([0.86, 0.105, 0.12]), 0.098, 1.0),
        leg(np.array([-0.74, 0.15, 0.44]), np.array([-0.66, 0.40, 0.37]), np.array([-0.86, 0.105, 0.12]), 0.112, -1.0),
    ]
    right = [
        leg(np.array([0.56, 0.17, 0.46]), np.array([0.24, 0.42, 0.34]), np.array([0.40, 0.105, 0.12]), 0.098, 1.0),
        leg(np.array([-0.72, 0.15, 0.44]), np.array([-0.29, 0.45, 0.36]), np.array([-0.42, 0.105, 0.12]), 0.112, 1.0),
    ]
    return [p for limb in left for p in limb] + [mirrored(p) for limb in right for p in limb]


def crest() -> list[Tube]:
    """Spikes along the back, the edge of the casque and the throat."""
    parts = []
    back = np.array(
        [
            (0.80, 0.98),
            (0.50, 1.06),
            (0.12, 1.155),
            (-0.30, 1.115),
            (-0.68, 0.945),
            (-1.0, 0.755),
            (-1.35, 0.635),
            (-1.72, 0.57),
        ]
    )
    line = catmull_rom(back, 28)
    along = np.gradient(line, axis=0)
    up = np.stack([-along[:, 1], along[:, 0]], axis=1)
    up *= np.sign(up[:, 1:]) / np.linalg.norm(up, axis=1, keepdims=True)
    for i, (point, normal) in enumerate(zip(line, up, strict=True)):
        height = 0.085 * (1 - 0.62 * (i / 27) ** 1.2)
        lean = np.array([-0.35, 0.0])
        tip = point + height * (normal + lean)
        root = point - 0.04 * normal
        parts.append(tube([(root[0], 0, root[1], 0.05, 0.036), (tip[0], 0, tip[1], 0.013, 0.013)], 0.03))
    chin = catmull_rom(np.array([(1.60, 0.545), (1.40, 0.475), (1.16, 0.415), (0.92, 0.40), (0.72, 0.40)]), 10)
    for i, point in enumerate(chin):
        height = 0.035 + 0.05 * np.sin(np.pi * (i + 1.5) / 11)
        parts.append(
            tube([(point[0], 0, point[1] + 0.03, 0.032), (point[0] - 0.02, 0, point[1] - height, 0.011)], 0.03)
        )
    return parts


def parts() -> list[Tube]:
    """Every solid, in the order in which they blend."""
    return [*trunk(), *head(), *legs(), *crest()]
