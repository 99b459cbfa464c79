# SPDX-License-Identifier: MIT
"""``saddleback completion``."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class


@click.command("completion", no_args_is_help=True)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    """Print the script that completes verbs and options in a shell.

    bash and zsh: eval "$(saddleback completion bash)" in ~/.bashrc or ~/.zshrc, with the shell's name. fish: saddleback
    completion fish > ~/.config/fish/completions/saddleback.fish
    """
    from saddleback.command_line import commands

    kind = get_completion_class(shell)
    assert kind is not None
    click.echo(kind(commands, {}, "saddleback", "_SADDLEBACK_COMPLETE").source())
