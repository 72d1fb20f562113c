"""The remains of a sweep whose files cannot be written, or whose folder is damaged."""

import json
import subprocess
import sys

import numpy as np
import pytest

from integrable import EulerTop, ensemble, sweep
from integrable.files import whole
from integrable.sweeps.sweep import SweepStopped
from jacobian import ArgumentError
from tests.integrable.sweeps.test_sweep import SUFFIXES, Dead, needs_hdf5, read

GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
MEMBERS, CHUNK, TIMES = 120, 20, np.linspace(0, 1, 10)
MANY = ensemble(EulerTop((1, 2, 3)), GAMMA, np.tile(M, (MEMBERS, 1)) * np.linspace(1, 2, MEMBERS)[:, None])


def swept(out, executor="threads"):
    return sweep(MANY, times=TIMES, out=out, executor=executor, chunk=CHUNK)


LIMITED = """
import os, resource, sys
from jacobian import JacobianError
from tests.integrable.sweeps.test_store import MANY, TIMES, swept
MANY.at(TIMES)  # what is compiled is kept before
# a limit would cut short what Python keeps of imported modules as well, for every process after this one
sys.dont_write_bytecode = True
soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
for limit in map(int, sys.argv[2:]):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
    try:
        swept(sys.argv[1])
    except JacobianError as error:
        print(type(error).__name__, error)
    print(os.path.exists(sys.argv[1] + ".part"))
resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
swept(sys.argv[1])
"""


