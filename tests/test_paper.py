"""The paper has the form that the journal requires, and a release waits for the parts that only the owner can write."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAPER = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")
BODY = PAPER.split("---\n", 2)[2]
REFERENCES = (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8")
ENTRIES = {entry.split("{")[1].split(",")[0]: entry for entry in re.split(r"^@", REFERENCES, flags=re.M)[1:]}


def test_length_and_sections():
    assert 750 <= len(BODY.split()) <= 1750
    assert re.findall(r"^# (.*)$", BODY, re.M) == [
        "Summary",
        "Statement of need",
        "State of the field",
        "Software design",
        "Research impact",
        "Acknowledgements and disclosures",
        "References",
    ]


def test_references_are_cited_and_can_be_looked_up():
    cited = set(re.findall(r"@([A-Za-z]\w+)", BODY))
    assert cited == set(ENTRIES)
    for key, fields in ENTRIES.items():
        assert re.search(r"doi = \{10\.\d+/\S+\}|url = \{https://\S+\}", fields), key


def test_a_release_is_not_made_with_a_blank():
    blanks = runpy.run_path(str(ROOT / "paper" / "owner.py"))["blanks"]
    text = (ROOT / "paper" / "owner.toml").read_text(encoding="utf-8")
    assert set(blanks(text)) <= set(blanks(re.sub(r"= .*", '= ""', text)))
    assert blanks('[paper]\nauthors = []\n[project]\ncontact = "x"') == ["paper.authors"]
    steps = (ROOT / ".github" / "workflows" / "release.yml").read_text(encoding="utf-8")
    publish = steps[steps.index("  publish:") :]
    assert publish.index("python paper/owner.py") < publish.index("gh-action-pypi-publish")
