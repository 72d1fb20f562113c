"""Facts that a release states in several places agree."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
VERSION = PROJECT["project"]["version"]


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_one_version_and_one_date():
    version, date = re.search(r"^## \[(\d[^\]]*)\] - (\S+)$", text("CHANGELOG.md"), re.M).groups()
    assert version == VERSION
    assert f"\nversion: {VERSION}\n" in text("CITATION.cff")
    assert f"\ndate-released: {date}\n" in text("CITATION.cff")
    assert f'\n  version: "{VERSION}"\n' in text("conda/recipe.yaml")
    assert "### Upgrading from" in text("CHANGELOG.md")


def test_the_paper_is_cited_with_its_doi():
    assert "doi: 10.1134/S1560354717040025" in text("CITATION.cff")


def test_every_python_that_is_named_is_tested():
    named = re.findall(r"Python :: (3\.\d+)", "\n".join(PROJECT["project"]["classifiers"]))
    matrix = re.search(r"python: \[(.*)\]", text(".github/workflows/release.yml"))[1]
    assert re.findall(r"3\.\d+", matrix) == named
    assert PROJECT["project"]["requires-python"] == f">={named[0]}"


def test_conda_runs_on_what_the_wheel_needs():
    recipe = re.search(r"  run:\n(.*?)\n\n", text("conda/recipe.yaml"), re.S)[1]
    needs = {line.strip("- ").replace(" ", "") for line in recipe.splitlines()}
    assert needs == {*PROJECT["project"]["dependencies"], f"python{PROJECT['project']['requires-python']}"}


def test_the_sdist_has_what_it_takes_to_work_on_it():
    include = PROJECT["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    for name in include:
        assert (ROOT / name.strip("/")).exists(), name
    assert {"/CONTRIBUTING.md", "/CITATION.cff", "/SECURITY.md", "/tests", "/docs"} <= set(include)
