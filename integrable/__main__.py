"""The ``integrable`` command, which lists scenes, runs them and reports error against run time; its other commands are
``sweep``, ``view``, ``race`` and ``doctor``.
"""

from __future__ import annotations

from integrable import _command

if __name__ == "__main__":
    # this call precedes the imports: _command makes the process handle interrupts, and then imports this file again
    _command()

import argparse
import os
import re
import sys
import warnings
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path
from shutil import get_terminal_size
from textwrap import wrap
from typing import Any, NoReturn, TypeVar

from integrable.extras import version_of, without
from integrable.scene.file import load_scene, scene_names
from jacobian.errors import ArgumentError, JacobianError, shortened
from jacobian.terminal import CommandParser, write_anything

__all__ = ["main"]

Place = TypeVar("Place", Path, Path | None)

_EPILOG = """\
examples:
  integrable scenes                           what there is
  integrable run chaplygin                    a report on the terminal, files in runs/chaplygin
  integrable run my_ball.toml --digits 50     a scene of your own (docs/scenes.md), at 50 digits
  integrable view chaplygin                   a page in which the ball rolls: runs/chaplygin/view.html
  integrable sweep chaplygin --vary d=0.1:2:50
                                              50 motions in one file (docs/many.md)
  integrable race my.py:solve                 your integrator beside others (docs/howto/own_integrator.md)
  integrable report chaplygin --quick         error against run time of a scene beside other integrators (a minute)
  integrable report                           of all scenes and methods; may be killed and started again
"""


_FIRST = """\
integrable: rigid bodies that roll and turn, at any time, by addition of divisors.

What you can do next:
  integrable run chaplygin      roll a ball: error against run time beside SciPy, pictures in runs/chaplygin (a minute)
  integrable view chaplygin     see it roll: a page for your browser, runs/chaplygin/view.html
  integrable scenes             the other scenes: tops, thin and heavy balls, separatrices, finite fields
  integrable report chaplygin --quick   error against run time beside other integrators (a minute)
  integrable --help             all commands; integrable COMMAND --help: their options

A scene of your own is a file of ten lines: docs/scenes.md. In Python: import integrable; help(integrable).
"""


def _folded(text: str) -> str:
    """The text with long lines folded to the terminal's width. In a line of a name and an explanation, the explanation
    stays in its column.
    """
    lines, width = [], get_terminal_size((120, 24)).columns
    for line in text.splitlines():
        hang = len(match[0]) if (match := re.match(r" *\S+(?: \S+)* {2,}", line)) else 4 * line.startswith(" ")
        below = " " * (hang if 2 * hang < width else 4)
        lines += wrap(line, width, subsequent_indent=below, break_on_hyphens=False) or [""]
    return "\n".join(lines)


class _Parser(CommandParser):
    """An argument parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"integrable: error: {shortened(' '.join(message.split()))}; see {self.prog} --help\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="integrable",
        description=_folded("Rigid-body motion by addition of divisors: run a scene, report error against run time."),
        epilog=_folded(_EPILOG),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--version", action="version", version=f"integrable {version_of('jacobian-integrable') or '(not installed)'}"
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    scenes = commands.add_parser("scenes", help="list the scenes that ship with the package")
    scenes.add_argument("--json", action="store_true", help="the scenes themselves, as JSON on stdout")
    run = commands.add_parser(
        "run", help="run a scene", description="Run a scene and write what it asks for to a folder."
    )
    _add_scene(run)
    run.add_argument(
        "--digits", type=int, metavar="N", help="digits of the run: up to 15 floats, above that multiprecision"
    )
    run.add_argument("--out", metavar="DIR", help="folder for the files (default: runs/<scene>)")
    run.add_argument("--force", action="store_true", help="overwrite a result in the folder without asking")
    run.add_argument(
        "--format", choices=("png", "svg", "both"), default="png", help="format of the pictures (default: png)"
    )
    run.add_argument("--no-plots", action="store_true", help="no pictures, and matplotlib is not imported")
    run.add_argument(
        "--json",
        action="store_true",
        help="the result as JSON on stdout (integrable/schemas/result.json says what is in it); files with --out only",
    )
    _add_quiet(run)
    _add_sweep(commands)
    _add_view(commands)
    _add_report(commands)
    _add_race(commands)
    commands.add_parser("doctor", help="what is installed, compiled and kept, how fast it is here, and what is wrong")
    return parser


def _add_scene(command: argparse.ArgumentParser) -> None:
    scene: Any = command.add_argument(
        "scene", metavar="NAME_OR_FILE", help="a name from `integrable scenes`, or a .toml file"
    )
    scene.completer = _scenes_and_files


def _scenes_and_files(prefix: str, **_: Any) -> list[str]:
    """The names of all scenes, and of TOML files that begin with ``prefix``, for the shell's completion."""
    from argcomplete.completers import FilesCompleter

    return [*scene_names(), *FilesCompleter(["toml"])(prefix)]


