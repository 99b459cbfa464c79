# SPDX-License-Identifier: MIT
"""Makes docs/thesis.md: each table and figure of chapters 3 to 6 of [ying2014] beside the same thing done here.

python -m tests.bench thesis                   all of them; writes the page and its pictures (some ten minutes)
python -m tests.bench thesis "Figure 4.6" ...  these alone; the page keeps its other rows

SADDLEBACK_MESHES names a folder of triangle meshes (PLY). Without it, or where it lacks one, meshes made in code stand
in, and the page says so: figures then show that the methods work, not how well on the thesis' kind of mesh.
"""

from __future__ import annotations

from pathlib import Path

from tests.bench._thesis import chapter_3, chapter_4, chapter_5, chapter_6, items

PAGE = Path(__file__).resolve().parents[2] / "docs/thesis.md"
CHAPTERS = {
    chapter_3: "Chapter 3: Voronoi diagrams of the plane",
    chapter_4: "Chapter 4: saddle vertex graphs",
    chapter_5: "Chapter 5: centroidal Voronoi tessellations",
    chapter_6: "Chapter 6: shapes on surfaces",
}
INTRODUCTION = """# The thesis beside Saddleback

Every table and figure of chapters 3 to 6 of [ying2014], and the same thing done with Saddleback; `python -m tests.bench
thesis` makes this page and its pictures. The meshes of [ying2014] are not the same files: models are the same or alike,
mostly coarser. Times are ratios, of processor times in one run on one machine. Errors are relative, to exact distances
(largest / root of mean squares / mean, or the mean).
"""
HEAD = "| [ying2014] | Saddleback | What differs, and why |\n|---|---|---|"


def row(item: items.Item) -> str:
    """Return the page's line of a table or figure."""
    items.used.clear()
    answer = item.run()
    pictures = "".join(f" ![{item.name}](thesis/{name})" for name in answer.pictures)
    stands = "".join(
        f" **{items.replaced[n].capitalize()} stands in for {n}.**" for n in sorted(items.used & set(items.replaced))
    )
    return f"| **{item.name}.** {item.shows} | {answer.ours}{pictures} | {answer.differs}{stands} |"


def rows_of(text: str) -> dict[str, str]:
    """Return the lines that a page has, by the names of their items."""
    return {line.split("**")[1].rstrip("."): line for line in text.splitlines() if line.startswith("| **")}


def page(rows: dict[str, str]) -> str:
    """Return the page's text, of rows by the names of their items."""
    parts = [INTRODUCTION]
    for module, title in CHAPTERS.items():
        mine = [rows[i.name] for i in items.ITEMS if i.run.__module__ == module.__name__ and i.name in rows]
        parts.append(f"## {title}\n\n{HEAD}\n" + "\n".join(mine) + "\n")
    return "\n".join(parts)


def main(arguments: list[str]) -> int:
    known = {item.name for item in items.ITEMS}
    if unknown := set(arguments) - known:
        print(f"No {', '.join(sorted(unknown))}; there are: {', '.join(item.name for item in items.ITEMS)}")
        return 2
    if not items.FOLDER:
        print("SADDLEBACK_MESHES names no folder: meshes made in code stand in, and the page says so.")
    rows = rows_of(PAGE.read_text(encoding="utf-8")) if arguments and PAGE.exists() else {}
    for item in items.ITEMS:
        if not arguments or item.name in arguments:
            rows[item.name] = row(item)
            print(rows[item.name], flush=True)
            PAGE.write_text(page(rows), encoding="utf-8")  # what was found stays, should a later one fail
    return 0
