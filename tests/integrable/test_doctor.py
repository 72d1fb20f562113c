"""The output of ``integrable doctor``, and its message where another distribution has a package of our name."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import integrable
from integrable.__main__ import main
from jacobian.owner import ForeignFiles, beside, installed, say

ROOT = Path(integrable.__file__).parent.parent


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr("integrable.doctor.LEAST", 0.01)


def test_a_healthy_installation(quick, capsys):
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    for word in ("jacobian-integrable", "numpy", "compiled code kept in", "a motion at 1000 times", "nothing is wrong"):
        assert word in said
    assert not installed()


@pytest.fixture
def shared(tmp_path):
    """A folder into which both are installed, ours after the other one."""
    for package in ("jacobian", "integrable"):
        (tmp_path / package).symlink_to(ROOT / package)
    folder = tmp_path / "jacobian-0.23.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: jacobian\nVersion: 0.23\n", encoding="utf-8")
    (folder / "RECORD").write_text("jacobian/__init__.py,,\njacobian/__main__.py,,\n", encoding="utf-8")
    return tmp_path


def obeyed(place, *words):
    return subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, timeout=120, check=False, cwd=place,
        env={**os.environ, "PYTHONPATH": str(place)},
    )  # fmt: skip


def test_an_intruder_beside_us_is_named_in_one_line(shared):
    done = obeyed(shared, "-c", "import jacobian; print(jacobian.GF(7))")
    assert (done.returncode, done.stdout) == (0, "GF(7)\n")
    warned = [line for line in done.stderr.splitlines() if "ForeignFiles" in line]
    assert len(warned) == 1
    assert "jacobian 0.23 has a package jacobian in the same folder as jacobian-integrable" in warned[0]
    assert "pip uninstall jacobian" in warned[0]


def test_an_intruder_is_what_is_wrong(quick, capsys, monkeypatch):
    monkeypatch.setattr("jacobian.owner.installed", lambda: ["jacobian 0.23 in here"])
    assert main(["doctor"]) == 1
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith("jacobian 0.23 in here "))
    assert "files of one overwrite the other's" in line


@pytest.mark.slow
def test_the_doctor_finds_an_intruder_beside_us(shared):
    """In a process that compiles, as code is kept for each place of an installation."""
    found = obeyed(shared, "-m", "integrable", "doctor")
    assert found.returncode == 1
    (line,) = (line for line in found.stdout.splitlines() if line.startswith("jacobian 0.23 in "))
    assert str(shared) in line
    assert "files of one overwrite the other's" in line


def test_a_package_that_is_not_ours_is_named_in_one_line(shared):
    (shared / "jacobian").unlink()
    (shared / "jacobian").mkdir()
    (shared / "jacobian" / "__init__.py").write_text("def jacobian(f): ...\n", encoding="utf-8")
    done = obeyed(shared, "-c", "import integrable")
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("ImportError: ")
    assert "is of another distribution than jacobian-integrable" in last
    assert str(shared / "jacobian" / "__init__.py") in last


def test_what_lies_beside(tmp_path, recwarn):
    for name in ("jacobian-0.23.dist-info", "jacobian_integrable-0.2.0.dist-info", "jacobians-1.dist-info", "jacobian"):
        (tmp_path / name).mkdir()
    assert list(beside(str(tmp_path))) == ["jacobian 0.23"]
    assert list(beside(str(tmp_path / "nowhere"))) == []
    say()
    assert not [warning for warning in recwarn if warning.category is ForeignFiles]
