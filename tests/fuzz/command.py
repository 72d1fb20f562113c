"""Fuzz of the command line: every subcommand of ``integrable`` with invalid scenes, files and options.

The promised behaviour: exit code 2, one line on stderr, nothing on stdout, and no file made or changed.
"""

from __future__ import annotations

import io
import re
from contextlib import chdir, redirect_stderr, redirect_stdout
from importlib.resources import files
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from integrable.__main__ import main
from integrable.scene.file import scene_names
from tests.fuzz.case import Case, Complaint
from tests.fuzz.run import Suite

LONGEST = 2000
"""Letters of a message: the list of all scenes has seven hundred."""


class Obeyed(NamedTuple):
    """The result of a command line; ``changed``: the files that differ afterwards."""

    code: Any
    out: str
    err: str
    changed: list[str]


def obeyed(scene: str, *arguments: str) -> Obeyed:
    """``integrable`` with these arguments in a folder where scene.toml has this text, beside files of many kinds."""
    with TemporaryDirectory() as place, chdir(place):
        _laid_out(scene)
        before = _found()
        out, err = io.StringIO(), io.StringIO()
        with redirect_stdout(out), redirect_stderr(err):
            try:
                code: Any = main(arguments)
            except SystemExit as stop:  # argparse ends with SystemExit
                code = stop.code
        after = _found()
    changed = sorted(name for name in before.keys() | after.keys() if before.get(name) != after.get(name))
    return Obeyed(code, out.getvalue(), err.getvalue(), changed)


def _laid_out(scene: str) -> None:
    Path("scene.toml").write_text(scene, encoding="utf-8")
    Path("good.toml").write_text(_shipped("chaplygin"), encoding="utf-8")
    Path("empty.toml").touch()
    Path("latin.toml").write_bytes("title = 'é'".encode("latin-1"))
    Path("zeros.toml").write_bytes(bytes(100))
    Path("folder.toml").mkdir()
    Path("nobody.toml").symlink_to("nothing")
    Path("circle.toml").symlink_to("circle.toml")
    Path("file").write_text("somebody's", encoding="utf-8")


def _found() -> dict[str, Any]:
    paths = (path for path in Path().rglob("*") if not path.is_symlink())
    return {str(path): path.read_bytes() if path.is_file() else None for path in paths}


def _shipped(name: str) -> str:
    return (files("integrable") / "scenes" / f"{name}.toml").read_text(encoding="utf-8")


LONG = "x" * 300
SCENES = (
    "", ".", "..", "/", "file/ball", "nowhere/ball.toml", "chaplygn", "CHAPLYGIN", "chaplygin ", "chaplygin.tom",
    "a\nb", "a\nb.toml", LONG, f"{LONG}.toml", "empty.toml", "latin.toml", "zeros.toml", "folder.toml", "nobody.toml",
    "circle.toml", "circle.toml/ball", "file", "/dev/null", "\udcff", "\udcff.toml", "*", "~", "%s{0}",
)  # fmt: skip
OUTS = ("file", "file/x", "file/x/y", "circle.toml/x", "/dev/null/x", "/proc/x", f"{LONG}/x", "")
NUMBERS = ("", "nan", "many", "1e3", "1.5", "0", "-1", "-0", "9" * 5000, "0x10", "1 2", "∞", "None")
VALUES = (
    "nan", "inf", "-inf", "-1", "0", "-0.0", "1e999", "-1e400", "1e99999999999999999999", "9" * 5000, f"0x{'f' * 5000}",
    '""', '"x"', '"nan"', '"1/0"', '"0/1"', '"1e999"', f'"{"9" * 5000}"', f'"1/{"9" * 400}"', '"\\n"', '"\\u0000"',
    '"٣"', "[]", "[[]]", "{}", "true", "1979-05-27", "07:32:00", "[1, 2]", '["1", "x", true]', "{ until = 1 }",
    "{ until = 1e999, count = 3 }", "{ until = 1, count = 1e9 }", "{ until = 1, count = 99999999999999999999 }",
    "[" * 3000 + "]" * 3000, f'"{LONG * 20}"', "1 2", "",
)  # fmt: skip
VARIED = (
    "d", "d=", "=1", "d=1:2", "d=1:2:0", "d=1:2:-3", "d=1:2:3:lin", "d=1:2:3:log:4", "d=0:1:5:log", "d=-1:1:5:log",
    "d=1e-299:1e299:5:log", "d=1:1e299:5", "d=nan", "d=1,,2", "d=1e999", "d=1/0", "d=1:2:100000000", "x=1", "inertia=1",
    "inertia.0=1", "M.4=1", "d=1;2", "d=" + "9" * 5000, "d\n=1", "",
)  # fmt: skip


