"""Build the site: ``python docs/build.py [FOLDER]`` (default: build/site), with the extra ``docs`` installed.

The pages of this folder are combined with generated ones: gallery, error against run time, reference. Sphinx makes HTML
of all of them. A warning is an error, and so is an exception in a cell. The folder can be published as it is.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).parent
ROOT = DOCS.parent
sys.path.insert(0, str(DOCS / "site"))

# pages from outside this folder, with their names in the site
OTHERS = {
    "README.md": "readme.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "SECURITY.md": "security.md",
    "CODE_OF_CONDUCT.md": "code_of_conduct.md",
    "benchmarks/README.md": "benchmarks.md",
    "tests/data/README.md": "test_data.md",
}
# files of this folder that are not pages, or not pages in this form
LEFT_OUT = {
    "site",
    "build.py",
    "publish.py",
    "README.md",
    "__pycache__",
    "error_against_run_time.md",
    "error_against_run_time.json",
}
# pages with a place of their own, and those that are generated; the rest is "How it works"
PLACED = {"glossary", "peers", "errata", "cite", "scenes", "index", "more", "README", "error_against_run_time"}


def lay_out(source: Path) -> None:
    """Writes the pages in the form that Sphinx reads into the folder ``source``."""
    import gallery
    import measured
    import reference
    import rolling

    pages = {path: path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*") if path.is_file()}
    for path, page in pages.items():
        if Path(page).parts[0] not in LEFT_OUT:
            write(source, page, path)
    for name, page in OTHERS.items():
        write(source, page, ROOT / name)
    for name in ("conf.py", "mathml.py", "scorer.js"):
        shutil.copy(DOCS / "site" / name, source)
    static = source / "_static"
    static.mkdir()
    for name in ("site.css", "sort.js"):
        shutil.copy(DOCS / "site" / name, static)
    shutil.copytree(ROOT / "integrable" / "schemas", static / "schemas")
    shutil.copytree(ROOT / "integrable" / "certified", static / "certified")
    results = measured.write(source, json.loads((DOCS / "error_against_run_time.json").read_text(encoding="utf-8")))
    gallery.write(source, results)
    reference.write(source)
    (source / "rolling.html").write_text(rolling.html(), encoding="utf-8")
    _how_it_works(source)


def write(source: Path, page: str, origin: Path) -> None:
    """The file ``origin`` as ``page`` of the site, with its links changed to the site's."""
    target = source / page
    target.parent.mkdir(parents=True, exist_ok=True)
    if origin.suffix != ".md":
        shutil.copy(origin, target)
        return
    text = origin.read_text(encoding="utf-8")
    target.write_text(
        re.sub(r"(?<=\]\()([^)#\s:]*\.(?:md|png|toml))", lambda found: _moved(found[1], origin, page), text),
        encoding="utf-8",
    )


def _moved(link: str, origin: Path, page: str) -> str:
    """A link of the file ``origin`` as one from ``page``, its place in the site."""
    inside = (origin.parent / link).resolve().relative_to(ROOT).as_posix()
    if inside.startswith("integrable/scenes/"):
        # the site shows a scene's page in the gallery in place of its file
        inside = f"gallery/{Path(inside).stem}.md"
    places = {**OTHERS, "docs/README.md": "index.md", "docs/error_against_run_time.md": "measured/index.md"}
    return os.path.relpath(places.get(inside, inside.removeprefix("docs/")), os.path.dirname(page) or ".")


def _how_it_works(source: Path) -> None:
    """The table of contents of every page of this folder that has no place elsewhere."""
    first = ["jacobian", "batch", "flow", "precision", "stability", "steps", "systems", "many"]
    rest = sorted({path.stem for path in DOCS.glob("*.md")} - {"rooms", *first, *PLACED})
    lines = "\n".join(f"/{name}" for name in (*first, *rest))
    (source / "works").mkdir()
    (source / "works" / "index.md").write_text(
        "# How it works\n\nBegin with [rooms and imports](../rooms.md): where things are, two walks from a call to its formula, and "
        "a page for every room. Each other page answers one question: how a sum or a motion is computed, how many digits are "
        "right, and where digits are lost.\n\n```{toctree}\n:maxdepth: 2\n\n/rooms\n```\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{lines}\n/contributing\n/benchmarks\n/test_data\n/security\n/code_of_conduct\n/readme\n```\n",
        encoding="utf-8",
    )
    with (source / "rooms.md").open("a", encoding="utf-8") as rooms:
        names = "\n".join(
            sorted(path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.glob("rooms/*/*.md"))
        )
        rooms.write(f"\n```{{toctree}}\n:hidden:\n\n{names}\n```\n")


def main() -> int:
    parser = argparse.ArgumentParser(description="Build the site.")
    parser.add_argument(
        "folder", nargs="?", default=str(ROOT / "build" / "site"), help="where to (default: build/site)"
    )
    out = Path(parser.parse_args().folder).resolve()
    with tempfile.TemporaryDirectory() as work:
        source = Path(work) / "pages"
        source.mkdir()
        lay_out(source)
        command = [
            sys.executable,
            "-m",
            "sphinx",
            "-W",
            "--keep-going",
            "-q",
            "-b",
            "html",
            "-d",
            f"{work}/trees",
            str(source),
            str(out),
        ]
        status = subprocess.run(command, check=False).returncode
    if status == 0:
        size = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
        print(f"{len(list(out.rglob('*.html')))} pages, {size / 1e6:.0f} MB: open {out / 'index.html'}")
    return status


if __name__ == "__main__":
    sys.exit(main())
