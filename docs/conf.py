"""Configuration of the documentation: `make docs` builds it into build/docs/html."""

import hashlib
import os
import sys
from importlib.metadata import version as version_of
from pathlib import Path

from jupyter_cache import get_cache
from numpydoc.xref import DEFAULT_LINKS

HERE = Path(__file__).parent
ROOT = HERE.parent
BUILD = ROOT / "build" / "docs"

sys.path[:0] = [str(HERE / "_ext"), str(ROOT / "src")]
os.environ["MATPLOTLIBRC"] = str(HERE / "matplotlibrc")  # of notebooks and gallery alike
# of notebooks: this tree's ratestate, reference_values, and the records of tests and benchmarks
FOLDERS = ROOT / "src", HERE / "_ext", ROOT / "tests/helpers", ROOT / "benchmarks"
os.environ["PYTHONPATH"] = os.pathsep.join(map(str, FOLDERS))
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
os.environ["COLUMNS"] = "88"  # of what commands print
os.environ["TERM"] = "dumb"  # no progress bars and colours

# Notebooks know nothing of the IPython that this machine may have set up, and log errors only.
PROFILE = BUILD / "ipython" / "profile_default"
PROFILE.mkdir(parents=True, exist_ok=True)
(PROFILE / "ipython_kernel_config.py").write_text("c.IPKernelApp.log_level = 40\n", "utf-8")
os.environ["IPYTHONDIR"] = str(PROFILE.parent)

project = "ratestate"
author = "The ratestate developers"
project_copyright = author
version = release = version_of("ratestate")

extensions = [
    "sphinx.ext.autodoc",
    "myst_nb",
    "numpydoc",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "generated",
    "mathml",
    "notebooks",
    "references",
]
exclude_patterns = ["gallery", "**.ipynb", "README.md"]
suppress_warnings = ["config.cache"]
nitpicky = True
default_role = "py:obj"
smartquotes = False  # "--out" is two dashes

# Notebooks, executed while building.  What has been run is kept until the code changes.
_sources = [*sorted((ROOT / "src").rglob("*.py")), HERE / "matplotlibrc"]
_digest = hashlib.sha256(b"".join(path.read_bytes() for path in _sources)).hexdigest()[:16]
nb_execution_mode = "cache"
nb_execution_in_temp = True  # pages write files
nb_execution_cache_path = str(BUILD / "notebooks" / _digest)
get_cache(nb_execution_cache_path).list_cache_records()  # made here, not by two processes at once
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
nb_render_markdown_format = "gfm"
nb_mime_priority_overrides = [("html", "image/svg+xml", 0)]

myst_enable_extensions = ["amsmath", "attrs_block", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# Docstrings
autodoc_member_order = "bysource"
autodoc_typehints = "none"
toc_object_entries_show_parents = "hide"
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
DEFAULT_LINKS.clear()  # to other projects, for which the network would be needed
numpydoc_xref_ignore = "all"  # but for these
numpydoc_xref_aliases = {
    name: f"ratestate.{name}"
    for name in (
        "Loading NotConverged ParameterError QuasiStaticInstability SolverError SpringSlider"
        " StoreError"
    ).split()
}

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "filename_pattern": r"/[a-z]",
    "backreferences_dir": None,
    "download_all_examples": False,
    "write_computation_times": False,
    "show_memory": False,
    "show_signature": False,
    "remove_config_comments": True,
    "reset_modules": ("references.reset_matplotlib",),
    "within_subsection_order": "FileNameSortKey",
    "copyfile_regex": r".*\.rst",
    "image_srcset": ["2x"],
}

html_math_renderer = "mathml"
html_theme = "pydata_sphinx_theme"
html_title = "ratestate"
html_static_path = ["_static"]
templates_path = ["_templates"]
html_css_files = ["ratestate.css"]
html_favicon = "_static/mark.svg"
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "logo": {
        "text": "ratestate",
        "image_light": "_static/mark.svg",
        "image_dark": "_static/mark.svg",
        "alt_text": "ratestate, a block on a spring",
    },
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "show_prev_next": True,
    "navbar_align": "left",
    "header_links_before_dropdown": 10,
    "article_header_end": ["notebook.html"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "back_to_top_button": False,
}
# pages without pages below them need no list of those
html_sidebars = {page: [] for page in ("index", "install", "start", "coming_from", "primer")}