def _line(rng: Random, text: str) -> str:
    """A scene with a mistake in one line: its value replaced, the line omitted or doubled, or its key misspelt."""
    lines = text.splitlines()
    at = rng.choice([i for i, line in enumerate(lines) if re.match(r"\w+ = [^\"]*[^=]", line)])
    key, _, _ = lines[at].partition(" = ")
    lines[at : at + 1] = rng.choice(
        [[f"{key} = {rng.choice(VALUES)}"]] * 6 + [[], [lines[at]] * 2, [f"{key}s = 1"], [f"{key} : 1"], [f"[{key}"]]
    )
    return "\n".join(lines) + "\n"


def _arguments(rng: Random, name: str, options: dict[str, tuple[str, ...]]) -> list[str]:
    """An invalid option, an invalid scene, or a changed scene (which may still be valid) with an invalid place for the
    output.
    """
    which = rng.randrange(3)
    scene = ("good.toml", rng.choice(SCENES), "scene.toml")[which]
    chosen = ["--out"] if which == 2 else rng.sample(list(options), 1 if which == 0 else rng.randrange(2))
    given = [word for option in chosen for word in (option, rng.choice(options[option]))]
    return [name, scene, *given, *(["--out", WHERE[name]] if which == 0 and "--out" not in chosen else [])]


OPTIONS: dict[str, dict[str, tuple[str, ...]]] = {
    "run": {"--out": OUTS, "--digits": NUMBERS, "--format": ("gif", "", "PNG"), "--colour": ("red",)},
    "view": {
        "--out": (*OUTS[1:], "folder.toml", ".", "/"),  # without a folder: an existing file is replaced
        "--until": ("nan", "inf", "-inf", "0", "-1", "x", "1e999", ""),
        "--frames": (*NUMBERS, "1", "20001", "1000000000"),
    },
    "sweep": {
        "--out": ("file", "file.txt", "file/x.zarr", "folder.toml", ".zarr/x", f"{LONG}.zarr", "a\n.h6", "/proc/x.h5"),
        "--vary": VARIED,
        "--chunk": NUMBERS,
        "--executor": ("", "cluster", "thread"),
    },
    "report": {"--out": OUTS, "--jobs": NUMBERS, "--format": ("gif", "")},
}  # fmt: skip


# a valid place for the output, where options that follow it are checked
WHERE = {"run": "file/x", "view": "new.html", "sweep": "new.zarr", "report": "file/x"}


def command(name: str) -> Any:
    """The function that makes cases of a subcommand."""

    def made(rng: Random) -> Case:
        return case(_line(rng, _shipped(rng.choice(scene_names()))), _arguments(rng, name, OPTIONS[name]))

    return made


def other(rng: Random) -> Case:
    """No subcommand, or superfluous words after a subcommand."""
    words = ("scenes", "rum", "", "RUN", "run", "view", "sweep", "--what", "--jsn", "a\nb", "-", "\udcff", LONG)
    return case("", [rng.choice(words), rng.choice(words[1:])])


def case(scene: str, arguments: list[str]) -> Case:
    """A command line that must be refused."""
    call = f"obeyed({scene!r}, {', '.join(map(repr, arguments))})"
    return Case("from tests.fuzz.command import obeyed", call, judge, (), limit=3.0)


def judge(names: dict[str, Any]) -> Complaint | None:
    promised = {
        "the exit code is not 2": "got.code == 2",
        "it prints to stdout": "got.out == ''",
        "the message is not one line": "got.err.count('\\n') == 1 and '\\r' not in got.err",
        "the message is none of the command's": "got.err.startswith('integrable: error: ')",
        "the message is too long": f"len(got.err) < {LONGEST}",
        "files were made or changed": "not got.changed",
    }
    for why, check in promised.items():
        if not eval(check, {"got": names["got"]}):
            return Complaint(why, "exit code 2 and one line", check)
    return None


KINDS = {**{name: command(name) for name in OPTIONS}, "other": other}
SUITE = Suite("command", KINDS, dict.fromkeys(OPTIONS, 4))
