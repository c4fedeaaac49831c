"""Settings of the site, which ``python scripts/docs`` builds from a copy of this folder."""

from __future__ import annotations

from importlib.metadata import version as version_of
from pathlib import Path

from docstrings import Looked
from links import ROOT, address
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

project = "liftmesh"
author = "The liftmesh developers"
copyright = author  # noqa: A001 - as Sphinx names it
version = release = version_of("liftmesh")
language = "en"
smartquotes = False  # they would spoil words of commands and of Python

extensions = [
    "docstrings",
    "names",
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
root_doc = "index"
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(scipy|matplotlib|dask\.distributed|warnings)\..*")]
templates_path = ["_templates"]
exclude_patterns = ["_static", "_templates"]
default_role = "autolink"

autodoc_typehints = "none"
# By name: of an earlier build, "all" would be the pages that were there then.
autosummary_generate = [f"api/{each.name}" for each in Path(__file__).parent.glob("api/*.rst")]
autosummary_context = {name: Looked(name) for name in ("methods_of", "properties_of")}
numpydoc_show_class_members = False

sphinx_gallery_conf = {
    "examples_dirs": str(ROOT / "docs" / "gallery"),
    "gallery_dirs": "gallery",
    "backreferences_dir": "gallery/of",
    "doc_module": ("liftmesh",),
    "reference_url": {"liftmesh": None},
    "reset_modules": ("matplotlib", "gallery.style"),
    "image_srcset": ["2x"],
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "notebook_extensions": set(),
    "remove_config_comments": True,
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
}

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4

toc_object_entries_show_parents = "hide"

html_theme = "pydata_sphinx_theme"
html_theme_options = {
    "collapse_navigation": True,
    "header_links_before_dropdown": 9,
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "secondary_sidebar_items": ["page-toc"],
    "show_nav_level": 1,
    "show_prev_next": False,
    "footer_start": ["copyright"],
    "footer_end": [],
}
if source := address("Source"):
    html_theme_options["icon_links"] = [
        {"name": "Source", "url": source, "icon": "fa-solid fa-code"}
    ]
    html_theme_options["navbar_end"] = ["theme-switcher", "navbar-icon-links"]
html_baseurl = address("Documentation") or ""
html_context = {"default_mode": "auto"}
html_title = f"liftmesh {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_last_updated_fmt = None


def setup(app: Sphinx) -> None:
    """Take diagrams, which only GitHub draws, as text."""
    app.add_lexer("mermaid", TextLexer)
