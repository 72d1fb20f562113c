"""Sphinx's settings of the site; `docs/build.py` lays out the pages and runs it."""

from __future__ import annotations

import re
import sys
from importlib import metadata
from pathlib import Path

from docutils import nodes

project = "jacobian-integrable"
author = "The jacobian-integrable authors"
copyright = "2026, the jacobian-integrable authors"
version = release = metadata.version("jacobian-integrable")

sys.path.insert(0, str(Path(__file__).parent))

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx_design", "mathml"]
exclude_patterns = ["figures"]
html_theme = "pydata_sphinx_theme"
html_title = "jacobian · integrable"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_js_files = [("sort.js", {"defer": "defer"})]
html_search_scorer = str(Path(__file__).parent / "scorer.js")
html_math_renderer = "mathml"
html_theme_options = {
    "navbar_align": "left",
    "show_prev_next": False,
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
    "header_links_before_dropdown": 7,
    "secondary_sidebar_items": ["page-toc"],
}
html_context = {"default_mode": "light"}
smartquotes = False  # in formulas an apostrophe is a prime
html_show_sourcelink = False
html_copy_source = False

myst_enable_extensions = ["colon_fence", "deflist", "attrs_inline", "dollarmath"]
myst_heading_anchors = 3
# cells are run at every build, one kernel a page; what they raise fails the build
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_show_tb = True
nb_merge_streams = True
nb_ipywidgets_js = {}
# a cell that shows a figure has a PNG and the words of its repr; both need not be there
# two classes are called Body, and an annotation does not say whose
suppress_warnings = ["mystnb.unknown_mime_type", "ref.python"]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 90


# characters of a cell that stays in one line, and of a name that may take several
SHORT, LONG = 18, 28

_KEPT = re.compile(r"((?<![^\s(])\*\w[\w ]*\w\*(?!\w)|``.*?``|:[\w:]+:`[^`]*`|`[^`]*`_?|>>> .*)")


def _plain_bars(app, what, name, obj, options, lines):
    """|γ| in a docstring is a length, not a substitution, and a·x* no emphasis: escape what reST would read so."""
    for k, line in enumerate(lines):
        parts = _KEPT.split(line)
        parts[::2] = [re.sub(r"([|*])|(?<=\w)_(?=\W|$)", lambda m: "\\" + m[0], part) for part in parts[::2]]
        lines[k] = "".join(parts)


def _cells(app, doctree, page):
    """Figures and short words in tables are not broken; names that are too long for a column are."""
    for cell in doctree.findall(nodes.entry):
        if len(cell.astext()) <= SHORT:
            cell["classes"].append("short")
        for name in cell.findall(nodes.literal):
            if len(name.astext()) > LONG:
                name["classes"].append("long")


def setup(app):
    app.connect("autodoc-process-docstring", _plain_bars)
    app.connect("doctree-resolved", _cells)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
