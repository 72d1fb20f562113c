"""Publish a report: ``python docs/publish.py [FOLDER]``, the folder of ``integrable report`` (default: runs/report).

Copies its page, JSON and figures here, writes its first table into peers.md, and draws the picture of the README.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

DOCS = Path(__file__).parent
TABLE = r"(<!-- the first table of error_against_run_time\.md[^\n]*\n)(?:\|[^\n]*\n)+"


def publish(folder: Path, docs: Path = DOCS) -> None:
    """Replace what is published in ``docs`` by the report in ``folder``."""
    page = (folder / "report.md").read_text(encoding="utf-8")
    (docs / "error_against_run_time.md").write_text(page, encoding="utf-8")
    shutil.copyfile(folder / "report.json", docs / "error_against_run_time.json")
    figures = docs / "figures" / "report"
    shutil.rmtree(figures, ignore_errors=True)
    shutil.copytree(folder / "figures" / "report", figures)
    peers = docs / "peers.md"
    table = re.search(r"(?:^\|.*\n)+", page, flags=re.M)
    assert table is not None, "a report begins with a table"
    text, count = re.subn(TABLE, lambda found: found[1] + table[0], peers.read_text(encoding="utf-8"))
    assert count == 1, "peers.md has one place for the table"
    peers.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    publish(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/report"))
    sys.path.insert(0, str(DOCS / "site"))
    import front

    front.main()
