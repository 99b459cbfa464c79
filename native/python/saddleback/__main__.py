# SPDX-License-Identifier: MIT
"""``python -m saddleback``: the command line."""

from saddleback.command_line import main

main()
