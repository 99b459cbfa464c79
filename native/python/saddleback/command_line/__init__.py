# SPDX-License-Identifier: MIT
"""The command ``saddleback``: files in, files out. Each verb's module is imported when the verb is asked for."""

from __future__ import annotations

import importlib
import os
import sys
import warnings
from typing import Any

from saddleback import Error, __version__

try:
    import click
except ImportError:
    raise SystemExit("saddleback: the command line needs click, which is not here; pip install click") from None

# Where each verb lives, and what the list of verbs says of it: nothing else is imported to show that.
_VERBS = {
    "info": ("mesh_verbs", "Size, topology and faults of meshes."),
    "repair": ("mesh_verbs", "Make a valid mesh of nearly anything."),
    "graph": ("distance_verbs", "Build the distance graph of a mesh, whole or in parts, to be used again."),
    "distance": ("distance_verbs", "Geodesic distances of all vertices from points."),
    "path": ("distance_verbs", "The shortest path between two points."),
    "cells": ("cell_verbs", "Even cells, or the cells of given sites: with their dual, split mesh and edges."),
    "voronoi2d": ("plane_verbs", "Voronoi diagrams of the plane."),
    "field": ("shape_verbs", "Smooth directions all over the surface."),
    "distribute": ("shape_verbs", "Copies of shapes on the surface that never collide."),
    "check": ("shape_verbs", "Check what distribute wrote: do no two copies collide?"),
    "bench": ("bench_verb", "How long this machine takes for what a mesh is asked."),
    "completion": ("completion_verb", "The script that completes verbs and options in a shell."),
}
_COMPLETE = "_SADDLEBACK_COMPLETE"
FAILED, INTERRUPTED, PIPE_CLOSED = 1, 130, 141  # exit codes; 2 is a wrong command line, 3 a check that found faults


class _Verbs(click.Group):
    """Loads a verb's module when it is needed."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _VERBS:
            return None
        module = importlib.import_module(f"{__name__}.{_VERBS[cmd_name][0]}")
        command: click.Command = getattr(module, cmd_name)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Verbs"):
            formatter.write_dl([(name, text) for name, (_, text) in _VERBS.items()])

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        if args and not args[0].startswith("-") and args[0] not in _VERBS:
            ctx.fail(f"{args[0]!r} is no verb; one of {', '.join(_VERBS)}")
        return super().resolve_command(ctx, args)


@click.command(
    cls=_Verbs,
    subcommand_metavar="VERB ...",
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
    epilog="Meshes are obj, ply, off or stl, compressed with .gz or not. `saddleback VERB --help` tells more. "
    "Exit codes: 0 done, 1 failed, 2 wrong command line, 3 a check found faults, 130 Ctrl-C, 141 pipe closed.",
)
@click.version_option(__version__, "--version", message="saddleback %(version)s")
def commands() -> None:
    """Geodesic distances, Voronoi cells and patterns on triangle meshes."""


def run(arguments: list[str] | None = None) -> int:
    """Run a command line and return its exit code; whatever is wrong is one sentence on stderr."""
    warnings.showwarning = lambda message, *_: click.echo(f"saddleback: warning: {message}", err=True)
    try:
        if wanted := os.environ.get(_COMPLETE):
            from click.shell_completion import shell_complete

            return shell_complete(commands, {}, "saddleback", _COMPLETE, wanted)
        with commands.make_context("saddleback", sys.argv[1:] if arguments is None else list(arguments)) as context:
            code = commands.invoke(context)
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except click.exceptions.Exit as done:
        return done.exit_code
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except (click.Abort, KeyboardInterrupt):
        click.echo("saddleback: interrupted", err=True)
        return INTERRUPTED
    except BrokenPipeError:
        # Python flushes stdout once more at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        click.echo("saddleback: the pipe was closed before everything was said", err=True)
        return PIPE_CLOSED
    except (ValueError, OSError, RuntimeError, MemoryError, ImportError, Error) as error:
        click.echo(f"saddleback: error: {str(error) or type(error).__name__}", err=True)
        return FAILED


def main() -> None:
    """Run what the shell asks for."""
    sys.exit(run())
