"""Publish a report: ``python docs/publish.py [FOLDER]``, the folder of ``integrable report`` (default: runs/report).

Copies its JSON and figures here, writes their page, puts the first table of it into peers.md, and draws the picture of
the README. ``python docs/publish.py --again`` makes page and figures again from the published JSON, after a change of
words or of drawing.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from pathlib import Path
from typing import Any

from integrable import load_scene
from integrable.study.figures import as_bytes, drawings
from integrable.study.findings import Study, study_from
from integrable.study.page import page

DOCS = Path(__file__).parent
FIGURES = "figures/report"
TABLE = r"(<!-- the first table of error_against_run_time\.md[^\n]*\n)(?:\|[^\n]*\n)+"


def study_of(data: dict[str, Any]) -> Study:
    """The study whose report.json is ``data``."""
    return study_from(data, [load_scene(name) for name in data["scenes"]])


def page_of(data: dict[str, Any], docs: Path = DOCS) -> str:
    """The page of a report.json whose figures are in ``docs``."""
    study = study_of(data)
    drawn = {path.stem: f"{FIGURES}/{path.name}" for path in sorted((docs / FIGURES).glob("*.svg"))}
    study.figures.update(drawn)
    return page(study)


def publish(folder: Path | None, docs: Path = DOCS) -> None:
    """Replace what is published in ``docs`` by the report in ``folder``; if None, it is made again from its JSON."""
    published = docs / "error_against_run_time.json"
    if folder is not None:
        shutil.copyfile(folder / "report.json", published)
        shutil.rmtree(docs / FIGURES, ignore_errors=True)
        shutil.copytree(folder / FIGURES, docs / FIGURES)
    else:
        for name, drawing in drawings(study_of(json.loads(published.read_text(encoding="utf-8"))).findings).items():
            (docs / FIGURES / f"{name}.svg").write_bytes(as_bytes(drawing, "svg"))
    text = page_of(json.loads(published.read_text(encoding="utf-8")), docs)
    published.with_suffix(".md").write_text(text, encoding="utf-8")
    peers = docs / "peers.md"
    table = re.search(r"(?:^\|.*\n)+", text, flags=re.M)
    assert table is not None, "a report begins with a table"
    words, count = re.subn(TABLE, lambda found: found[1] + table[0], peers.read_text(encoding="utf-8"))
    assert count == 1, "peers.md has one place for the table"
    peers.write_text(words, encoding="utf-8")


if __name__ == "__main__":
    publish(None if sys.argv[1:] == ["--again"] else Path(sys.argv[1] if len(sys.argv) > 1 else "runs/report"))
    sys.path.insert(0, str(DOCS / "site"))
    import front

    front.main()