def _add_quiet(command: argparse.ArgumentParser) -> None:
    command.add_argument("--quiet", action="store_true", help="print nothing but errors")
    command.add_argument(
        "--progress", action="store_true", help="draw the progress bar even where stderr is not a terminal"
    )


def _bar_wanted(arguments: argparse.Namespace) -> bool:
    return not arguments.quiet and (arguments.progress or sys.stderr.isatty())


def _add_sweep(commands: Any) -> None:
    sweep = commands.add_parser(
        "sweep",
        help="run a scene with many values of its numbers",
        description="The states of a scene at its times, for all combinations of the given values, in one file. "
        "Finished chunks are kept: a sweep that was killed resumes when started again.",
    )
    _add_scene(sweep)
    sweep.add_argument(
        "--vary",
        metavar="NAME=VALUES",
        action="append",
        default=[],
        help="d=0.1:2:50 (50 values), M.scale=0.01:10:4:log or inertia.2=2,2.5; once for each name (docs/many.md)",
    )
    sweep.add_argument("--out", metavar="FILE", help="a .zarr or .h5 file (default: runs/<scene>-sweep.zarr)")
    sweep.add_argument(
        "--executor", choices=("processes", "threads"), default="processes", help="kind of workers (default: processes)"
    )
    sweep.add_argument("--chunk", type=int, metavar="N", help="number of motions computed and stored together")
    _add_quiet(sweep)


def _sweep(arguments: argparse.Namespace) -> None:
    from integrable.scene.output import OutputFolder, portable
    from integrable.sweeps.grid import from_words
    from integrable.sweeps.sweep import sweep

    scene, vary = load_scene(arguments.scene), from_words(arguments.vary)
    out = _place(arguments.out, Path("runs") / f"{portable(scene.name)}-sweep.zarr")
    with OutputFolder(out.parent):
        found = sweep(
            scene,
            vary=vary,
            out=out,
            executor=arguments.executor,
            chunk=arguments.chunk,
            progress=_bar_wanted(arguments),
        )
    if not arguments.quiet:
        said = f", {found.refused} of them refused" if found.refused else ""
        print(f"{found.members} motions{said}\n\nwritten to {found.path}")


def _add_view(commands: Any) -> None:
    view = commands.add_parser(
        "view",
        help="make a page in which a scene moves",
        description="Write one HTML file in which the body moves: the ball on its plane, γ on the sphere, the two "
        "points on the curve, the straight line on the torus. It opens in any browser and loads nothing else.",
    )
    _add_scene(view)
    view.add_argument("--out", metavar="FILE", help="the file (default: runs/<scene>/view.html)")
    view.add_argument(
        "--until", type=float, metavar="T", help="last time, in the scene's unit (default: its own, or some ten turns)"
    )
    view.add_argument("--frames", type=int, metavar="N", default=600, help="number of times drawn (default: 600)")


def _add_report(commands: Any) -> None:
    report = commands.add_parser(
        "report",
        help="error against run time of scenes, beside every comparator",
        description="Measure error against run time of the divisor flow, the Bäcklund steps and every comparator. Rows "
        "are kept one by one: a study that was killed resumes when started again. Two on one folder share the work.",
    )
    scenes: Any = report.add_argument(
        "scenes", metavar="NAME_OR_FILE", nargs="*", help="scenes (default: all that ship)"
    )
    scenes.completer = _scenes_and_files
    report.add_argument("--quick", action="store_true", help="fewer settings and repeats: about a minute a scene")
    report.add_argument("--out", metavar="DIR", help="folder of the study (default: runs/report, runs/report-quick)")
    report.add_argument(
        "--format", choices=("png", "svg", "both"), default="svg", help="format of the figures (default: svg)"
    )
    report.add_argument("--no-plots", action="store_true", help="no figures, and matplotlib is not imported")
    report.add_argument(
        "--jobs",
        type=int,
        metavar="N",
        help="number of truths computed at once (default: the cores); timed rows run alone",
    )
    report.add_argument(
        "--minutes",
        type=float,
        metavar="N",
        help="begin no row after this many; the page names the others as not measured (default: no limit)",
    )
    report.add_argument(
        "--json",
        action="store_true",
        help="what report.json in the folder holds (integrable/schemas/report.json) as JSON on stdout too",
    )
    _add_quiet(report)


