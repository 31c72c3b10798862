#!/bin/sh
# All tests. Where no Vulkan adapter is found, first installs lavapipe, Mesa's software adapter (Debian, Ubuntu).
# Arguments go to `cargo test`.
set -eu
cd "$(dirname "$0")"

# Built together, so that what they share is built once. What makes the page is left out: it has much that is needed nowhere else.
packages="--workspace --exclude subpixel-shadows-page"
program="${CARGO_TARGET_DIR:-target}/release/subpixel-shadows"

has_adapter() {
    "$program" adapters --check 2>/dev/null
}

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo >/dev/null 2>&1; then
        sudo "$@"
    else
        echo "test.sh: '$*' needs root, and there is no sudo" >&2
        return 1
    fi
}

# A build that fails is no missing adapter.
cargo build --release $packages
if ! has_adapter; then
    if ! command -v apt-get >/dev/null 2>&1; then
        echo "test.sh: no Vulkan adapter, and no apt-get to install one: install Mesa's lavapipe by hand," >&2
        echo "test.sh: or run the tests that need none: SUBPIXEL_SHADOWS_NO_GPU=1 cargo test --release" >&2
        exit 1
    fi
    echo "test.sh: no Vulkan adapter: installing lavapipe (mesa-vulkan-drivers)"
    as_root apt-get update
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends mesa-vulkan-drivers libvulkan1
    if ! has_adapter; then
        echo "test.sh: lavapipe is installed, but no adapter can be opened:" >&2
        "$program" adapters >&2 || true
        exit 1
    fi
fi
# The window's test has a screen of its own.
if ! command -v xvfb-run >/dev/null 2>&1 && command -v apt-get >/dev/null 2>&1 && [ -z "${SUBPIXEL_SHADOWS_NO_WINDOW:-}" ]; then
    echo "test.sh: no xvfb-run: installing it"
    as_root apt-get update
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
        xvfb xauth libxkbcommon-x11-0 libxcursor1 libxi6
fi
# `subpixel-shadows-occupancy` needs RADV, which is in the package of lavapipe, and says so where it is missing.
# Examples are built by the lints alone (`cargo clippy --all-targets`): no test runs one.
case " $* " in
*" --test"* | *" --lib "* | *" --bin"* | *" --doc "* | *" --example"*)
    cargo test --release $packages "$@"
    ;;
*)
    cargo test --release $packages --lib --bins --tests "$@"
    cargo test --release $packages --doc "$@"
    ;;
esac
