"""The commands on limited terminals, without optional libraries, and on systems that are not POSIX."""

import io
import json
import os
import re
import subprocess
import sys
import time
from dataclasses import replace
from fractions import Fraction

import pytest

from integrable.__main__ import main
from integrable.extras import MissingExtraWarning
from integrable.oracles.methods import METHODS
from integrable.oracles.reference import dop853
from integrable.scene.file import load_scene
from integrable.scene.output import portable
from integrable.scene.progress import bar_of_pieces
from integrable.study import run
from integrable.study.motions import measure, pieces_of_work
from integrable.study.plan import tasks_of
from jacobian import compilation
from jacobian.__main__ import main as jacobian_main
from jacobian.errors import ArgumentError
from tests.integrable.scene_texts import BALL, EXACT, REPORT

SCENE = BALL.replace("A short run", "Bäcklund γ") + REPORT.replace("[15]", "[20]")
ORBIT = f'title = "Bäcklund γ, ∞ ≤ µ"\n{EXACT}'


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.toml").write_text(SCENE, encoding="utf-8")
    (tmp_path / "orbit.toml").write_text(ORBIT, encoding="utf-8")
    return tmp_path


def integrable(*arguments, before="", **environment):
    """The command in a separate process, after a line of Python: exit code, stdout and stderr as bytes."""
    code = f"{before}\nimport sys\nfrom integrable.__main__ import main\nsys.exit(main({list(arguments)!r}))"
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("LC_", "LANG", "PYTHONIOENCODING", "PYTHONUTF8"))}
    # the process starts in another folder but must import the same sources
    found = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        timeout=100,
        check=False,
        env={**clean, **found, **environment},
    )
    return done.returncode, done.stdout, done.stderr


# --- terminals

TERMINALS = {
    "ascii": {"PYTHONIOENCODING": "ascii"},
    "cp1252": {"PYTHONIOENCODING": "cp1252"},
    "utf-8": {"PYTHONIOENCODING": "utf-8"},
    "ascii, from the locale": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
}


@pytest.mark.parametrize("terminal", TERMINALS)
def test_every_terminal_gets_what_it_can_show(here, terminal):
    encoding = terminal.split(",")[0]
    code, out, err = integrable("run", "orbit.toml", "--progress", **TERMINALS[terminal])
    assert code == 0, err
    shown = out.decode(encoding)
    assert "exact" in shown
    assert "Traceback" not in err.decode(encoding)
    title = {"ascii": "Backlund g, inf <= u", "cp1252": "Bäcklund g, inf <= µ", "utf-8": "Bäcklund γ, ∞ ≤ µ"}[encoding]
    assert shown.splitlines()[0] == title
    # columns remain aligned
    head, row = (next(line for line in shown.splitlines() if line.startswith(word)) for word in ("setting", "exact"))
    assert len(head) == len(row)
    # files are UTF-8 whatever the terminal's encoding
    folder = here / "runs" / "orbit"
    assert (folder / "report.txt").read_text(encoding="utf-8").startswith("Bäcklund γ, ∞ ≤ µ\n")
    assert json.loads((folder / "result.json").read_text(encoding="utf-8"))["scene"]["title"] == "Bäcklund γ, ∞ ≤ µ"


@pytest.mark.parametrize(
    "arguments", [["scenes"], ["run", "--help"], ["report", "--help"], ["run", "γ∞.toml"], ["run", "ball.toml", "--γ"]]
)
def test_lists_help_and_errors_on_a_terminal_of_ascii(here, arguments):
    code, out, err = integrable(*arguments, PYTHONIOENCODING="ascii")
    assert code == (2 if arguments[-1] in ("γ∞.toml", "--γ") else 0)
    assert (out + err).isascii()
    assert b"Traceback" not in err
    if code:
        assert err.count(b"\n") == 1


def test_the_names_of_kernels_on_a_terminal_of_ascii(monkeypatch):
    out = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(compilation, "compile_all", lambda: iter([("GF(2^k), k ≤ 16", 0.5)]))
    assert jacobian_main(["compile"]) == 0
    out.flush()
    assert out.buffer.getvalue().decode().endswith("GF(2^k), k <= 16\n")


def test_errors_that_somebody_chose_stay(monkeypatch):
    out = io.TextIOWrapper(io.BytesIO(), encoding="ascii", errors="xmlcharrefreplace")
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(compilation, "compile_all", lambda: iter([("k ≤ 16", 0.5)]))
    assert jacobian_main(["compile"]) == 0
    out.flush()
    assert b"k &#8804; 16" in out.buffer.getvalue()