def _add_race(commands: Any) -> None:
    race = commands.add_parser(
        "race",
        help="run your own integrator beside others on problems whose solution is known",
        description="Run functions solve(problem, times, tolerance) over a ladder of tolerances, beside SciPy's "
        "methods, heyoka and compiled ones (docs/howto/own_integrator.md). Writes race.json, race.txt and race.html.",
    )
    race.add_argument("own", metavar="MODULE:FUNCTION", nargs="*", help="yours: mymodule:solve or file.py:solve")
    problems: Any = race.add_argument(
        "--problem", metavar="NAME", action="append", help="a problem (default: t_handle); once for each, or all"
    )
    problems.completer = _scenes_and_files
    race.add_argument(
        "--rival", metavar="NAME", action="append", help="a method; once for each (default: the strong ones)"
    )
    race.add_argument("--limit", type=float, metavar="S", default=4.0, help="seconds that a run may take (default: 4)")
    race.add_argument("--out", metavar="DIR", help="folder for the files (default: runs/race)")
    race.add_argument(
        "--json", action="store_true", help="what race.json holds as JSON on stdout; no files without --out"
    )
    _add_quiet(race)


def _race(arguments: argparse.Namespace) -> None:
    from integrable.problems import problem_names
    from integrable.races.entrants import RIVALS, loaded
    from integrable.races.race import pieces_of_race, race
    from integrable.scene.output import as_json
    from integrable.scene.progress import bar_of_pieces
    from integrable.study.timing import silent

    out = _place(arguments.out, None if arguments.json else Path("runs") / "race")
    names = arguments.problem or ["t_handle"]
    own = dict(map(loaded, arguments.own))
    rivals, problems = tuple(arguments.rival or RIVALS), problem_names() if names == ["all"] else names
    drawn = _bar_wanted(arguments) and not without({"tqdm": "the progress bar"})
    with bar_of_pieces("race", pieces_of_race(problems, rivals)) if drawn else nullcontext(silent) as tick:
        found = race(problems, own, rivals=rivals, limit=arguments.limit, tick=tick)
    if arguments.json:
        print(as_json(found.as_dict()), end="")
    elif not arguments.quiet:
        print(found.table())
    if out is not None:
        found.write(out)
        if not (arguments.quiet or arguments.json):
            print(f"\nfiles written to {out}")


def _list_scenes(arguments: argparse.Namespace) -> None:
    from integrable.scene.output import as_json
    from integrable.scene.tables import aligned

    scenes = [load_scene(name) for name in scene_names()]
    if arguments.json:
        print(as_json({scene.name: scene.describe() for scene in scenes}), end="")
        return
    rows = [("name", "system", "title"), *((scene.name, scene.system, scene.title) for scene in scenes)]
    print("\n".join(aligned(rows, left=3)))


def _run(arguments: argparse.Namespace) -> None:
    from integrable.scene.output import as_json, portable, result
    from integrable.study.run import run

    scene = load_scene(arguments.scene)
    out = _place(arguments.out, None if arguments.json else Path("runs") / portable(scene.name))
    # Path.exists would raise for a name that the file system refuses; the later attempt to write reports the reason
    if out is not None and not arguments.force and os.path.exists(out / "result.json"):
        _ask(out)
    trajectory = run(
        scene,
        digits=arguments.digits,
        out=out,
        progress=_bar_wanted(arguments),
        pictures=not arguments.no_plots,
        formats=_formats(arguments),
        lines=None if arguments.json or arguments.quiet else _line,
    )
    if arguments.json:
        digits = scene.digits if arguments.digits is None else arguments.digits
        print(as_json(result(scene, digits, trajectory, None)), end="")
        return
    if arguments.quiet:
        return
    if scene.steps is not None:
        print(trajectory.report.table())
    elif trajectory.report is None:
        print(f"{scene.title}: {len(trajectory.gamma)} times computed, no report asked for")
    print(f"\nfiles written to {out}")


