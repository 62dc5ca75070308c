#!/bin/sh
# Draws the pictures of worlds that the README shows: docs/images/worlds.sh, with `d3dgen` built (cargo build --release).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=${D3DGEN:-$here/../../target/release/d3dgen}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

draw() { # name, prompt, seed, and what to look at
    name=$1 prompt=$2 seed=$3
    shift 3
    "$program" generate "$prompt" --seed "$seed" --out "$work/$name" --format gltf
    "$program" render "$work/$name" --out "$work/pictures_$name" --size 800x500 "$@"
    for picture in "$work/pictures_$name"/*.png; do cp "$picture" "$here/world_$name.png"; done
}

draw flat "flat with 3 bedrooms for a cleaning robot" 7 --samples 16 --rooms living_room_1
draw office "office for 14 people with meeting rooms and a kitchen" 7 --samples 8 --overview
draw ward "hospital ward with 6 patient rooms in Germany, for a delivery robot" 7 --samples 8 --overview
draw shop "bakery shop with a cafe" 7 --samples 8 --overview
