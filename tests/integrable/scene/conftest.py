"""Fixtures shared by the tests of scenes."""

import pytest


@pytest.fixture
def write(tmp_path):
    """Writes a text to a file, and returns its path."""

    def write(text, name="scene.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write
