"""Settings of the site, which ``python scripts/docs`` builds from a copy of this folder."""

from __future__ import annotations

from importlib.metadata import version as version_of

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

project = "liftmesh"
author = "The liftmesh developers"
copyright = author  # noqa: A001 - as Sphinx names it
version = release = version_of("liftmesh")
language = "en"

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
    "sphinx_design",
]
root_doc = "index"
exclude_patterns = ["_static"]
nitpicky = True

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4

html_theme = "furo"
html_title = f"liftmesh {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_last_updated_fmt = None


def setup(app: Sphinx) -> None:
    """Take diagrams, which only GitHub draws, as text."""
    app.add_lexer("mermaid", TextLexer)
