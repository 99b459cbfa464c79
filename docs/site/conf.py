# SPDX-License-Identifier: MIT
"""The reference site, which docs/site/build makes of docs/. https://www.sphinx-doc.org tells of the settings."""

import ast
import os
import re
import sys
from pathlib import Path

import tomllib

DOCS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(DOCS.parent))
from tests.tooling.signatures import STUB, functions

PROJECT = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]

project = "Saddleback"
author = "The Saddleback maintainers"
copyright = f"2026 {author}"
release = PROJECT["version"]
root_doc = "README"
html_theme = "furo"
html_title = f"Saddleback {release}"
# Doxygen's pages of the C++ library, where docs/site/build finds it.
html_extra_path = [path for path in [os.environ.get("SADDLEBACK_DOXYGEN", "")] if path]
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinxcontrib.mermaid",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["site/gallery", "site/templates", "**/.ipynb_checkpoints", "site/made/gallery/*.ipynb", "**.py"]
templates_path = [str(DOCS / "site/templates")]
nitpicky = False

# Pages in Markdown, as GitHub shows them.
myst_heading_anchors = 4
myst_fence_as_directive = ["mermaid"]

# Notebooks are kept without results and run for the site.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120

# One page for each public name.
autosummary_generate = True
autosummary_imported_members = True
autosummary_ignore_module_all = False
autodoc_default_options = {"members": True, "undoc-members": True}
autodoc_typehints = "signature"
napoleon_use_param = napoleon_use_rtype = False  # types are prose, whose words are no references
default_role = "code"

sphinx_gallery_conf = {
    "examples_dirs": "site/gallery",
    "gallery_dirs": "site/made/gallery",
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
    "remove_config_comments": True,
    "abort_on_example_error": True,
}

CONTENTS = """

```{{toctree}}
:hidden:
:glob:

{}
```
"""
FIRST = (
    "manual/README",
    "python/README",
    "site/reference",
    "site/made/gallery/index",
    "site/notebooks/index",
    "algorithms/README",
)


def read(app: object, docname: str, source: list[str]) -> None:
    """Give each README the contents of its folder, and lead what leaves docs/ to the repository."""
    folder, _, name = docname.rpartition("/")
    page = DOCS / folder
    if name == "README":
        inner = [f"{path.parent.name}/README" for path in sorted(page.glob("*/README.md"))] if folder else []
        source[0] += CONTENTS.format("\n".join(["*", *inner] if folder else [*FIRST, "*"]))

    def target(found: re.Match[str]) -> str:
        path = (page / found[1]).resolve()
        if path.is_relative_to(DOCS) and not path.is_dir():
            return found[0]
        inside = path.relative_to(DOCS.parent).as_posix()
        return f"]({PROJECT['urls']['Source']}/blob/main/{inside}{found[2] or ''})"

    source[0] = re.sub(r"\]\(([^)#:\s]+)(#[^)\s]*)?\)", target, source[0])


def as_written(app: object, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Show the type of a property, which stands before its first colon, and bars of magnitudes as they are written."""
    lines[:] = [re.sub(r"^:type: (.*)$", r"``\1``", line).replace("|", r"\|") for line in lines]


TYPED = functions()
ALIASES = dict(re.findall(r"^(_\w+): TypeAlias = (.*?)(?:  #.*)?$", STUB.read_text(encoding="utf-8"), re.MULTILINE))


def typed(
    app: object, what: str, name: str, obj: object, options: object, signature: str, returns: str
) -> tuple[str, str | None] | None:
    """Show the stub's types, for the compiled module knows of objects alone."""
    node = TYPED.get(name.removeprefix("saddleback."))
    if node is None or what not in ("function", "method"):
        return None
    given = re.sub(r"^self(, )?", "", ast.unparse(node.args))
    found = ast.unparse(node.returns) if node.returns else None
    while re.search(r"\b_[A-Z]\w+", given + (found or "")):  # aliases may hold others
        given, found = (text and re.sub(r"\b_[A-Z]\w+", lambda m: ALIASES[m[0]], text) for text in (given, found))
    return f"({given})", found


def setup(app) -> None:
    """Connect the functions above; Sphinx calls this."""
    app.connect("source-read", read)
    app.connect("autodoc-process-signature", typed)
    app.connect("autodoc-process-docstring", as_written, priority=900)  # after napoleon
