"""Writes `lookalikes.toml` of the pipeline: words of a language that differ by one letter from one that names a room, a
building, an object or a robot, and so are no misspelling of it ("closer" is no "closet").

    pip install wordfreq; python tests/lookalikes.py

To be run again when the vocabularies of the shipped domains have grown. `wordfreq` (Apache 2.0; its lists of words are
CC BY-SA 4.0) says which words people use; the few that matter are kept in the repository, so that nothing needs it to build.
"""
import pathlib
import re
import tomllib
import unicodedata

import wordfreq

ROOT = pathlib.Path(__file__).parents[1]
READER = ROOT / "service/program/src/tokens"
LANGUAGES = ["en", "de", "fr", "es"]
# words that are rarer than that, on the scale of Zipf, are as likely misspelled
LEAST_ZIPF = 2.7
# and so are those that are so much rarer than what they look like ("libary"), and not common
RARER, COMMON = 1.9, 3.3
# letters of words of rooms and buildings, and of names of objects, that misspellings are looked for of; of shorter names of
# buildings only those that have lost a letter
LEAST_ROOM, LEAST_OBJECT, SHORT = 6, 8, 5
ENDINGS = {"en": ["s", "es"], "de": ["n", "en", "e", "s"], "fr": ["s"], "es": ["s", "es"]}


def fold(word: str) -> str:
    plain = unicodedata.normalize("NFD", word.lower().replace("ß", "ss").replace("œ", "oe").replace("æ", "ae"))
    return "".join(c for c in plain if c.isalnum() and c.isascii())


def targets() -> tuple[dict[str, set[str]], dict[str, set[str]]]:
    """Returns the words of the shipped domains, and the short names of buildings, by language."""
    found: dict[str, set[str]] = {language: set() for language in LANGUAGES}
    short: dict[str, set[str]] = {language: set() for language in LANGUAGES}

    def walk(value: object, objects: bool) -> None:
        if isinstance(value, dict):
            for key, inner in value.items():
                if key == "keywords" and isinstance(inner, dict):
                    for language in LANGUAGES:
                        for phrase in inner.get(language, []):
                            words = [fold(word) for word in re.split(r"[^\w]+", phrase)]
                            least = LEAST_OBJECT if objects else LEAST_ROOM
                            if not objects or len(words) == 1:
                                found[language] |= {w for w in words if len(w) >= least and w.isalpha()}
                            if not objects and len(words) == 1 and len(words[0]) == SHORT:
                                short[language].add(words[0])
                else:
                    walk(inner, objects)
        elif isinstance(value, list):
            for inner in value:
                walk(inner, objects)

    for path in sorted((ROOT / "domains").glob("*/*.toml")):
        walk(tomllib.loads(path.read_text()), path.name.startswith("objects"))
    return found, short


def edits(word: str) -> set[str]:
    """Returns all words one edit away that begin with the same letter."""
    letters = "abcdefghijklmnopqrstuvwxyz"
    splits = [(word[:i], word[i:]) for i in range(1, len(word) + 1)]
    out = {a + b[1:] for a, b in splits if b}
    out |= {a + b[1] + b[0] + b[2:] for a, b in splits if len(b) > 1}
    out |= {a + c + b[1:] for a, b in splits if b for c in letters}
    out |= {a + c + b for a, b in splits for c in letters}
    return out - {word}


def main() -> None:
    lines = []
    found, short = targets()
    for language, words in found.items():
        used: dict[str, float] = {}
        for word in wordfreq.top_n_list(language, 300_000):
            plain = fold(word)
            if plain.isalpha() and wordfreq.zipf_frequency(word, language) >= LEAST_ZIPF:
                used[plain] = max(wordfreq.zipf_frequency(word, language), used.get(plain, 0.0))
        forms = words | {w + e for w in words for e in ENDINGS[language]}
        near = set()
        for form in forms:
            for word in edits(form) & used.keys() - forms:
                if used[word] >= COMMON or used[word] >= used.get(form, 0.0) - RARER:
                    near.add(word)
        lost = {word[:i] + word[i + 1 :] for word in short[language] for i in range(1, len(word))}
        near |= lost & used.keys() - forms
        lines.append((language, sorted(near)))
    text = "# Made by tests/lookalikes.py: words that are one letter away from one for a room, a building or an object.\n\n"
    for language, near in lines:
        rows, row = [], ""
        for word in near:
            if len(row) + len(word) > 115:
                rows.append(row.rstrip())
                row = ""
            row += word + " "
        rows.append(row.rstrip())
        text += f'{language} = """\n' + "\n".join(rows) + '\n"""\n'
    (READER / "lookalikes.toml").write_text(text)
    print({language: len(near) for language, near in lines})


main()