def test_a_reader_that_goes_away_is_no_error(here):
    code = "from integrable.__main__ import main; import sys; sys.exit(main(['scenes']))"
    read, write = os.pipe()
    os.close(read)
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", code], stdout=write, stderr=subprocess.PIPE, timeout=60, check=False, env=env
    )
    os.close(write)
    assert done.stderr == b""
    assert done.returncode == 141


# --- libraries that are not installed


SAID = pytest.mark.filterwarnings("always::integrable.extras.MissingExtraWarning")


@SAID
def test_what_is_not_installed_is_said_before_anything_is_computed(here, monkeypatch, capsys):
    for module in ("scipy", "matplotlib", "tqdm"):
        monkeypatch.setitem(sys.modules, module, None)
    compute, said = run._compute, []

    def computed(*arguments):
        said.append(capsys.readouterr().err)
        return compute(*arguments)

    monkeypatch.setattr(run, "_compute", computed)
    assert main(["run", "ball.toml", "--progress"]) == 0
    (line,) = said[0].splitlines()
    assert line.startswith(
        "integrable: warning: not installed, so left out: the rows of SciPy's DOP853 (scipy), the pict"
    )
    assert "the progress bar (tqdm)" in line
    assert line.endswith("pip install 'jacobian-integrable[app]'")
    captured = capsys.readouterr()
    assert captured.err == ""
    assert "SciPy DOP853, tol 1e-6: not run: SciPy is not installed" in captured.out
    assert sorted(path.name for path in (here / "runs" / "ball").iterdir()) == ["report.txt", "result.json"]