def _ask(out: Path) -> None:
    """Asks a user at a terminal whether to overwrite a result. Raises ArgumentError if the answer is no, or if there is
    no terminal.
    """
    if sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty():
        print(f"{out} has a result; write over it? [y/N] ", end="", file=sys.stderr, flush=True)
        if sys.stdin.readline().strip().lower() in ("y", "yes"):
            return
    raise ArgumentError(f'out: "{out}" has a result; --force writes over it, --out names another folder')


def _line(text: str) -> None:
    bar = sys.modules.get("tqdm")
    if bar is None:
        print(text, flush=True)
    else:
        bar.tqdm.write(text)
        sys.stdout.flush()


def _view(arguments: argparse.Namespace) -> None:
    from integrable.scene.output import portable
    from integrable.view.page import view

    scene = load_scene(arguments.scene)
    out = _place(arguments.out, Path("runs") / portable(scene.name) / "view.html")
    print(f"open {view(scene, out, until=arguments.until, frames=arguments.frames)} in a browser")


def _doctor(_: argparse.Namespace) -> int:
    from integrable.doctor import findings

    found = findings()
    print(found.text())
    return int(bool(found.wrong))


def _place(given: str | None, usual: Place) -> Path | Place:
    """The output folder or file: that of --out, else ``usual``."""
    if given == "":
        raise ArgumentError('--out: "" given; the name of a file or folder is needed')
    return usual if given is None else Path(given)


def _formats(arguments: argparse.Namespace) -> tuple[str, ...]:
    return ("png", "svg") if arguments.format == "both" else (arguments.format,)


def _report(arguments: argparse.Namespace) -> None:
    from integrable.study.command import study_of
    from integrable.study.page import answer

    out = _place(arguments.out, Path("runs") / ("report-quick" if arguments.quick else "report"))
    study = study_of(
        arguments.scenes,
        out=out,
        quick=arguments.quick,
        formats=() if arguments.no_plots else _formats(arguments),
        jobs=arguments.jobs,
        progress=_bar_wanted(arguments) and not arguments.json,
        minutes=arguments.minutes,
    )
    if arguments.json:
        print((out / "report.json").read_text(encoding="utf-8"), end="")
    elif not arguments.quiet:
        print(f"{answer(study)}\n\nfiles written to {out}")


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command and returns the exit code.

    The code is 0, 1 if ``doctor`` finds a problem, 2 for a wrong argument, a wrong scene or an output that cannot be
    written, 130 when interrupted, and 141 if stdout is a pipe that was closed.
    """
    write_anything()
    parser = _parser()
    if "_ARGCOMPLETE" in os.environ:  # a shell asks for completions
        import argcomplete

        argcomplete.autocomplete(parser)
    arguments = parser.parse_args(argv)
    with warnings.catch_warnings():
        warnings.showwarning = _silent if getattr(arguments, "quiet", False) else _one_line
        return _obey(arguments)


def _one_line(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"integrable: warning: {message}", file=sys.stderr)


def _silent(*_: Any, **__: Any) -> None: ...


_COMMANDS: dict[str, Callable[[argparse.Namespace], int | None]] = {
    "scenes": _list_scenes, "run": _run, "sweep": _sweep, "view": _view, "report": _report, "race": _race,
    "doctor": _doctor,
}  # fmt: skip


def _obey(arguments: argparse.Namespace) -> int:
    try:
        if arguments.command is None:
            print(_folded(_FIRST))
        elif code := _COMMANDS[arguments.command](arguments):
            return code
        if sys.stdout is not None:  # None if the caller has closed it
            sys.stdout.flush()
    except JacobianError as error:
        message = " ".join(str(error).split())
        print(f"integrable: error: {message}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        _write_no_more()
        return 141
    except OSError as error:
        if error.filename is not None:  # the code that uses the file should have raised an ArgumentError
            raise
        _write_no_more()
        from integrable.files.whole import reason

        print(f"integrable: error: the output cannot be written: {reason(error)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("integrable: interrupted", file=sys.stderr)
        return 130
    return 0


def _write_no_more() -> None:
    """Discards further output. Otherwise Python would try to write the rest on exit, and print an error."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
