#!/usr/bin/env python3
"""Makes the fonts of pictures for scripts that Barlow lacks, from Debian's packages of Noto fonts.

    apt-get download fonts-noto-cjk fonts-noto-core && for deb in *.deb; do dpkg-deb -x $deb fonts; done
    pip install fonttools && python3 make_fonts.py fonts/usr/share/fonts

Written beside this file: NotoSans-{Regular,Bold}.ttf (Latin, Vietnamese, Greek, Cyrillic) and NotoSansCJK-Regular.otf.gz: what
the national sets of characters have (GB 2312, Big5 level 1, JIS X 0208 level 1, KS X 1001), on a grid of 250 units,
which at the size of a plan's type looks the same and takes half the bytes.
"""
import gzip
import io
import pathlib
import sys

from fontTools import subset
from fontTools.ttLib import TTFont
from fontTools.ttLib.scaleUpem import scale_upem

HERE = pathlib.Path(__file__).parent
LAYOUT = ["vhea", "vmtx", "VORG", "BASE", "GSUB", "GPOS", "GDEF", "DSIG", "name", "STAT", "MATH"]
SIGNS = [*range(0x20, 0x180), *range(0x2010, 0x2040), 0x20AC, 0x2122, 0x2190, 0x2192, 0x2212, 0x2264, 0x2265]
WESTERN = [*SIGNS, *range(0x180, 0x250), *range(0x370, 0x530), *range(0x1E00, 0x1F00)]


def national(encoding, first, last, trail=range(0xA1, 0xFF)):
    """Characters of the rows of a national set of two bytes."""
    found = set()
    for lead in range(first, last + 1):
        for second in trail:
            try:
                found.add(ord(bytes([lead, second]).decode(encoding)))
            except (UnicodeDecodeError, TypeError):
                pass
    return found


def eastern():
    big5 = [*range(0x40, 0x7F), *range(0xA1, 0xFF)]
    return {
        *SIGNS, *range(0x3000, 0x3100), *range(0x3131, 0x3164), *range(0x3380, 0x33E0), *range(0xFF00, 0xFFF0),
        *national("gb2312", 0xA1, 0xF7), *national("big5", 0xA4, 0xC6, big5), *national("euc_jp", 0xA1, 0xCF),
        *national("euc_kr", 0xB0, 0xC8),
    }


def cut(path, characters, number=0, units=None):
    font = TTFont(path, fontNumber=number, lazy=True, recalcTimestamp=False)
    options = subset.Options(hinting=False, layout_features=[], desubroutinize=True, name_IDs=[], glyph_names=False)
    options.drop_tables += LAYOUT
    chosen = subset.Subsetter(options)
    chosen.populate(unicodes=characters)
    chosen.subset(font)
    out = io.BytesIO()
    font.save(out)
    if units:
        out.seek(0)
        font = TTFont(out, recalcTimestamp=False)
        scale_upem(font, units)
        out = io.BytesIO()
        font.save(out)
    return out.getvalue()


def main(folder):
    for weight in ["Regular", "Bold"]:
        path = folder / f"truetype/noto/NotoSans-{weight}.ttf"
        (HERE / f"NotoSans-{weight}.ttf").write_bytes(cut(path, WESTERN))
    # the third font of the collection has the forms of mainland China for what is written differently elsewhere
    font = cut(folder / "opentype/noto/NotoSansCJK-Regular.ttc", eastern(), 2, 250)
    (HERE / "NotoSansCJK-Regular.otf.gz").write_bytes(gzip.compress(font, 9, mtime=0))


main(pathlib.Path(sys.argv[1]))
