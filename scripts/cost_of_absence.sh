#!/usr/bin/env bash
# What the presence of code costs a scene that does not need it: this program against one built without that code.
# Prints a table (Markdown): instructions of the rendering proper, counted by valgrind's callgrind (apt-get install valgrind), and the
# ratio of processor times of alternating runs, as median and the middle three quarters. Instructions of two sample counts are subtracted, so that
# loading does not count.
#
#   scripts/cost_of_absence.sh [ROUNDS [EFFECT...]]       15 rounds of timing by default, 0: only instructions; all effects by default
#
# The builds take some minutes the first time.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v valgrind >/dev/null || { echo "valgrind is missing: apt-get install valgrind" >&2; exit 1; }
rounds=${1:-15}
effects=("${@:2}")
[ ${#effects[@]} -gt 0 ] || effects=(subsurface refraction textures)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A scene without the effect, by effect: clear glass, soap with its textured table, the swan.
cp scenes/glass.glb "$work"
cat >"$work/glass.toml" <<'SCENE'
[[object]]
gltf = "glass.glb"
material = "glass"

[[object]]
shape = "quad"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [2, 2]
material = "linen"

[material.glass]
type = "dielectric"
sigma_a = [1, 2, 5]

[material.linen]
type = "diffuse"

[camera]
position = [0.06, 0.17, 0.34]
target = [0, 0.053, 0]
fov = 26

[environment]
radiance = 0.5

[[light]]
type = "quad"
position = [-0.45, 0.42, -0.12]
target = [0, 0.05, 0]
size = 0.35
radiance = 13
SCENE
rows=(
    "subsurface $work/glass.toml"
    "subsurface scenes/table.glb"
    "refraction scenes/soap.toml"
    "refraction scenes/alabaster.toml"
    "textures scenes/alabaster.toml"
    "textures $work/glass.toml"
)

# The wrapper adds the flag to this workspace only, so that dependencies are built once.
programs=target/cost_of_absence
mkdir -p "$programs"
for effect in "${effects[@]}"; do
    wrapper=$PWD/$programs/without-$effect.sh
    printf '#!/bin/sh\nexec "$@" --cfg %s\n' "'alabaster_without=\"$effect\"'" >"$wrapper"
    chmod +x "$wrapper"
    RUSTC_WORKSPACE_WRAPPER=$wrapper cargo build --release --quiet
    cp target/release/alabaster "$programs/without-$effect"
done
cargo build --release --quiet
cp target/release/alabaster "$programs/with"

render() { # PROGRAM SCENE SPP SIDE MORE...
    "$1" render "$2" -o "$work/out.exr" --spp "$3" --width "$4" --height "$4" --threads 1 "${@:5}"
}
count() { # PROGRAM SCENE SPP
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$1" render "$2" -o "$work/out.exr" --spp "$3" \
        --width 24 --height 24 --threads 1 --quiet 2>&1 | awk '/Collected/ {print $4}'
}
instructions() { echo $(($(count "$1" "$2" 33) - $(count "$1" "$2" 1))); }
seconds() { # of processor time, which loading is a small part of
    local TIMEFORMAT=%U
    { time render "$1" "$2" 48 128 --quiet >/dev/null 2>&1; } 2>&1
}

echo "| without | scene | kernel | instructions, present / absent | time, present / absent |"
echo "|---|---|---|---|---|"
for row in "${rows[@]}"; do
    read -r effect scene <<<"$row"
    [[ " ${effects[*]} " == *" $effect "* ]] || continue
    present=$programs/with
    absent=$programs/without-$effect
    kernel=$(render "$present" "$scene" 1 4 --json 2>/dev/null | sed 's/.*"kernel":"\([^"]*\)".*/\1/')
    [ "$kernel" = "$(render "$absent" "$scene" 1 4 --json 2>/dev/null | sed 's/.*"kernel":"\([^"]*\)".*/\1/')" ] ||
        kernel="$kernel (absent: another)"
    counted=$(awk -v a="$(instructions "$present" "$scene")" -v b="$(instructions "$absent" "$scene")" \
        'BEGIN {printf "%.4f", a / b}')
    timed=$(for ((i = 0; i < rounds; i++)); do
        awk -v a="$(seconds "$present" "$scene")" -v b="$(seconds "$absent" "$scene")" 'BEGIN {print a / b}'
    done | sort -n | awk '{x[NR] = $1} END {
        if (NR) printf "%.3f (%.3f to %.3f)", x[int((NR + 1) / 2)], x[1 + int(NR / 8)], x[NR - int(NR / 8)]; else print "-"}')
    echo "| $effect | $(basename "$scene") | $kernel | $counted | $timed |"
done
