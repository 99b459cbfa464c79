# SPDX-License-Identifier: MIT
"""The check as a command: ``python -m saddleback.check MESH PLACEMENTS``; status 1 when shapes collide."""

import argparse
import sys
from collections.abc import Sequence

import saddleback as sb


def main(arguments: Sequence[str] | None = None) -> int:
    """Check a file of placements on a mesh and print what was found; 0 without a fault, 1 with one, 2 for bad input."""
    parser = argparse.ArgumentParser(prog="python -m saddleback.check", description="Finds shapes that collide.")
    parser.add_argument("mesh", help="an .obj, .ply, .off or .stl file")
    parser.add_argument("placements", help="a file of write_placements")
    parser.add_argument("--samples", type=int, default=1_000_000, help="points of the surface that are tried")
    parser.add_argument("--seed", type=int, default=0, help="of the samples")
    options = parser.parse_args(arguments)
    try:
        mesh = sb.read_mesh(options.mesh)
        shapes, placements = sb.read_placements(options.placements, mesh)
        mapped = sb.map_shapes(mesh, shapes, placements, sb.read_placement_field(options.placements, mesh))
        report = sb.check_distribution(mesh, mapped, samples=options.samples, seed=options.seed)
    except (sb.Error, OSError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 2
    print(report)
    print(f"coverage {100 * report.coverage:.3f} % +- {100 * report.coverage_error:.3f} %")
    return 0 if report else 1


if __name__ == "__main__":
    sys.exit(main())
