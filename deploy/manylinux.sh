#!/usr/bin/env bash
# Builds the Python wheel in PyPA's manylinux image, so that it runs on every Linux with glibc 2.28 or later.
#
#   deploy/manylinux.sh [x86_64|aarch64]      the wheel comes to target/wheels/
#
# Needs docker or podman. The image is told by the tag that maturin then writes into the wheel's name.
set -euo pipefail
cd "$(dirname "$0")/.."
machine=${1:-x86_64}
image="quay.io/pypa/manylinux_2_28_$machine"
engine=$(command -v docker || command -v podman) || { echo "needs docker or podman" >&2; exit 2; }
toolchain=$(sed -n 's/^channel *= *"\(.*\)"/\1/p' rust-toolchain.toml)
mkdir -p target/wheels
"$engine" run --rm -v "$PWD:/io" -w /io/python "$image" bash -euc "
    curl -sSf https://sh.rustup.rs | sh -s -- -y --profile minimal --default-toolchain '$toolchain'
    . \"\$HOME/.cargo/env\"
    /opt/python/cp312-cp312/bin/pip install -q 'maturin>=1.9,<2'
    CARGO_TARGET_DIR=/tmp/target /opt/python/cp312-cp312/bin/maturin build --release --compatibility manylinux_2_28 --out /io/target/wheels
"
ls -l target/wheels