@SAID
def test_only_what_a_run_would_use_is_named(here, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.setattr(run, "_compute", lambda *_: (_ for _ in ()).throw(ArgumentError("stop")))
    assert main(["run", "ball.toml", "--no-plots"]) == 2
    assert "matplotlib" not in capsys.readouterr().err
    assert main(["run", "ball.toml", "--quiet"]) == 2
    assert capsys.readouterr().err == "integrable: error: stop\n"
    with (
        pytest.warns(
            MissingExtraWarning, match=r"^not installed, so left out: the rows of SciPy's DOP853 \(scipy\); pip"
        ),
        pytest.raises(ArgumentError, match="stop"),
    ):
        run.run("ball.toml")


def test_an_integrator_that_is_not_installed_says_what_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    ball, state = load_scene("chaplygin").start(15)
    with pytest.raises(ArgumentError, match=r"needs scipy.*pip install 'jacobian-integrable\[app\]'"):
        METHODS["SciPy DOP853"].solve(ball, state, [1.0], 1e-6)
    with pytest.raises(ArgumentError, match=r"needs scipy.*pip install 'jacobian-integrable\[app\]'"):
        dop853(ball, state, [1.0], rtol=1e-6, atol=1e-6)


@SAID
def test_a_study_without_the_extras(here, monkeypatch, capsys):
    for module in ("scipy", "matplotlib", "tqdm"):
        monkeypatch.setitem(sys.modules, module, None)
    assert main(["report", "orbit.toml", "--quick", "--jobs", "1"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(
        "integrable: warning: not installed, so left out: SciPy's integrators (scipy), the figures (mat"
    )
    assert (here / "runs" / "report-quick" / "report.md").is_file()
    rows = tasks_of(load_scene("ball.toml"), "ball.toml", "quick")
    assert {"SciPy", "left out"}.isdisjoint({word for row in rows for word in (row.kind, row.method.split()[0])})


# --- systems that are not POSIX

WINDOWS = """
import os, sys
for name in ("fcntl", "resource", "grp", "pwd", "termios"):
    sys.modules[name] = None
for name in ("killpg", "setpgid", "getpgid", "sched_getaffinity", "fork"):
    delattr(os, name)
"""


def test_a_study_without_what_only_posix_has(here, monkeypatch):
    """Worker processes lack the POSIX modules too, since sitecustomize runs in every Python that starts.

    On such a system filelock uses another system call; here, where that call does not exist, it uses the existence of a
    file.
    """
    (here / "site").mkdir()
    soft = "import filelock; filelock.FileLock = filelock.SoftFileLock\n"
    (here / "site" / "sitecustomize.py").write_text(WINDOWS + soft, encoding="utf-8")
    path = os.pathsep.join(filter(None, [str(here / "site"), *sys.path]))
    code, out, err = integrable("report", "orbit.toml", "--quick", "--jobs", "1", "--no-plots", PYTHONPATH=path)
    assert code == 0, err
    assert b"files written to" in out
    assert (here / "runs" / "report-quick" / "report.md").is_file()


@pytest.mark.parametrize(
    ("name", "folder"),
    [
        ("ball", "ball"),
        ("My ball, γ = 0", "My ball, γ = 0"),
        ("con", "_con"),
        ("AUX.old", "_AUX.old"),
        ("lpt1", "_lpt1"),
        ("console", "console"),
        ("a:b*c?", "a_b_c_"),
        ("a/b\\c", "a_b_c"),
        ("ball. .", "ball"),
        ("..", "_"),
        ("tab\tnew\nline", "tab_new_line"),
    ],
)
def test_names_are_names_of_folders_everywhere(name, folder):
    assert portable(name) == folder


def test_a_scene_of_a_name_that_windows_forbids(here):
    (here / "aux.toml").write_text(ORBIT, encoding="utf-8")
    assert main(["run", "aux.toml", "--quiet"]) == 0
    assert (here / "runs" / "_aux" / "result.json").is_file()


def test_rows_of_scenes_whose_names_differ_in_few_letters_are_kept_apart(here):
    """With equal keys, two scenes would show the same result."""
    base = load_scene("chaplygin")
    names = ("ä", "ö", "Ball", "ball", "ba ll", "ba_ll", "con", "con.x")
    keys = [row.key for name in names for row in tasks_of(replace(base, name=name), name, "quick")]
    assert len({key.lower() for key in keys}) == len(keys)
    assert all(re.fullmatch(r"[a-z0-9_.-]+", key) and portable(key) == key for key in keys)


def test_a_name_that_is_no_text_is_written_as_text(here):
    """A file's name in another encoding reaches Python as surrogates, which text files cannot contain."""
    name = os.fsdecode(b"b\xe4ll.toml")
    (here / name).write_text(ORBIT.replace('title = "Bäcklund γ, ∞ ≤ µ"', ""), encoding="utf-8")
    code, out, err = integrable("run", name, PYTHONIOENCODING="utf-8")
    assert (code, err) == (0, b"")
    assert out.decode().startswith("b_ll\n")
    (folder,) = (here / "runs").iterdir()
    assert (folder / "report.txt").read_text(encoding="utf-8").startswith("b_ll\n")


# --- the progress bar


def test_the_bar_moves_within_a_piece_of_work(capsys):
    drawn, until = "", time.monotonic() + 60
    with bar_of_pieces("ball", 2) as tick:
        tick("compiling")
        while len(set(re.findall(r"compiling[^\r]*\[([0-9:]+)\]", drawn))) < 2:
            assert time.monotonic() < until
            time.sleep(0.05)
            drawn += capsys.readouterr().err
        tick("running")
    assert "2/2" in "".join(capsys.readouterr().err.split("\r")[-3:])


def test_each_run_of_a_method_is_a_piece_of_its_own(here):
    asked = load_scene("orbit.toml")
    labels = []
    found = run._compute(replace(asked, steps=replace(asked.steps, repeat=3)), 15, labels.append)
    assert found.report.rows[0].runs == 3
    assert len(labels) == 3


def test_the_truth_of_many_times_is_many_pieces(here):
    """With mpmath alone the truth takes half a minute, during which the bar should move."""
    given = load_scene("ball.toml")
    many = replace(given, times=replace(given.times, given=tuple(range(50))))
    labels = []
    report, _ = measure(many, 20, labels.append)
    # from the scene's own numbers, and from doubles, which DOP853 receives
    assert labels.count("truth, 30 digits") == 6
    assert len(labels) == pieces_of_work(many, 20)
    assert report.rows[0].error_gamma < 1e-18


def test_a_reason_is_given_once(here, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    given = load_scene("ball.toml")
    two = replace(given, report=replace(given.report, tolerances=(Fraction("1e-4"), Fraction("1e-6"))))
    lines = measure(two, 20, lambda _label: None)[0].table().splitlines()
    assert lines.count("SciPy DOP853, tol 1e-4, tol 1e-6: not run: SciPy is not installed") == 1


@SAID
def test_a_race_without_a_progress_bar(here, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "tqdm", None)
    assert main(["race", "--problem", "t_handle", "--rival", "implicit midpoint", "--limit", "0.01", "--progress"]) == 0
    captured = capsys.readouterr()
    assert captured.err.startswith("integrable: warning: not installed, so left out: the progress bar (tqdm); pip")
    assert "divisor flow" in captured.out
