#!/bin/sh
# ctest: quick, heavy
# PDF files as another program reads them (poppler): the scale is exactly 1:1, pages have their
# size, words of the design stand in them as they are.
set -u
source=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
command -v pdfinfo >/dev/null || {
  echo "pdfinfo is needed: apt-get install poppler-utils (packages.txt)"
  exit 1
}
cd "$folder" || exit 1
"$DEA_COMMAND" --quiet fab "$source/examples/frdea-4.yaml" -o out --set fabrication.copies=2 \
  --set 'title="<b>Title</b> & more"' || exit 1
failed=0
# has FILE TEXT
has() {
  grep -qF -- "$2" "$1" || {
    echo "'$2' is not in $1"
    failed=1
  }
}
pdfinfo -f 1 -l 99 out/parts.pdf >info
has info "Pages:           11"
has info "Page    1 size:  595.276 x 841.89 pts (A4)"
has info "Page   11 size:  595.276 x 841.89 pts (A4)" # the sheet of 210 x 297 mm
has info "<b>Title</b> & more"
has out/process.html "Process sheet: &lt;b&gt;Title&lt;/b&gt; &amp; more"
has out/process.html "Cure at 80"
has out/process.html "unknown"
has out/process.html "default-src 'none'"
grep -qE '<(script|b|link|img)|https?://' out/process.html &&
  grep -oE '<(script|b|link|img)[^>]*|https?://[^"]*' out/process.html | grep -vE 'www.w3.org|^<body' &&
  { echo "the process sheet needs something else"; failed=1; }
# The frame on its page, out of the page's own operators: circles of 30 mm, 50 mm, 3 mm and 1.5 mm,
# and a bar of five times 10 mm. Cairo keeps places to 1/256 pt.
/usr/bin/python3 - <<'PYTHON' || failed=1
import re, sys, zlib

data = open("out/parts.pdf", "rb").read()
pages = []
for match in re.finditer(rb"stream\r?\n", data):
    if data[match.start() - 3 : match.start()] != b"end":
        try:
            text = zlib.decompressobj().decompress(data[match.end() :])
        except zlib.error:
            continue
        if b" cm\nq\n" in text[:60]:
            pages.append(text.decode("latin-1"))


def widths(text):
    """Widths in mm of all pieces of paths on a page."""
    matrix, kept, found, numbers, xs = (1, 0, 0, 1, 0, 0), [], [], [], []
    for word in re.sub(r"\((?:\\.|[^)])*\)", "0", text).split():
        if re.fullmatch(r"-?[0-9.]+", word):
            numbers.append(float(word))
            continue
        a, b, c, d, e, f = matrix
        if word == "q":
            kept.append(matrix)
        elif word == "Q":
            matrix = kept.pop()
        elif word == "cm":
            p, q, r, s, t, u = numbers[-6:]
            matrix = (p * a + q * c, p * b + q * d, r * a + s * c, r * b + s * d,
                      t * a + u * c + e, t * b + u * d + f)
        elif word == "re":
            found.append(abs(numbers[-2] * a))
        elif word in ("m", "l", "c"):
            if word == "m":
                xs = []
            xs += [x * a + y * c + e for x, y in zip(numbers[0::2], numbers[1::2])]
            found.append(max(xs) - min(xs))
        numbers = []
    return [w * 25.4 / 72 for w in found]


if len(pages) != 11:
    print("wanted 11 pages, found", len(pages))
    sys.exit(1)
found = widths(pages[4])
for wanted in (30, 50, 10, 3, 1.5):
    nearest = min(found, key=lambda w: abs(w - wanted))
    if abs(nearest - wanted) > 3e-3:
        print("wanted a width of", wanted, "mm, found", sorted(set(round(w, 4) for w in found)))
        sys.exit(1)
PYTHON
exit $failed
