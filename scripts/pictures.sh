#!/usr/bin/env bash
# Makes the pictures of README.md and docs/guide.md again: scripts/pictures.sh [NAME...]
# Names are those of the files in docs/pictures without ending; none means all (about half an hour on two cores).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cargo build --release --bin alabaster --example side_by_side
work=$(mktemp -d)
# Beside the base scene, because its files are named relative to it.
changed=docs/pictures/.changed.toml
trap 'rm -rf "$work" "$changed"' EXIT

# One method for all, so that they can be compared with each other.
render() { target/release/alabaster render --method bssrdf "$@"; }
join() { target/release/examples/side_by_side "$@"; }
wanted=" $* "
is_wanted() { [ "$wanted" = "  " ] || [[ $wanted == *" $1 "* ]]; }

# picture NAME SPP WIDTH [HEIGHT]: a scene of scenes/.
picture() {
    is_wanted "$1" || return 0
    render "scenes/$1.toml" --width "$3" --height "${4:-$3}" --spp "$2" -o "$work/$1.png"
    join "docs/pictures/$1.jpg" "$work/$1.png"
}

# strip NAME EDIT...: the base scene changed by each sed expression in turn.
strip() {
    local name=$1 edit part parts=()
    is_wanted "$name" || return 0
    shift
    for edit in "$@"; do
        part="$work/$name-${#parts[@]}.png"
        sed "$edit" docs/pictures/parameters.toml >"$changed"
        render "$changed" -o "$part"
        parts+=("$part")
    done
    join "docs/pictures/$name.jpg" "${parts[@]}"
}

# set_to KEY VALUE: the expression that sets a key.
set_to() { printf 's|^%s = .*|%s = %s|' "$1" "$1" "$2"; }

# absorbing VALUE: the expression that gives the wax by coefficients, σ_s = 600/m in all channels.
absorbing() { printf 's|^albedo = .*|sigma_s = [600, 600, 600]|; s|^mean_free_path = .*|sigma_a = %s|' "$1"; }

picture alabaster 512 320
picture soap 128 256
picture jade 128 256
picture milk 256 256
picture prism 2048 320 240

strip mean-free-path \
    "$(set_to mean_free_path '[0.00025, 0.00019, 0.00013]')" "$(set_to mean_free_path '[0.001, 0.00075, 0.0005]')" \
    "$(set_to mean_free_path '[0.004, 0.003, 0.002]')" "$(set_to mean_free_path '[0.016, 0.012, 0.008]')"
strip roughness \
    "$(set_to roughness 0.0)" "$(set_to roughness 0.25)" "$(set_to roughness 0.5)" "$(set_to roughness 1.0)"
strip ior "$(set_to ior 1.1)" "$(set_to ior 1.45)" "$(set_to ior 1.9)" "$(set_to ior 2.4)"
strip albedo \
    "$(set_to albedo '[0.35, 0.35, 0.35]')" "$(set_to albedo '[0.7, 0.7, 0.7]')" \
    "$(set_to albedo '[0.95, 0.95, 0.95]')" "$(set_to albedo '[0.95, 0.7, 0.4]')"
strip sigma-a \
    "$(absorbing '[0, 0, 0]')" "$(absorbing '[1, 3, 10]')" "$(absorbing '[10, 30, 100]')" \
    "$(absorbing '[100, 300, 1000]')"
