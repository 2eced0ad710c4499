"""How the site is built: `sphinx-build -n -W -b html docs OUT`, without a network."""

import sys
from importlib.metadata import version as installed
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent / "src")]

project = "Faying"
author = "The Faying authors"
project_copyright = "The Faying authors, MIT licence"
version = release = installed("faying")

extensions = ["sphinx.ext.autodoc", "myst_parser", "mathml", "sphinxcontrib.bibtex", "sphinx_gallery.gen_gallery"]
extensions.append("faying_reference")
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 80
exclude_patterns = ["_ext", "gallery"]
nitpicky = True

myst_enable_extensions = ["amsmath", "attrs_inline", "colon_fence", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
html_math_renderer = "mathml"

# executed at every build; `-D plot_gallery=0` leaves that out
sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "generated/gallery",
    "filename_pattern": r"(plot_|front_page)",
    "ignore_pattern": r"(paper|paper_asperity)\.py",
    "copyfile_regex": "",
    "show_memory": False,
    "show_signature": False,
    "abort_on_example_error": True,
    "download_all_examples": False,
    "write_computation_times": False,
    "within_subsection_order": "FileNameSortKey",
}

bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "unsrt"

html_theme = "pydata_sphinx_theme"
html_static_path = ["_static"]
html_css_files = ["faying.css"]
html_title = "Faying"
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "show_toc_level": 1,
    "header_links_before_dropdown": 6,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "pygments_light_style": "default",
    "pygments_dark_style": "monokai",
}
