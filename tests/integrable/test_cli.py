"""The command: its output, its files, and one line for every error."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import integrable
from integrable.__main__ import main
from integrable.scene.file import load_scene, scene_names
from tests.integrable.scene_texts import BALL, EXACT, REPORT


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.toml").write_text(BALL, encoding="utf-8")
    return tmp_path


def names(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_scenes_are_listed(capsys):
    assert main(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["name", "system", "title"]
    assert any(line.startswith("chaplygin ") and "chaplygin_ball" in line for line in lines)
    assert any(line.startswith("euler_top ") for line in lines)


def test_run_writes_to_runs_and_the_name_of_the_scene(here, capsys):
    assert main(["run", "ball.toml"]) == 0
    assert names(here) == ["ball.toml", "runs", "runs/ball", "runs/ball/result.json"]
    captured = capsys.readouterr()
    assert "A short run: 3 times computed" in captured.out
    assert captured.err == ""


def test_quiet_is_quiet_and_plots_can_be_left_out(here, capsys):
    (here / "ball.toml").write_text(BALL + REPORT, encoding="utf-8")
    assert main(["run", "ball.toml", "--quiet", "--no-plots", "--out", "there"]) == 0
    assert names(here / "there") == ["report.txt", "result.json"]
    assert capsys.readouterr() == ("", "")


def test_a_run_with_everything(here, capsys):
    (here / "ball.toml").write_text(BALL + REPORT, encoding="utf-8")
    assert main(["run", "ball.toml", "--format", "both", "--digits", "20", "--progress"]) == 0
    assert names(here / "runs" / "ball") == [
        "report.txt",
        "result.json",
        "sphere.png",
        "sphere.svg",
        "work_precision.png",
        "work_precision.svg",
    ]
    captured = capsys.readouterr()
    assert "20 digits" in captured.out
    assert "SciPy DOP853" in captured.out
    assert "ball: " in captured.err  # the progress bar
    assert "8/8" in captured.err  # including the truth for doubles
    assert main(["run", "ball.toml", "--force"]) == 0  # again, over the same files
    assert "ball: " not in capsys.readouterr().err  # no terminal, no bar


WRONG = {
    "a TOML typo": ("inertia = [", "inertia = ((", [], ["ball.toml", "line 5", "not a TOML file"]),
    "an unknown key": ("inertia", "inertai", [], ["[body] inertai: unknown key", 'did you mean "inertia"']),
    "NaN": ('"0.7"', "nan", [], ["[body] d: NaN given", "a finite number"]),
    "gamma not of length one": ('"0.64"', '"0.65"', [], ["[start] gamma", "1"]),
    "gamma and M not orthogonal": ('"-1.488"', '"-1.48"', [], ["[start]", "M"]),
    "inertia zero": ('"2"', '"0"', [], ["[body] inertia", "0", "positive"]),
    "inertia negative": ('"2"', '"-2"', [], ["[body] inertia", "-2", "positive"]),
    "d negative, d·a ≥ 1 or worse": ('"0.7"', '"-1.5"', [], ["[body] d", "-1.5"]),
    "a folder below a file": ("", "", ["--out", "ball.toml/x"], ['out: "ball.toml/x" cannot be written', "a folder"]),
    "a file for a folder": ("", "", ["--out", "ball.toml"], ['out: "ball.toml" cannot be written']),
    "an empty name of a folder": ("", "", ["--out", ""], ['--out: "" given']),
    "brackets in brackets": ('"0.7"', "[" * 3000, [], ["ball.toml", "too deep"]),
    "an integer without end": ('"0.7"', "9" * 5000, [], ["ball.toml", "too long"]),
    "an exponent without end": ('"0.7"', "1e99999999999999999999", [], ["ball.toml", "too long"]),
    "a long integer for a number": ('"0.7"', f"0x{'f' * 5000}", [], ["[body] d: an int of 20000 bits"]),
    "a long integer for a count": ("truth_digits = 30", f"truth_digits = 0x{'f' * 5000}", [], ["300 digits"]),
    "a long word": ("chaplygin_ball", "x" * 6000, [], ["system", "6002 characters", "chaplygin_ball"]),
    "a long word on the line": ("", "", ["--digits", "9" * 5000], ["--digits"]),
    "no digits": ("", "", ["--digits", "0"], ["digits = 0", "a positive number"]),
    "digits that are none": ("", "", ["--digits", "many"], ["--digits", "'many'", "int"]),
    "a format that is none": ("", "", ["--format", "gif"], ["--format", "'gif'", "png"]),
    "an unknown option": ("", "", ["--colour"], ["--colour"]),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_gets_one_line_and_exit_code_2(here, capsys, what):
    old, new, options, said = WRONG[what]
    (here / "ball.toml").write_text((BALL + REPORT).replace(old, new, 1), encoding="utf-8")
    try:
        code = main(["run", "ball.toml", *options])
    except SystemExit as stop:  # argparse ends with SystemExit
        code = stop.code
    captured = capsys.readouterr()
    assert code == 2
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert len(captured.err) < 1200
    assert captured.err.startswith("integrable: error: ")
    for word in said:
        assert word in captured.err
    assert names(here) == ["ball.toml"]


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    "arguments",
    [
        *(["run", "chaplygn"], ["run", "nowhere/ball.toml"], ["run"], ["view"], ["walk"], ["scenes", "two\nlines"]),
        *(["run", "x" * 300], ["view", "ball.toml/x"], ["sweep", "ball.toml", "--vary", "d=1e-299:1e299:5:log"]),
        ["sweep", "ball.toml", "--vary", "d=" + "9" * 5000],
    ],
)
def test_a_wrong_command_line_gets_one_line_and_exit_code_2(here, arguments):
    done = subprocess.run(
        [sys.executable, "-m", "integrable", *arguments], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("integrable: error: ")
    assert done.stderr.count("\n") == 1
    assert len(done.stderr) < 1200
    assert names(here) == ["ball.toml"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_an_output_that_cannot_be_written_gets_one_line(here):
    command = [sys.executable, "-m", "integrable", "scenes"]
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert done.stderr == "integrable: error: the output cannot be written: No space left on device: the disk is full\n"


def test_a_folder_of_too_long_a_name_gets_one_line(here, capsys):
    """The check for an existing result used to raise an OSError."""
    assert main(["run", "ball.toml", "--quiet", "--out", 300 * "x"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.skipif(os.name != "posix", reason="a shell closes the output")
def test_a_closed_output_is_none(here):
    line = [sys.executable, "-m", "integrable", "scenes"]
    done = subprocess.run(["sh", "-c", '"$@" >&-', "sh", *line], stderr=subprocess.PIPE, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


def test_the_folder_is_tried_before_anything_is_computed(here, capsys, monkeypatch):
    monkeypatch.setattr("integrable.study.run._compute", lambda *_: pytest.fail("computed"))
    assert main(["run", "ball.toml", "--out", "ball.toml/x"]) == 2


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt, 130), (ZeroDivisionError, None)])
def test_a_run_that_ends_early_leaves_nothing_behind(here, capsys, monkeypatch, error, code):
    def stop(*_):
        raise error

    monkeypatch.setattr("integrable.study.run._compute", stop)
    if code is None:
        with pytest.raises(error):
            main(["run", "ball.toml"])
    else:
        assert main(["run", "ball.toml"]) == code
        assert capsys.readouterr().err == "integrable: interrupted\n"
    assert names(here) == ["ball.toml"]


def test_a_file_is_written_whole_or_not_at_all(here, monkeypatch, capsys):
    (here / "runs" / "ball").mkdir(parents=True)
    (here / "runs" / "ball" / "result.json").write_text("old", encoding="utf-8")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    assert main(["run", "ball.toml", "--force"]) == 2
    assert "No space left on device" in capsys.readouterr().err
    assert names(here / "runs" / "ball") == ["result.json"]
    assert (here / "runs" / "ball" / "result.json").read_text(encoding="utf-8") == "old"


def test_version_and_help(capsys):
    for option, word in (("--version", "integrable "), ("--help", "integrable run chaplygin")):
        with pytest.raises(SystemExit) as stop:
            main([option])
        assert stop.value.code == 0
        assert word in capsys.readouterr().out


def test_the_command_alone_says_what_one_can_do_next(here):
    """This is no error and writes no file, and every command that the text names exists."""
    done = subprocess.run([sys.executable, "-m", "integrable"], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    named = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("  integrable ")]
    assert named == ["run", "view", "scenes", "report", "--help"]
    assert max(map(len, done.stdout.splitlines())) <= 120
    assert names(here) == ["ball.toml"]


SCHEMA = Path(integrable.__file__).parent / "schemas" / "result.json"


@pytest.fixture
def valid():
    """A function that checks a result against the published schema."""
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema).is_valid


@pytest.mark.parametrize("options", [[], ["--digits", "20"], ["--out", "there", "--no-plots"]])
def test_json_goes_to_stdout_alone_and_is_what_the_schema_says(here, capsys, valid, options):
    (here / "ball.toml").write_text(BALL + REPORT, encoding="utf-8")
    assert main(["run", "ball.toml", "--json", *options]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    content = json.loads(captured.out)
    assert valid(content)
    assert content["report"]["rows"]
    assert len(content["trajectory"]["gamma"]) == len(content["trajectory"]["times"]) == 3
    if "--out" in options:
        assert valid(json.loads((here / "there" / "result.json").read_text(encoding="utf-8")))
    else:
        assert names(here) == ["ball.toml"]


def test_the_schema_refuses_what_is_no_result(here, capsys, valid):
    assert main(["run", "ball.toml", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert valid(content)
    for wrong in (
        {**content, "schema": 2},
        {**content, "digits": "many"},
        {**content, "trajectory": {"gamma": [[0, 1]], "M": [], "times": []}},
        {key: value for key, value in content.items() if key != "machine"},
    ):
        assert not valid(wrong)


@pytest.mark.parametrize(
    ("name", "count"), [("short.toml", 13), pytest.param("finite_field", 1001, marks=pytest.mark.slow)]
)
def test_an_orbit_over_a_finite_field_is_what_the_schema_says(here, capsys, valid, name, count):
    (here / "short.toml").write_text(EXACT, encoding="utf-8")
    assert main(["run", name, "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert valid(content)
    assert len(content["trajectory"]["steps"]) == count


@pytest.mark.parametrize("name", scene_names())
def test_a_shipped_scene_is_described_as_the_schema_says(name):
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    scene = {**schema["properties"]["scene"], "$defs": schema["$defs"]}
    jsonschema.Draft202012Validator(scene).validate(load_scene(name).describe())


def test_scenes_as_json(capsys):
    assert main(["scenes", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert sorted(content) == scene_names()
    assert content["chaplygin"]["inertia"] == ["1", "2", "3"]


def test_the_first_row_is_what_people_will_use(here, capsys):
    """The result comes before the comparisons, and the table names the unit of its times."""
    (here / "ball.toml").write_text(BALL + REPORT, encoding="utf-8")
    assert main(["run", "ball.toml", "--no-plots"]) == 0
    lines = capsys.readouterr().out.splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("method"))
    assert lines[head + 1].split()[:3] == ["divisor", "flow", "floats"]
    assert "in the scene's unit of time" in "".join(lines[:head])


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("integrable vi", ["view"]),
        ("integrable run euler", ["euler_top"]),
        ("integrable run ba", ["ball.toml"]),
        ("integrable report chaplygin --qui", ["--quick", "--quiet"]),
    ],
)
def test_a_shell_completes_commands_options_and_scenes(here, line, offered):
    pytest.importorskip("argcomplete")
    asked = {"_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE_IFS": "\n"}
    asked |= {"_ARGCOMPLETE_STDOUT_FILENAME": str(here / "offered")}
    subprocess.run([sys.executable, "-m", "integrable"], env={**os.environ, **asked}, cwd=here, check=True)
    assert sorted(word.strip() for word in (here / "offered").read_text(encoding="utf-8").split("\n")) == offered


def test_a_result_is_not_written_over_unasked(here, capsys, monkeypatch):
    assert main(["run", "ball.toml", "--quiet"]) == 0
    written = (here / "runs/ball/result.json").read_bytes()
    assert main(["run", "ball.toml", "--quiet"]) == 2
    said = f'out: "{Path("runs/ball")}" has a result; --force writes over it, --out names another folder'
    assert capsys.readouterr().err == f"integrable: error: {said}\n"
    assert main(["run", "ball.toml", "--quiet", "--digits", "20", "--force"]) == 0
    assert (here / "runs/ball/result.json").read_bytes() != written
    for answer, code in (("y\n", 0), ("\n", 2), ("", 2)):
        monkeypatch.setattr("sys.stdin", Terminal(answer))
        monkeypatch.setattr("sys.stderr", Terminal())
        assert main(["run", "ball.toml", "--quiet"]) == code
        assert "runs/ball has a result; write over it? [y/N] " in sys.stderr.getvalue().replace("\\", "/")


class Terminal(io.StringIO):
    """A text stream that claims to be a terminal."""

    def isatty(self):
        return True


def test_no_bar_in_a_file(here):
    """A bar used to be drawn even if stderr was redirected."""
    line = [sys.executable, "-m", "integrable", "report", "ball.toml", "--quick", "--no-plots"]
    running = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)
    try:
        with pytest.raises(subprocess.TimeoutExpired):
            running.communicate(timeout=4)
    finally:
        running.terminate()
        _, err = running.communicate()
    assert err == b""
