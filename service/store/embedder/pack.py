"""The files of the table as the crate embeds them: vocab.txt, rows.i8, scales.f32, table.txt.

Tokens are sorted by their UTF-8 bytes; row i of rows.i8 (256 signed bytes) times scale i (f32, little-endian) is the vector of token i.
table.txt is the identity that an index remembers: name, version, digest of the three files, dimension.
"""

import hashlib
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def pack(tokens, rows, name, folder=HERE):
    """Writes `rows` (float, one a token) quantized to int8 with one scale a row."""
    order = sorted(range(len(tokens)), key=lambda i: tokens[i].encode())
    rows = np.asarray(rows, np.float32)[order]
    scales = (np.abs(rows).max(1) / 127).astype("<f4")
    codes = np.rint(rows / np.maximum(scales, 1e-12)[:, None]).clip(-127, 127).astype(np.int8)
    parts = {
        "vocab.txt": "".join(tokens[i] + "\n" for i in order).encode(),
        "rows.i8": codes.tobytes(),
        "scales.f32": scales.tobytes(),
    }
    digest = hashlib.sha256(b"".join(parts[k] for k in sorted(parts))).hexdigest()[:16]
    for file, content in parts.items():
        (folder / file).write_bytes(content)
    (folder / "table.txt").write_text(f"{name}+{digest}+{rows.shape[1]}\n")
    return f"{name}+{digest}+{rows.shape[1]}"


def unpack(folder=HERE):
    """The tokens (in order) and their rows, as packed."""
    tokens = (folder / "vocab.txt").read_text(encoding="utf-8").split("\n")[:-1]
    codes = np.frombuffer((folder / "rows.i8").read_bytes(), np.int8).reshape(len(tokens), -1)
    scales = np.frombuffer((folder / "scales.f32").read_bytes(), "<f4")
    return tokens, codes * scales[:, None]
