"""Reads the pages of a site in a folder: each link within has its file and its anchor, nothing is
loaded from another host, and the search knows what the pages say. Prints what is wrong.

    docs_links.py FOLDER
"""

import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, path: pathlib.Path):
        super().__init__()
        self.ids, self.links, self.loads = set(), [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.ids |= {given[key] for key in ("id", "name") if given.get(key)}
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        elif tag == "link" and given.get("href"):
            self.loads.append(given["href"])
        elif given.get("src"):
            self.loads.append(given["src"])


def main(folder: pathlib.Path) -> int:
    pages = {path: Page(path) for path in folder.rglob("*.html")}
    wrong, count = [], 0
    for path, page in pages.items():
        for address in page.links + page.loads:
            parts = urllib.parse.urlsplit(address)
            if parts.scheme in ("http", "https", "mailto") or parts.netloc:
                if address in page.loads:
                    wrong.append(f"{path}: loads {address}")
                continue
            if parts.scheme == "data":
                continue
            count += 1
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            anchor = urllib.parse.unquote(parts.fragment)
            if not target.is_file():
                wrong.append(f"{path}: {address} is not there")
            elif anchor and target in pages and anchor not in pages[target].ids:
                wrong.append(f"{path}: {address}: no such place on the page")
    index = (folder / "searchindex.js").read_text(encoding="utf-8")
    if "tension_field" not in index and "wrinkl" not in index:
        wrong.append("the search does not know the pages")
    print("\n".join(wrong))
    print(f"{len(pages)} pages, {count} links within, {len(wrong)} wrong")
    return len(wrong) > 0 or len(pages) < 50 or count < 1000


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
