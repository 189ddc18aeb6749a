#!/usr/bin/env bash
# Installs what alabaster needs to build on Debian and Ubuntu: Embree 4 (ray queries), libclang
# (bindgen reads Embree's header) and a C toolchain. With --tests also Chromium, in which one test opens a report.
# Safe to run again: it does nothing when all is there.
set -euo pipefail

say() { printf 'setup: %s\n' "$*" >&2; }
die() { say "$*"; exit 1; }

# The way without Embree: rays are then cast by the BVH in pure Rust.
without="cargo run --release --no-default-features -- render scenes/alabaster.toml -o out.png"

have_embree() {
    local header
    for header in "${EMBREE_INCLUDE_DIR:-/usr/include}/embree4/rtcore_config.h" \
        /usr/include/embree4/rtcore_config.h /usr/local/include/embree4/rtcore_config.h; do
        [ -f "$header" ] && return 0
    done
    return 1
}

have_libclang() {
    [ -n "${LIBCLANG_PATH:-}" ] && return 0
    # The library, not libclang-cpp; and the compiler's own headers, which come in a package apart.
    compgen -G '/usr/lib/llvm-*/lib/libclang[.-][s0-9]*' >/dev/null &&
        compgen -G '/usr/lib/llvm-*/lib/clang/*/include/stddef.h' >/dev/null
}

for_tests=false
case "${1:-}" in
    "") ;;
    --tests) for_tests=true ;;
    *) die "unknown option '$1'; there is --tests" ;;
esac

missing=()
have_libclang || missing+=(libclang-dev)
command -v cc >/dev/null || missing+=(build-essential)
have_embree || missing+=(libembree-dev)
if $for_tests && ! command -v chromium >/dev/null; then missing+=(chromium); fi

command -v cargo >/dev/null || die "cargo is not installed: install Rust with rustup first."
if [ ${#missing[@]} -eq 0 ]; then
    say "everything is installed."
    exit 0
fi

command -v apt-get >/dev/null || die "this script knows apt only. Install by hand: ${missing[*]} (Embree 4.x with headers, libclang).
setup: Or do without Embree and libclang (rays are then cast in pure Rust):
setup:   $without"

sudo=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "needs root (or sudo) to install: ${missing[*]}"
    sudo=(sudo)
fi
export DEBIAN_FRONTEND=noninteractive
apt_install() { "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"; }

"${sudo[@]}" apt-get update -qq

plain=()
for package in "${missing[@]}"; do
    [ "$package" = libembree-dev ] || plain+=("$package")
done
[ ${#plain[@]} -eq 0 ] || apt_install "${plain[@]}"
have_embree && exit 0

# Embree 4 from the machine's own release where that has it (Debian 13+, Ubuntu 24.04+).
candidate=$(apt-cache policy libembree-dev | awk '/Candidate:/ {print $2}')
if [ "${candidate%%.*}" = 4 ]; then
    apt_install libembree-dev
    exit 0
fi

# shellcheck disable=SC1091
codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
[ "$codename" = bookworm ] || die "no Embree 4 package for '$codename'. Install Embree 4 by hand, or do without it:
setup:   $without"

say "Debian 12 packages Embree 3 only. Embree 4 comes from Debian 13 (trixie): this adds the trixie suite of
setup: your own Debian mirror at priority 100, so that nothing else is drawn from it, and installs libembree-dev,
setup: which brings Debian 13's libc6 and libstdc++ along. To leave the system as it is, stop now and do without Embree:
setup:   $without"
source_file=$(ls /etc/apt/sources.list.d/debian.sources 2>/dev/null || ls /etc/apt/sources.list)
case "$source_file" in
    *.sources) target=/etc/apt/sources.list.d/alabaster-trixie.sources ;;
    *) target=/etc/apt/sources.list.d/alabaster-trixie.list ;;
esac
sed 's/bookworm/trixie/g' "$source_file" | "${sudo[@]}" tee "$target" >/dev/null
printf 'Package: *\nPin: release n=trixie*\nPin-Priority: 100\n' |
    "${sudo[@]}" tee /etc/apt/preferences.d/alabaster-trixie >/dev/null
"${sudo[@]}" apt-get update -qq
apt_install -t trixie libembree-dev
have_embree || die "libembree-dev was installed but embree4/rtcore_config.h is not where it should be."
say "done."
