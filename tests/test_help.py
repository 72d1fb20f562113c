"""The help of every command fits narrow terminals."""

from __future__ import annotations

import re

import pytest

import benchmarks.__main__
import integrable.__main__
import jacobian.__main__
import tests.fuzz.__main__

PROGRAMS = {
    "integrable": integrable.__main__.main,
    "jacobian": jacobian.__main__.main,
    "benchmarks": benchmarks.__main__.main,
    "fuzz": tests.fuzz.__main__.main,
}
COMMANDS = {"integrable": {"scenes", "run", "sweep", "view", "report", "race", "doctor"}}
COMMANDS["jacobian"] = {"compile", "sato-tate", "page"}


@pytest.fixture
def help_of(capsys):
    """What a program prints for --help."""

    def printed(program, *command):
        with pytest.raises(SystemExit) as stop:
            PROGRAMS[program]([*command, "--help"])
        assert stop.value.code == 0
        return capsys.readouterr().out

    return printed


@pytest.mark.parametrize("width", [40, 60, 80, 120])
@pytest.mark.parametrize("program", PROGRAMS)
def test_help_fits_the_terminal(program, width, help_of, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    texts = [help_of(program)]
    commands = set(re.findall(r"^    ([a-z-]+)\b", texts[0].partition("COMMAND\n")[2].partition("\n\n")[0], re.M))
    assert commands == COMMANDS.get(program, set())
    texts += [help_of(program, command) for command in commands]
    assert max(len(line) for text in texts for line in text.splitlines()) <= width


@pytest.mark.parametrize("width", [40, 64, 120])
def test_the_first_text_fits_the_terminal(width, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    assert integrable.__main__.main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "What you can do next:" in lines
    assert max(map(len, lines)) <= width


def test_a_wide_terminal_shows_options_beside_the_name(help_of, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert "\n" + 22 * " " + "[--format {png,svg,both}]" in help_of("integrable", "run")
    monkeypatch.setenv("COLUMNS", "40")
    assert "\n    [--format {png,svg,both}]\n" in help_of("integrable", "run")
