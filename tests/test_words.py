"""The rules of the style guide in CONTRIBUTING.md that a program can check; the others need a reader."""

from __future__ import annotations

import ast
import re
from codeop import compile_command
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.test_architecture import modules, tree

ROOT = Path(__file__).resolve().parent.parent
# made by `integrable report`, from texts in integrable/study
MADE = {"docs/error_against_run_time.md"}
PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in (
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")),
    )
    if str(path.relative_to(ROOT)) not in MADE
)
# the most words; the guide asks for 25 and 99. Limits for pages are lower than for docstrings, which contain more names
SENTENCE, OF_A_PAGE, PARAGRAPH = 40, 30, 99


def prose(page: str) -> str:
    """The text of a page without code, tables, headings, pictures, formulas and addresses of links."""
    text = re.sub(r"^(```|~~~).*?^\1", "", page, flags=re.M | re.S)
    text = re.sub(r"\$\$.*?\$\$", "", text, flags=re.S)
    text = re.sub(r"\$\$.*?\$\$", "", text, flags=re.S)
    text = "\n".join("" if re.match(r"\s*([|#]|:{3}|:\w+:)|!\[| {4}", line) else line for line in text.split("\n"))
    return without_code(re.sub(r"\]\([^)]*\)", "]", text))


def without_code(text: str) -> str:
    return re.sub(r"``[^`]*``|`[^`]*`|\$[^$]*\$", " X ", text)


def paragraphs(text: str) -> Iterator[str]:
    """Blocks between empty lines; the items of a list are blocks of their own."""
    for block in re.split(r"\n\s*\n|\n(?=\s*(?:[-*†]|\d+\.)\s)", text):
        if block.strip():
            yield " ".join(block.split())


def sentences(paragraph: str) -> list[str]:
    """The parts that end with a full stop, a question mark, a colon or a semicolon before a possible beginning of a
    sentence.
    """
    return re.split(r"(?<=[.?!;:])[*\")\]]*\s+(?=[^a-z\W]|[*\[(\"]|X )", paragraph)


def words(text: str) -> int:
    """Words of two letters or more: symbols of formulas do not count."""
    return len(re.findall(r"[^\W\d_]{2,}", text))


def too_long(text: str, most: int = SENTENCE) -> list[str]:
    found = []
    for paragraph in paragraphs(text):
        if words(paragraph) > PARAGRAPH:
            found.append(f"paragraph of {words(paragraph)} words: {paragraph[:80]}")
        found += [f"sentence of {words(s)} words: {s[:80]}" for s in sentences(paragraph) if words(s) > most]
    return found


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_the_readme_is_a_page_that_a_terminal_shows():
    lines = read("README.md").splitlines()
    assert len(lines) <= 80
    assert [line for line in lines if len(line) > 120] == []


@pytest.mark.parametrize("page", PAGES)
def test_sentences_and_paragraphs_are_short(page):
    assert too_long(prose(read(page)), OF_A_PAGE) == []


def docstrings(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """(name, text) for the module and its public names, without indented lines, which are formulas or code."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (text := ast.get_docstring(node)):
            name = getattr(node, "name", "module")
            if not name.startswith("_"):
                lines = without_code(text).split("\n")
                yield name, "\n".join("" if line.startswith("    ") else line for line in lines)


def messages(tree: ast.Module) -> Iterator[tuple[str, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            parts = [x.value for x in ast.walk(node.exc) if isinstance(x, ast.Constant) and isinstance(x.value, str)]
            yield f"line {node.lineno}", " ".join(parts)


@pytest.mark.parametrize("texts", [docstrings, messages])
def test_sentences_of_docstrings_and_messages_are_short(texts):
    found = {
        f"{module}, {name}": wrong
        for module in modules()
        for name, text in texts(tree(module))
        if (wrong := too_long(text))
    }
    assert found == {}


TUTORIALS = [f"docs/start/{name}.md" for name in ("neither", "bodies", "curves")]


@pytest.mark.parametrize("page", ["README.md", "docs/index.md", *TUTORIALS])
def test_the_front_pages_tell_one_story(page):
    """All say that any time is a few additions away: not one, not two, not twenty doublings."""
    text = " ".join(read(page).lower().split())
    assert "means adding a" in text or "means **adding a" in text
    assert "few additions reach any time" in text
    assert "doublings" not in text


TYPED = sorted(path for part in ("start", "howto") for path in (ROOT / "docs" / part).iterdir())
CELL = re.compile(r"^```\{code-cell\} ipython3\n(?:---\n.*?^---\n)?(.*?)^```", re.M | re.S)


@pytest.mark.parametrize("page", TYPED, ids=lambda path: path.stem)
def test_cells_can_be_typed_at_the_prompt(page):
    """At Python's prompt an empty line ends a block, and nothing else does."""
    for cell in CELL.findall(page.read_text(encoding="utf-8")):
        pending: list[str] = []
        for line in [*cell.splitlines(), ""]:
            pending.append(line)
            if compile_command("\n".join(pending)) is not None:
                pending = []
        assert pending == []


def test_what_is_too_long_is_found():
    long = "One two " * 20
    assert too_long(f"{long}three.") != []
    assert too_long(f"{long.strip()}. {long.strip()}.") == []
    assert too_long("Six words are in this sentence. " * 17) != []
    assert too_long(prose("```\n" + "word " * 200 + "\n```\n")) == []
    body = f'    """{long}three."""\n    raise ValueError("{long}three")\n'
    source = f"def public():\n{body}\ndef _own():\n{body}"
    assert [name for name, text in docstrings(ast.parse(source)) if too_long(text)] == ["public"]
    assert [too_long(text) != [] for _, text in messages(ast.parse(source))] == [True, True]


def glossary_parts() -> list[list[str]]:
    """The two parts of the glossary: the words of the field, and our own."""
    blocks = re.findall(r"^```\{glossary\}\n(.*?)^```", read("docs/glossary.md"), re.M | re.S)
    return [[line for line in block.splitlines() if line and line[0] != " "] for block in blocks]


def glossary() -> list[str]:
    return [term for part in glossary_parts() for term in part]


def test_a_word_has_one_definition_in_the_glossary():
    assert [term for term, count in Counter(glossary()).items() if count > 1] == []


def test_a_word_has_one_definition_in_the_pages_of_the_rooms():
    found = Counter()
    for path in (ROOT / "docs" / "rooms").rglob("*.md"):
        defined = re.search(r"\*\*Words\.\*\*(.*?)\n\n", path.read_text(encoding="utf-8"), re.S)
        found.update({word.lower().removesuffix("s") for word in re.findall(r"\*+([^*]+)\*+", defined[1])})
    assert [word for word, count in found.items() if count > 1] == []


def test_our_own_words_are_in_the_glossary():
    guide = " ".join(read("CONTRIBUTING.md").split())
    own = re.search(r"Our own words \(([^)]*)\)", guide)[1].split(", ")
    assert len(own) >= 6
    field, ours = glossary_parts()
    assert set(own) == set(ours)
    terms = re.search(r"Use the field's term where there is one: ([^.]*)\.", guide)[1].split(", ")
    assert len(terms) >= 8
    assert set(terms) <= set(field)


def test_links_between_files_lead_to_a_file():
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "benchmarks").glob("*.md")]
    dead = [
        f"{path.relative_to(ROOT)}: {link}"
        for path in pages
        for link in re.findall(r"\]\(([^)\s#:]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8"))
        if not (path.parent / link).exists()
    ]
    assert len(pages) > 50
    assert dead == []
