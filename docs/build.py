"""Build the site: ``python docs/build.py [FOLDER]`` (default: build/site), with the extra ``docs`` installed.

The pages of this folder are laid out beside those that are generated — gallery, error against run time, reference — and
Sphinx makes HTML of all of them. A warning is an error, and so is what a cell raises. The folder can be published as it is.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).parent
ROOT = DOCS.parent
sys.path.insert(0, str(DOCS / "site"))

# pages from outside this folder, and what they are called in the site
OTHERS = {
    "README.md": "readme.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "SECURITY.md": "security.md",
    "benchmarks/README.md": "benchmarks.md",
    "tests/data/README.md": "test_data.md",
}
# of this folder, those with a place of their own or in no page as they are; the rest is "How it works"
PLACED = {"glossary", "peers", "errata", "cite", "scenes", "index", "more", "README", "error_against_run_time"}


def lay_out(source: Path) -> None:
    """The pages as Sphinx takes them, in the folder ``source``."""
    import gallery
    import measured
    import reference

    for path in DOCS.rglob("*"):
        inside = path.relative_to(DOCS)
        if path.is_dir() or inside.parts[0] in (
            "site",
            "build.py",
            "README.md",
            "__pycache__",
            "error_against_run_time.md",
        ):
            continue
        write(source / inside, path.read_text(encoding="utf-8") if path.suffix == ".md" else path.read_bytes(), "docs")
    for name, page in OTHERS.items():
        write(source / page, (ROOT / name).read_text(encoding="utf-8"), str(Path(name).parent))
    shutil.copy(DOCS / "site" / "conf.py", source)
    static = source / "_static"
    static.mkdir()
    for name in ("site.css", "sort.js"):
        shutil.copy(DOCS / "site" / name, static)
    shutil.copytree(ROOT / "integrable" / "schemas", static / "schemas")
    shutil.copytree(ROOT / "integrable" / "certified", static / "certified")
    results = measured.write(source, (DOCS / "error_against_run_time.md").read_text(encoding="utf-8"))
    gallery.write(source, results)
    reference.write(source)
    _how_it_works(source)


def write(path: Path, content: str | bytes, folder: str) -> None:
    """A page with its links turned to where pages are in the site; ``folder`` is where it lies in the repository."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(
            re.sub(r"(?<=\]\()([^)#\s:]*\.md)", lambda m: _moved(m[1], folder, path), content), encoding="utf-8"
        )


def _moved(link: str, folder: str, page: Path) -> str:
    target = (
        ROOT / folder / (page.parent.name if folder == "docs" and page.parent.name in _INNER else "") / link
    ).resolve()
    inside = target.relative_to(ROOT).as_posix()
    up = "../" if page.parent.name in _INNER else ""
    if inside in OTHERS:
        return up + OTHERS[inside]
    if inside == "docs/README.md":
        return f"{up}index.md"
    if inside == "docs/error_against_run_time.md":
        return f"{up}measured/index.md"
    return up + inside.removeprefix("docs/")


_INNER = ("start", "howto")


def _how_it_works(source: Path) -> None:
    """The table of contents of every page of this folder that has no place elsewhere."""
    first = ["rooms", "jacobian", "batch", "flow", "precision", "stability", "steps", "systems", "many"]
    rest = sorted({path.stem for path in DOCS.glob("*.md")} - {*first, *PLACED})
    lines = "\n".join(f"/{name}" for name in (*first, *rest))
    (source / "works").mkdir()
    (source / "works" / "index.md").write_text(
        "# How it works\n\nBegin with [rooms and arrows](../rooms.md): where things are, and two walks from a call to its "
        "formula. The other pages are one each for what somebody may want to look up: how a sum is computed, how a motion is, "
        "how many digits are right and how they are lost.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{lines}\n/contributing\n/benchmarks\n/test_data\n/security\n/readme\n```\n",
        encoding="utf-8",
    )


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
