"""Name the blanks of ``owner.toml``: ``python paper/owner.py``; exit code 1 while there is one."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

OWNER = Path(__file__).with_name("owner.toml")


def blanks(text: str) -> list[str]:
    """``section.key`` of every value that is empty."""
    sections = tomllib.loads(text)
    return [f"{section}.{key}" for section, keys in sections.items() for key, value in keys.items() if not value]


if __name__ == "__main__":
    left = blanks(OWNER.read_text(encoding="utf-8"))
    print("\n".join(f"{OWNER.name}: {name} is empty" for name in left) or "nothing is left blank")
    sys.exit(bool(left))
