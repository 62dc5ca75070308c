#!/usr/bin/env bash
# Makes the archive of a release and tries it: program, manual pages, completions, licenses, bill of materials, checksums.
#
#   deploy/release.sh [--program FILE] [--out DIR] [--features LIST] [--image]
#
# Without --program, a release build is made. The archive comes to target/dist/ with SHA256SUMS beside it. The same commit and program
# give the same bytes. --image also builds the container image and asks it for its health; it needs podman or docker, and says so where
# there is none.
set -euo pipefail
cd "$(dirname "$0")/.."
program="" out=target/dist features="" image=""
while [ $# -gt 0 ]; do
    case $1 in
    --program) program=$2; shift 2 ;;
    --out) out=$2; shift 2 ;;
    --features) features=$2; shift 2 ;;
    --image) image=yes; shift ;;
    *) echo "deploy/release.sh: $1 is not known; see the top of the file" >&2; exit 2 ;;
    esac
done
if [ -z "$program" ]; then
    cargo build --release --locked -p d3dgen-cli --features "$features"
    program=target/release/d3dgen
fi
version=$("$program" version | sed -n '1s/^d3dgen //p')
machine=$(rustc -vV | sed -n 's/^host: //p')
name=d3dgen-$version-$machine
: "${SOURCE_DATE_EPOCH:=$(git log -1 --format=%ct)}"
export SOURCE_DATE_EPOCH

rm -rf "$out" && mkdir -p "$out"
home=$(mktemp -d)
trap 'rm -rf "$home"' EXIT
tree=$home/$name
mkdir -p "$tree/bin" "$tree/share/man/man1" "$tree/share/bash-completion/completions" "$tree/share/zsh/site-functions" \
    "$tree/share/fish/vendor_completions.d" "$tree/share/doc/d3dgen"
strip -o "$tree/bin/d3dgen" "$program"
"$program" man --out "$tree/share/man/man1"
"$program" completions bash >"$tree/share/bash-completion/completions/d3dgen"
"$program" completions zsh >"$tree/share/zsh/site-functions/_d3dgen"
"$program" completions fish >"$tree/share/fish/vendor_completions.d/d3dgen.fish"
python3 deploy/sbom.py --out "$tree/share/doc/d3dgen" --features "$features"
cp README.md CHANGELOG.md deploy/d3dgen.service "$tree/share/doc/d3dgen/"
tar --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX -C "$home" -cf - "$name" |
    gzip -n >"$out/$name.tar.gz"
cp "$tree/share/doc/d3dgen/sbom.spdx.json" "$out/$name.spdx.json"
(cd "$out" && sha256sum "$name.tar.gz" "$name.spdx.json" >SHA256SUMS)

# as somebody who downloads it: checksums, then the program alone, without a home, a path or a database
(cd "$out" && sha256sum --check --quiet SHA256SUMS)
try=$home/try
mkdir "$try" && tar -xzf "$out/$name.tar.gz" -C "$try"
d3dgen() { (cd "$try" && env -i D3DGEN_STORE= "$try/$name/bin/d3dgen" "$@"); }
d3dgen generate "studio flat in Germany" --no-png --format plan,nav2 --out studio 2>/dev/null
d3dgen check studio >/dev/null
d3dgen explain world.unsound >/dev/null
[ -f "$try/$name/share/man/man1/d3dgen-generate.1" ] && [ -d "$try/$name/share/doc/d3dgen/licenses" ]
bash -n "$try/$name/share/bash-completion/completions/d3dgen"
echo "$out/$name.tar.gz, $(du -h "$out/$name.tar.gz" | cut -f1), its program $(du -h "$tree/bin/d3dgen" | cut -f1): unpacked and tried"

[ -n "$image" ] || exit 0
engine=$(command -v podman || command -v docker || true)
if [ -z "$engine" ] || ! "$engine" info >/dev/null 2>&1; then
    echo "skipped: the image, no engine runs here"
    exit 0
fi
"$engine" build -f deploy/Containerfile --build-arg FEATURES="$features" -t "d3dgen:$version" .
id=$("$engine" run -d --entrypoint d3dgen "d3dgen:$version" serve --data-dir /data --listen 127.0.0.1:50051)
trap '"$engine" rm -f "$id" >/dev/null; rm -rf "$home"' EXIT
for _ in $(seq 60); do
    if "$engine" exec "$id" d3dgen serve health >/dev/null 2>&1; then
        echo "d3dgen:$version answers"
        exit 0
    fi
    sleep 1
done
"$engine" logs "$id" >&2
exit 1