@pytest.mark.parametrize(
    ("suffix", "limits", "kept"), [(".h5", (0, 200, 3000, 20000, 50000, 80000), 3), (".zarr", (0, 200, 400), 0)]
)
def test_a_limit_of_the_size_of_files_is_one_error(suffix, limits, kept, tmp_path):
    """With ``ulimit -f``, HDF5's library raised a RuntimeError "Can't decrement id ref count" and ended with a
    segmentation fault. Chunks are kept; a folder with nothing to resume from is removed.
    """
    pytest.importorskip("resource")
    pytest.importorskip("h5py" if suffix == ".h5" else "zarr")
    out = tmp_path / f"out{suffix}"
    words = [sys.executable, "-c", LIMITED, str(out), *map(str, limits)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    said = (
        f"ArgumentError out = {str(out)!r} cannot be written: File too large: the file would be larger than the limit"
    )
    assert all(line.startswith(said) for line in lines[::2])
    assert lines[1::2] == ["False"] * (len(limits) - kept) + ["True"] * kept
    np.testing.assert_array_equal(read(out)[0]["gamma"], MANY.at(TIMES).gamma)
    assert [item.name for item in tmp_path.iterdir()] == [out.name]


def test_a_folder_that_a_late_write_makes_again_is_removed(tmp_path, monkeypatch):
    """One failed sweep in twenty left its folder: zarr's threads still wrote after the first error."""
    late = tmp_path / ".out.part"

    def written(seconds):
        if seconds < max(whole.PAUSES):
            (late / "states").mkdir(parents=True, exist_ok=True)

    monkeypatch.setattr(whole.time, "sleep", written)
    whole.discarded(late)
    assert not late.exists()


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_nothing_is_left_of_a_sweep_that_had_no_chunk(suffix, tmp_path):
    with pytest.raises(SweepStopped, match="no chunk was done, and nothing is kept"):
        swept(tmp_path / f"out{suffix}", Dead(0))
    assert not list(tmp_path.iterdir())


def cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


JOURNALS = {
    "empty": "",
    "cut": '{"stamp": "',
    "no object": "[1, 2]",
    "without a stamp": '{"done": [0], "reasons": [""], "refused": 0}',
    "of numbers": '{"stamp": 1, "done": 3, "reasons": 4}',
}


@pytest.mark.parametrize("what", JOURNALS)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_damaged_journal_is_named(suffix, what, tmp_path):
    out = tmp_path / f"out{suffix}"
    with pytest.raises(SweepStopped):
        swept(out, Dead(3))
    (tmp_path / f"out{suffix}.part" / "journal.json").write_text(JOURNALS[what], encoding="utf-8")
    with pytest.raises(ArgumentError, match=r"\.part' has a journal that is damaged; give another name, or remove it"):
        swept(out)
    # existing files are left for the user to remove
    assert (tmp_path / f"out{suffix}.part").exists()


def damaged(suffix):
    """{name of a damage: the function that does it to the folder of chunks 0, 1 and 2}"""
    if suffix == ".h5":
        return {
            "cut": lambda folder: cut(folder / "00000001.npz"),
            "gone": lambda folder: (folder / "00000001.npz").unlink(),
            "empty": lambda folder: (folder / "00000001.npz").write_bytes(b""),
            "another": lambda folder: np.savez(folder / "00000001.npz", gamma=np.zeros(3)),
            "no longer": lambda folder: (folder / "00000001.npz").write_text("x"),
        }
    return {
        "cut": lambda folder: cut(folder / "states.zarr/M/c/1/0/0"),
        "gone": lambda folder: (folder / "states.zarr/gamma/c/1/0/0").unlink(),
        "zeros gone": lambda folder: (folder / "states.zarr/status/c/1/0").unlink(),
        "empty": lambda folder: (folder / "states.zarr/way/c/1").write_bytes(b""),
    }


DAMAGED = [pytest.param(*x.values, name, marks=x.marks) for x in SUFFIXES for name in damaged(x.values[0])]


@pytest.mark.parametrize(("suffix", "what"), DAMAGED)
def test_a_damaged_chunk_is_computed_again(suffix, what, tmp_path):
    """A missing zarr chunk would be read as zeros."""
    out = tmp_path / f"out{suffix}"
    with pytest.raises(SweepStopped, match="3 of 6 chunks are kept"):
        swept(out, Dead(3))
    damaged(suffix)[what](tmp_path / f"out{suffix}.part")
    found = swept(out, Dead(4))
    assert found.refused == 0
    np.testing.assert_array_equal(read(out)[0]["gamma"], MANY.at(TIMES).gamma)
    np.testing.assert_array_equal(read(out)[0]["M"], MANY.at(TIMES).M)
    assert (read(out)[0]["way"] > 0).all()


@needs_hdf5
def test_refused_members_are_counted_once(tmp_path):
    """Both in chunks that are resumed and in a chunk that is computed again."""
    many = ensemble(EulerTop((1, 2, 3)), GAMMA, np.array([M, (0, 0, 0)] * 4))
    out = tmp_path / "out.h5"
    with pytest.raises(SweepStopped, match="3 of 4 chunks are kept"):
        sweep(many, times=[0, 1], out=out, executor=Dead(3), chunk=2)
    cut(tmp_path / "out.h5.part/00000001.npz")
    assert sweep(many, times=[0, 1], out=out, executor="threads", chunk=2).refused == 4


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_folder_of_somebody_else_is_left_alone(suffix, tmp_path):
    folder = tmp_path / f"out{suffix}.part"
    folder.mkdir()
    (folder / "thesis.tex").write_text("x", encoding="utf-8")
    with pytest.raises(ArgumentError, match=r"\.part' has no journal, but 'thesis.tex'; give another name, or remove"):
        swept(tmp_path / f"out{suffix}")
    assert (folder / "thesis.tex").read_text(encoding="utf-8") == "x"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_sweep_killed_before_its_first_note_begins_anew(suffix, tmp_path):
    out = tmp_path / f"out{suffix}"
    folder = tmp_path / f"out{suffix}.part"
    (folder / "states.zarr").mkdir(parents=True)
    (folder / "lock").touch()
    (folder / ".journal.0123abcd.json").write_text(json.dumps({}), encoding="utf-8")
    swept(out)
    np.testing.assert_array_equal(read(out)[0]["gamma"], MANY.at(TIMES).gamma)
    assert not folder.exists()
