# Sphinx's settings for scripts/docs: the Markdown files as they are, one site, nothing of other hosts.
project = "libdea"
html_title = "libdea"
author = "libdea developers"
extensions = ["myst_parser"]
myst_heading_anchors = 4
include_patterns = ["index.md", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "ARCHITECTURE.md",
                    "docs/*.md", "docs/*/*.md", "lab/docs/*.md", "site/*.md"]
root_doc = "index"
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_show_search_summary = False  # it fetches pages, which browsers refuse where the site lies on disk
pygments_style = "friendly"
suppress_warnings = ["myst.header"]  # pages made by programs begin where their part of the whole does
